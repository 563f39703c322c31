#ifndef TriangleInput_h
#define TriangleInput_h

#include "midsurface.h"

#include "vtkNew.h"
#include "vtkSmartPointer.h"

class vtkCellArray;
class vtkDataArray;
class vtkPolyData;

/**
 * The triangles of a vtkPolyData and the arrays that describe them, as the core wants them. Arrays
 * are copied only where their type is another one. The vtkPolyData must outlive this object.
 */
class TriangleInput
{
public:
  /** @throws std::runtime_error with a message for the user where a polygon is no triangle. */
  explicit TriangleInput(vtkPolyData* input);

  const midsurface_triangle_mesh& Mesh() const { return this->View; }

private:
  void ReadTriangles();
  const int64_t* TriangleValues(const char* name, vtkSmartPointer<vtkDataArray>& kept);

  vtkPolyData* Input;
  midsurface_triangle_mesh View{};
  vtkNew<vtkCellArray> Polygons;
  vtkSmartPointer<vtkDataArray> Points;
  vtkSmartPointer<vtkDataArray> Thickness;
  vtkSmartPointer<vtkDataArray> Labels;
  vtkSmartPointer<vtkDataArray> Components;
  vtkSmartPointer<vtkDataArray> PointIds;
};

#endif
