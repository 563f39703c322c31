#include "TriangleInput.h"

#include "ArrayValues.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <new>
#include <stdexcept>

//------------------------------------------------------------------------------
TriangleInput::TriangleInput(vtkPolyData* input)
  : Input(input)
{
  this->View.point_count = static_cast<size_t>(input->GetNumberOfPoints());
  this->View.points = Coordinates(input, this->Points);
  this->View.thickness = PointValues(input, "Thickness", this->Thickness);
  this->View.point_ids = WholeNumbers(input->GetPointData()->GetGlobalIds(), 0, this->PointIds);
  this->ReadTriangles();
  this->View.labels = this->TriangleValues("Label", this->Labels);
  this->View.components = this->TriangleValues("Component", this->Components);
}

//------------------------------------------------------------------------------
void TriangleInput::ReadTriangles()
{
  if (this->Input->GetNumberOfStrips() > 0 ||
    (this->Input->GetNumberOfPolys() > 0 && this->Input->GetPolys()->IsHomogeneous() != 3))
  {
    throw std::runtime_error("The mesh has polygons that are no triangles: apply the filter "
                             "Triangulate to it first.");
  }
  this->Polygons->ShallowCopy(this->Input->GetPolys());
  if (!this->Polygons->IsStorage64Bit() && !this->Polygons->ConvertTo64BitStorage())
  {
    throw std::bad_alloc();
  }
  this->View.triangle_count = static_cast<size_t>(this->Input->GetNumberOfPolys());
  this->View.triangles =
    reinterpret_cast<const int64_t*>(this->Polygons->GetConnectivityArray64()->GetPointer(0));
}

//------------------------------------------------------------------------------
const int64_t* TriangleInput::TriangleValues(const char* name, vtkSmartPointer<vtkDataArray>& kept)
{
  // Cell arrays begin with the vertices and lines.
  const vtkIdType first = this->Input->GetNumberOfVerts() + this->Input->GetNumberOfLines();
  return WholeNumbers(this->Input->GetCellData()->GetArray(name), first, kept);
}
