#include "SegmentationVolume.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace
{
std::string Quoted(const char* name)
{
  return name ? "\"" + std::string(name) + "\"" : "without a name";
}

std::string ListArrays(vtkImageData* image)
{
  std::string names;
  for (vtkFieldData* fields : { static_cast<vtkFieldData*>(image->GetPointData()),
         static_cast<vtkFieldData*>(image->GetCellData()) })
  {
    for (int index = 0; index < fields->GetNumberOfArrays(); ++index)
    {
      names += (names.empty() ? "" : ", ") + Quoted(fields->GetArrayName(index));
    }
  }
  return names.empty() ? "the input has no arrays" : "the input has " + names;
}

[[noreturn]] void ThrowMissingArray(vtkImageData* image, const ChosenArray& chosen)
{
  const std::string what = chosen.Name.empty() ? "No array of labels is chosen"
                                               : "There is no array " + Quoted(chosen.Name.c_str());
  throw std::runtime_error(
    what + ": choose one on points or cells in Segmentation (" + ListArrays(image) + ").");
}

template <typename T>
constexpr uint32_t WholeNumberType()
{
  constexpr bool isSigned = std::is_signed<T>::value;
  switch (sizeof(T))
  {
    case 1:
      return isSigned ? MIDSURFACE_SCALAR_TYPE_INT8 : MIDSURFACE_SCALAR_TYPE_UINT8;
    case 2:
      return isSigned ? MIDSURFACE_SCALAR_TYPE_INT16 : MIDSURFACE_SCALAR_TYPE_UINT16;
    case 4:
      return isSigned ? MIDSURFACE_SCALAR_TYPE_INT32 : MIDSURFACE_SCALAR_TYPE_UINT32;
    default:
      return isSigned ? MIDSURFACE_SCALAR_TYPE_INT64 : MIDSURFACE_SCALAR_TYPE_UINT64;
  }
}

/** False where C has no such type. */
bool FindScalarType(int vtkType, uint32_t& type)
{
  switch (vtkType)
  {
    case VTK_FLOAT:
      type = MIDSURFACE_SCALAR_TYPE_FLOAT32;
      return true;
    case VTK_DOUBLE:
      type = MIDSURFACE_SCALAR_TYPE_FLOAT64;
      return true;
    case VTK_CHAR:
      type = WholeNumberType<char>();
      return true;
    case VTK_SIGNED_CHAR:
      type = WholeNumberType<signed char>();
      return true;
    case VTK_UNSIGNED_CHAR:
      type = WholeNumberType<unsigned char>();
      return true;
    case VTK_SHORT:
      type = WholeNumberType<short>();
      return true;
    case VTK_UNSIGNED_SHORT:
      type = WholeNumberType<unsigned short>();
      return true;
    case VTK_INT:
      type = WholeNumberType<int>();
      return true;
    case VTK_UNSIGNED_INT:
      type = WholeNumberType<unsigned int>();
      return true;
    case VTK_LONG:
      type = WholeNumberType<long>();
      return true;
    case VTK_UNSIGNED_LONG:
      type = WholeNumberType<unsigned long>();
      return true;
    case VTK_LONG_LONG:
      type = WholeNumberType<long long>();
      return true;
    case VTK_UNSIGNED_LONG_LONG:
      type = WholeNumberType<unsigned long long>();
      return true;
    case VTK_ID_TYPE:
      type = WholeNumberType<vtkIdType>();
      return true;
    default:
      return false;
  }
}
} // namespace

//------------------------------------------------------------------------------
vtkDataArray* ChosenArray::Labels() const
{
  vtkDataArray* array = vtkDataArray::SafeDownCast(this->Array);
  const bool isUsable = array && array->GetNumberOfComponents() == 1 &&
    this->Association != vtkDataObject::FIELD_ASSOCIATION_NONE;
  return isUsable ? array : nullptr;
}

