#ifndef PolyDataConversion_h
#define PolyDataConversion_h

#include "midsurface.h"

#include "vtkNew.h"
#include "vtkSmartPointer.h"

class vtkCellArray;
class vtkDataArray;
class vtkPolyData;

/** Copies a mesh, once: points `Normals` and `Thickness`, cells `Label` and `Component`. */
void CopyMesh(const midsurface_mesh_arrays& mesh, vtkPolyData* output);

/**
 * The same for the part of a mesh that this process holds, with the numbers of its points and
 * triangles among those of all: global ids, points `GlobalPointIds` and cells `GlobalCellIds`.
 */
void CopyMeshPiece(const midsurface_mesh_arrays& mesh, vtkPolyData* output);

/**
 * Copies polylines, once: points `Thickness` and `BorderDistance`, cells `Label`, `Component` and
 * `Slice`, and field data `VoxelSteps`.
 */
void CopyPolylines(const midsurface_polyline_arrays& polylines, vtkPolyData* output);

/**
 * The line cells of a vtkPolyData and their arrays as the core wants them. Arrays are copied only
 * where their type is another one. The vtkPolyData must outlive this object.
 */
class PolylineInput
{
public:
  /** @throws std::runtime_error with a message for the user where `input` cannot be used. */
  explicit PolylineInput(vtkPolyData* input);

  const midsurface_polyline_arrays& Arrays() const { return this->View; }

private:
  const int64_t* LineValues(const char* name, vtkSmartPointer<vtkDataArray>& kept);

  vtkPolyData* Input;
  midsurface_polyline_arrays View{};
  double VoxelSteps[9] = {};
  vtkNew<vtkCellArray> Lines;
  vtkSmartPointer<vtkDataArray> Points;
  vtkSmartPointer<vtkDataArray> Thickness;
  vtkSmartPointer<vtkDataArray> BorderDistance;
  vtkSmartPointer<vtkDataArray> Labels;
  vtkSmartPointer<vtkDataArray> Components;
  vtkSmartPointer<vtkDataArray> Slices;
};

#endif
