#include "FilterBridge.h"

#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataArraySelection.h"
#include "vtkImageData.h"
#include "vtkLogger.h"
#include "vtkMidSurfaceFilter.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cstring>
#include <stdexcept>

struct FilterBridge::Internals
{
  vtkNew<vtkImageData> Image;
  vtkNew<vtkMidSurfaceFilter> Filter;
  std::string Errors;
  std::string Warnings;
};

namespace
{
void Keep(vtkObject*, unsigned long, void* messages, void* message)
{
  *static_cast<std::string*>(messages) += static_cast<const char*>(message);
}

void KeepMessages(vtkObject* filter, vtkCommand::EventIds event, std::string& messages)
{
  vtkNew<vtkCallbackCommand> keep;
  keep->SetCallback(Keep);
  keep->SetClientData(&messages);
  filter->AddObserver(event, keep);
}

template <typename T>
std::unique_ptr<std::vector<T>> Values(vtkDataArray* array)
{
  auto values = std::make_unique<std::vector<T>>();
  if (array)
  {
    const int components = array->GetNumberOfComponents();
    for (vtkIdType value = 0; value < array->GetNumberOfValues(); ++value)
    {
      values->push_back(static_cast<T>(
        array->GetComponent(value / components, static_cast<int>(value % components))));
    }
  }
  return values;
}
} // namespace

//------------------------------------------------------------------------------
FilterBridge::FilterBridge()
  : Data(std::make_unique<Internals>())
{
  // Errors are expected by the hundred, and kept.
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  KeepMessages(this->Data->Filter, vtkCommand::ErrorEvent, this->Data->Errors);
  KeepMessages(this->Data->Filter, vtkCommand::WarningEvent, this->Data->Warnings);
  this->Data->Filter->SetInputData(this->Data->Image);
  this->Data->Filter->SetSpacing(vtkMidSurfaceFilter::AS_GIVEN);
}

//------------------------------------------------------------------------------
FilterBridge::~FilterBridge() = default;

//------------------------------------------------------------------------------
void FilterBridge::SetFrame(const std::array<int32_t, 6>& extent,
  const std::array<double, 3>& spacing, const std::array<double, 3>& origin,
  const std::array<double, 9>& direction) const
{
  this->Data->Image->SetExtent(extent[0], extent[1], extent[2], extent[3], extent[4], extent[5]);
  this->Data->Image->SetSpacing(spacing.data());
  this->Data->Image->SetOrigin(origin.data());
  this->Data->Image->SetDirectionMatrix(direction.data());
}

//------------------------------------------------------------------------------
void FilterBridge::AddArray(
  int32_t type, int32_t components, const uint8_t* bytes, size_t size, bool onCells) const
{
  vtkSmartPointer<vtkDataArray> array;
  array.TakeReference(vtkDataArray::CreateDataArray(type));
  array->SetName("labels");
  array->SetNumberOfComponents(components);
  const size_t tupleSize = static_cast<size_t>(components * array->GetDataTypeSize());
  if (size % tupleSize != 0)
  {
    throw std::invalid_argument("not a whole number of values");
  }
  array->SetNumberOfTuples(static_cast<vtkIdType>(size / tupleSize));
  std::memcpy(array->GetVoidPointer(0), bytes, size);
  const int association =
    onCells ? vtkDataObject::FIELD_ASSOCIATION_CELLS : vtkDataObject::FIELD_ASSOCIATION_POINTS;
  this->Data->Image->GetAttributes(association)->AddArray(array);
  this->Data->Filter->SetInputArrayToProcess(0, 0, 0, association, "labels");
}

//------------------------------------------------------------------------------
void FilterBridge::SetMethod(int32_t method) const
{
  this->Data->Filter->SetMethod(method);
}

//------------------------------------------------------------------------------
void FilterBridge::SetEdgeLength(double length) const
{
  this->Data->Filter->SetEdgeLength(length);
}

//------------------------------------------------------------------------------
void FilterBridge::SetThreads(int32_t threads) const
{
  this->Data->Filter->SetThreads(threads);
}

//------------------------------------------------------------------------------
void FilterBridge::SetThreshold(double threshold) const
{
  this->Data->Filter->SetThreshold(threshold);
  this->Data->Filter->UseThresholdOn();
}

//------------------------------------------------------------------------------
void FilterBridge::ChooseLabel(int64_t label) const
{
  this->Data->Filter->GetLabels()->EnableArray(std::to_string(label).c_str());
}

//------------------------------------------------------------------------------
bool FilterBridge::Update() const
{
  this->Data->Errors.clear();
  this->Data->Warnings.clear();
  this->Data->Filter->Modified();
  this->Data->Filter->Update();
  return this->Data->Errors.empty();
}

//------------------------------------------------------------------------------
const std::string& FilterBridge::GetErrors() const
{
  return this->Data->Errors;
}

//------------------------------------------------------------------------------
const std::string& FilterBridge::GetWarnings() const
{
  return this->Data->Warnings;
}

//------------------------------------------------------------------------------
std::unique_ptr<std::vector<float>> FilterBridge::GetPoints() const
{
  vtkPoints* points = this->Data->Filter->GetOutput()->GetPoints();
  return Values<float>(points ? points->GetData() : nullptr);
}

//------------------------------------------------------------------------------
std::unique_ptr<std::vector<int64_t>> FilterBridge::GetTriangles() const
{
  return Values<int64_t>(this->Data->Filter->GetOutput()->GetPolys()->GetConnectivityArray());
}

//------------------------------------------------------------------------------
std::unique_ptr<std::vector<float>> FilterBridge::GetPointArray(const std::string& name) const
{
  return Values<float>(this->Data->Filter->GetOutput()->GetPointData()->GetArray(name.c_str()));
}

//------------------------------------------------------------------------------
std::unique_ptr<std::vector<int64_t>> FilterBridge::GetCellArray(const std::string& name) const
{
  return Values<int64_t>(this->Data->Filter->GetOutput()->GetCellData()->GetArray(name.c_str()));
}

//------------------------------------------------------------------------------
std::unique_ptr<FilterBridge> MakeFilterBridge()
{
  return std::make_unique<FilterBridge>();
}