//------------------------------------------------------------------------------
ChosenArray FindFirstArray(vtkImageData* image)
{
  ChosenArray first{ nullptr, vtkDataObject::FIELD_ASSOCIATION_POINTS, "", {} };
  for (const int association :
    { vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataObject::FIELD_ASSOCIATION_CELLS })
  {
    vtkDataSetAttributes* fields = image->GetAttributes(association);
    const ChosenArray active{ fields->GetScalars(), association, "", {} };
    if (active.Labels())
    {
      return active;
    }
    for (int index = 0; index < fields->GetNumberOfArrays(); ++index)
    {
      const ChosenArray candidate{ fields->GetAbstractArray(index), association, "", {} };
      const bool isEarlier = !first.Array ||
        (first.Association == association &&
          Quoted(candidate.Array->GetName()) < Quoted(first.Array->GetName()));
      if (candidate.Labels() && isEarlier)
      {
        first = candidate;
      }
    }
  }
  return first;
}

//------------------------------------------------------------------------------
void DescribeGrid(
  vtkImageData* image, bool onCells, const double spacing[3], midsurface_volume& volume)
{
  int extent[6];
  int points[3];
  double origin[3];
  image->GetExtent(extent);
  image->GetDimensions(points);
  image->GetOrigin(origin);
  const double* direction = image->GetDirectionMatrix()->GetData();
  std::copy_n(direction, 9, volume.direction);
  std::copy_n(origin, 3, volume.origin);
  for (int axis = 0; axis < 3; ++axis)
  {
    volume.spacing[axis] = spacing[axis];
    volume.extent_start[axis] = extent[2 * axis];
    // An image that is one point thick still has one layer of cells, which lies on its points.
    const bool shrinks = onCells && points[axis] > 1;
    volume.dimensions[axis] = static_cast<size_t>(points[axis] - (shrinks ? 1 : 0));
    for (int row = 0; shrinks && row < 3; ++row)
    {
      volume.origin[row] += direction[3 * row + axis] * 0.5 * spacing[axis];
    }
  }
}

//------------------------------------------------------------------------------
SegmentationVolume::SegmentationVolume(vtkImageData* image, const ChosenArray& chosen)
  : Source(image)
  , Labels(chosen.Labels())
  , CellData(chosen.Association == vtkDataObject::FIELD_ASSOCIATION_CELLS)
{
  if (!chosen.Array || chosen.Association == vtkDataObject::FIELD_ASSOCIATION_NONE)
  {
    ThrowMissingArray(image, chosen);
  }
  const std::string name = Quoted(chosen.Array->GetName());
  if (!vtkDataArray::SafeDownCast(chosen.Array))
  {
    throw std::runtime_error("The array " + name + " holds no numbers, so it is no segmentation.");
  }
  if (!this->Labels)
  {
    throw std::runtime_error("The array " + name + " has " +
      std::to_string(chosen.Array->GetNumberOfComponents()) +
      " components, but a segmentation has one label a voxel: choose another array.");
  }
  this->DescribeScalars();
  DescribeGrid(image, this->CellData, image->GetSpacing(), this->Volume);
  this->Volume.use_threshold = chosen.Threshold.has_value();
  this->Volume.threshold = chosen.Threshold.value_or(0);
}

//------------------------------------------------------------------------------
void SegmentationVolume::SetSpacing(const double spacing[3])
{
  DescribeGrid(this->Source, this->CellData, spacing, this->Volume);
}

//------------------------------------------------------------------------------
void SegmentationVolume::DescribeScalars()
{
  this->Contiguous = this->Labels;
  if (!FindScalarType(this->Labels->GetDataType(), this->Volume.scalar_type))
  {
    this->Contiguous.TakeReference(vtkDataArray::CreateDataArray(VTK_UNSIGNED_CHAR));
    this->Contiguous->DeepCopy(this->Labels);
    this->Volume.scalar_type = MIDSURFACE_SCALAR_TYPE_UINT8;
  }
  else if (!this->Labels->HasStandardMemoryLayout())
  {
    this->Contiguous.TakeReference(vtkDataArray::CreateDataArray(this->Labels->GetDataType()));
    this->Contiguous->DeepCopy(this->Labels);
  }
  this->Volume.length = static_cast<size_t>(this->Contiguous->GetNumberOfTuples());
  this->Volume.scalars = this->Volume.length ? this->Contiguous->GetVoidPointer(0) : nullptr;
}
