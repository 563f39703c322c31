#include "ArrayValues.h"

#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <cstdlib>
#include <new>

//------------------------------------------------------------------------------
void AllocateTuples(vtkDataArray* array, size_t tuples)
{
  const size_t values = tuples * static_cast<size_t>(array->GetNumberOfComponents());
  if (values == 0)
  {
    array->SetNumberOfTuples(0);
    return;
  }
  void* memory = std::malloc(values * static_cast<size_t>(array->GetDataTypeSize()));
  if (!memory)
  {
    throw std::bad_alloc();
  }
  array->SetVoidArray(
    memory, static_cast<vtkIdType>(values), 0, vtkAbstractArray::VTK_DATA_ARRAY_FREE);
}

//------------------------------------------------------------------------------
const void* ValuesOfType(vtkDataArray* array, int type, vtkSmartPointer<vtkDataArray>& kept)
{
  kept = array;
  if (array->GetDataType() != type || !array->HasStandardMemoryLayout())
  {
    kept.TakeReference(vtkDataArray::CreateDataArray(type));
    kept->SetNumberOfComponents(array->GetNumberOfComponents());
    AllocateTuples(kept, static_cast<size_t>(array->GetNumberOfTuples()));
    kept->InsertTuples(0, array->GetNumberOfTuples(), 0, array);
  }
  return kept->GetVoidPointer(0);
}

//------------------------------------------------------------------------------
const int64_t* WholeNumbers(
  vtkDataArray* array, vtkIdType first, vtkSmartPointer<vtkDataArray>& kept)
{
  if (!array || array->GetNumberOfComponents() != 1)
  {
    return nullptr;
  }
  const int type = array->GetDataType();
  const bool is64Bit = array->GetDataTypeSize() == 8 &&
    (type == VTK_LONG_LONG || type == VTK_LONG || type == VTK_ID_TYPE);
  const auto* values =
    static_cast<const int64_t*>(ValuesOfType(array, is64Bit ? type : VTK_LONG_LONG, kept));
  return values + first;
}

//------------------------------------------------------------------------------
const double* Coordinates(vtkPolyData* data, vtkSmartPointer<vtkDataArray>& kept)
{
  if (data->GetNumberOfPoints() == 0)
  {
    return nullptr;
  }
  return static_cast<const double*>(ValuesOfType(data->GetPoints()->GetData(), VTK_DOUBLE, kept));
}

//------------------------------------------------------------------------------
const float* PointValues(vtkPolyData* data, const char* name, vtkSmartPointer<vtkDataArray>& kept)
{
  vtkDataArray* array = data->GetPointData()->GetArray(name);
  if (!array || array->GetNumberOfComponents() != 1)
  {
    return nullptr;
  }
  return static_cast<const float*>(ValuesOfType(array, VTK_FLOAT, kept));
}
