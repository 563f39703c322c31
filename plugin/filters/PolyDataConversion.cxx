#include "PolyDataConversion.h"

#include "ArrayValues.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkLongLongArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

static_assert(sizeof(long long) == sizeof(int64_t), "labels are 64-bit integers");

namespace
{
/** A new array of `tuples` with `components` each, filled from `values`, which may be null for 0.
 */
template <typename ArrayType, typename ValueType>
vtkSmartPointer<ArrayType> CopyArray(
  const char* name, const ValueType* values, size_t tuples, int components = 1)
{
  auto array = vtkSmartPointer<ArrayType>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  AllocateTuples(array, tuples);
  if (tuples > 0)
  {
    std::copy_n(values, tuples * static_cast<size_t>(components), array->GetPointer(0));
  }
  return array;
}

template <typename ArrayType, typename ValueType>
void CopyPoints(const ValueType* values, size_t count, vtkPolyData* output)
{
  vtkNew<vtkPoints> points;
  points->SetData(CopyArray<ArrayType>("Points", values, count, 3));
  output->SetPoints(points);
}

vtkSmartPointer<vtkIdTypeArray> NumberFrom(const char* name, uint64_t first, size_t count)
{
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetName(name);
  AllocateTuples(numbers, count);
  vtkIdType* begin = numbers->GetPointer(0);
  std::iota(begin, begin + count, static_cast<vtkIdType>(first));
  return numbers;
}
} // namespace

//------------------------------------------------------------------------------
void CopyMesh(const midsurface_mesh_arrays& mesh, vtkPolyData* output)
{
  CopyPoints<vtkFloatArray>(mesh.points, mesh.point_count, output);
  output->GetPointData()->SetNormals(
    CopyArray<vtkFloatArray>("Normals", mesh.normals, mesh.point_count, 3));
  output->GetPointData()->AddArray(
    CopyArray<vtkFloatArray>("Thickness", mesh.thickness, mesh.point_count));

  vtkNew<vtkTypeInt64Array> offsets;
  AllocateTuples(offsets, mesh.triangle_count + 1);
  for (size_t i = 0; i <= mesh.triangle_count; ++i)
  {
    offsets->SetValue(static_cast<vtkIdType>(i), static_cast<vtkTypeInt64>(3 * i));
  }
  vtkNew<vtkCellArray> triangles;
  triangles->SetData(
    offsets, CopyArray<vtkTypeInt64Array>("Connectivity", mesh.triangles, 3 * mesh.triangle_count));
  output->SetPolys(triangles);
  // As the active scalars, since that is what ParaView colours by at first.
  output->GetCellData()->SetScalars(
    CopyArray<vtkLongLongArray>("Label", mesh.labels, mesh.triangle_count));
  output->GetCellData()->AddArray(
    CopyArray<vtkLongLongArray>("Component", mesh.components, mesh.triangle_count));
}

//------------------------------------------------------------------------------
void CopyMeshPiece(const midsurface_mesh_arrays& mesh, vtkPolyData* output)
{
  CopyMesh(mesh, output);
  output->GetPointData()->SetGlobalIds(
    CopyArray<vtkIdTypeArray>("GlobalPointIds", mesh.point_ids, mesh.point_count));
  output->GetCellData()->SetGlobalIds(
    NumberFrom("GlobalCellIds", mesh.first_triangle, mesh.triangle_count));
}

//------------------------------------------------------------------------------
void CopyPolylines(const midsurface_polyline_arrays& polylines, vtkPolyData* output)
{
  CopyPoints<vtkDoubleArray>(polylines.points, polylines.point_count, output);
  output->GetPointData()->AddArray(
    CopyArray<vtkFloatArray>("Thickness", polylines.thickness, polylines.point_count));
  output->GetPointData()->AddArray(
    CopyArray<vtkFloatArray>("BorderDistance", polylines.border_distance, polylines.point_count));

  if (polylines.line_count > 0)
  {
    vtkNew<vtkCellArray> lines;
    lines->SetData(
      CopyArray<vtkTypeInt64Array>("Offsets", polylines.offsets, polylines.line_count + 1),
      CopyArray<vtkTypeInt64Array>(
        "Connectivity", polylines.connectivity, polylines.connectivity_length));
    output->SetLines(lines);
  }
  const size_t count = polylines.line_count;
  vtkCellData* cells = output->GetCellData();
  cells->AddArray(CopyArray<vtkLongLongArray>("Label", polylines.labels, count));
  cells->AddArray(CopyArray<vtkLongLongArray>("Component", polylines.components, count));
  cells->AddArray(CopyArray<vtkLongLongArray>("Slice", polylines.slices, count));
  // Field data stay with the lines whichever filters they go through.
  output->GetFieldData()->AddArray(
    CopyArray<vtkDoubleArray>("VoxelSteps", polylines.voxel_steps, 9));
}

//------------------------------------------------------------------------------
PolylineInput::PolylineInput(vtkPolyData* input)
  : Input(input)
{
  this->View.line_count = static_cast<size_t>(input->GetNumberOfLines());
  if (this->View.line_count == 0)
  {
    throw std::runtime_error(
      "The input has no lines: this filter joins the polylines that Mid-Polylines makes.");
  }
  this->View.point_count = static_cast<size_t>(input->GetNumberOfPoints());
  this->View.points = Coordinates(input, this->Points);
  this->View.thickness = PointValues(input, "Thickness", this->Thickness);
  this->View.border_distance = PointValues(input, "BorderDistance", this->BorderDistance);

  vtkDataArray* steps = input->GetFieldData()->GetArray("VoxelSteps");
  if (steps && steps->GetNumberOfValues() == 9)
  {
    const int components = steps->GetNumberOfComponents();
    for (int i = 0; i < 9; ++i)
    {
      this->VoxelSteps[i] = steps->GetComponent(i / components, i % components);
    }
    this->View.voxel_steps = this->VoxelSteps;
  }

  this->Lines->ShallowCopy(input->GetLines());
  if (!this->Lines->IsStorage64Bit() && !this->Lines->ConvertTo64BitStorage())
  {
    throw std::bad_alloc();
  }
  this->View.offsets =
    reinterpret_cast<const int64_t*>(this->Lines->GetOffsetsArray64()->GetPointer(0));
  this->View.connectivity =
    reinterpret_cast<const int64_t*>(this->Lines->GetConnectivityArray64()->GetPointer(0));
  this->View.connectivity_length =
    static_cast<size_t>(this->Lines->GetConnectivityArray64()->GetNumberOfValues());

  this->View.labels = this->LineValues("Label", this->Labels);
  this->View.components = this->LineValues("Component", this->Components);
  this->View.slices = this->LineValues("Slice", this->Slices);
  if (!this->View.slices)
  {
    throw std::runtime_error(
      "The lines have no cell array \"Slice\" that tells which slice of "
      "the volume each lies in: use the polylines that Mid-Polylines makes.");
  }
}

//------------------------------------------------------------------------------
const int64_t* PolylineInput::LineValues(const char* name, vtkSmartPointer<vtkDataArray>& kept)
{
  // Cell arrays begin with the vertices.
  return WholeNumbers(
    this->Input->GetCellData()->GetArray(name), this->Input->GetNumberOfVerts(), kept);
}
