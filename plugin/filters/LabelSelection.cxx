#include "LabelSelection.h"

#include "FilterRun.h"

#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>
#include <utility>

namespace
{
std::vector<vtkImageData*> ListImages(vtkDataObject* input)
{
  std::vector<vtkImageData*> images;
  if (auto* composite = vtkCompositeDataSet::SafeDownCast(input))
  {
    auto blocks = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
    for (blocks->InitTraversal(); !blocks->IsDoneWithTraversal(); blocks->GoToNextItem())
    {
      images.push_back(vtkImageData::SafeDownCast(blocks->GetCurrentDataObject()));
    }
  }
  else
  {
    images.push_back(vtkImageData::SafeDownCast(input));
  }
  images.erase(std::remove(images.begin(), images.end(), nullptr), images.end());
  return images;
}

/** False where the array holds no labels, for which the run will give the reason. */
bool ReadLabels(const SegmentationVolume& volume, int threads, std::vector<int64_t>& labels)
{
  midsurface::Options options;
  options.Threads = static_cast<uint32_t>(threads);
  try
  {
    labels = midsurface::FindLabels(volume.Description(), options);
    return true;
  }
  catch (const midsurface::Error&)
  {
    return false;
  }
}
} // namespace

//------------------------------------------------------------------------------
void LabelSelection::Update(
  const ArrayFinder& find, vtkMTimeType choiceTime, vtkDataObject* input, int threads)
{
  std::vector<ScannedArray> arrays;
  for (vtkImageData* image : ListImages(input))
  {
    const ChosenArray chosen = find(image);
    if (const vtkDataArray* array = chosen.Labels())
    {
      ScannedArray scanned{ array, chosen.Array->GetMTime(), false, {} };
      const auto known = std::find_if(
        this->Scanned.begin(), this->Scanned.end(), [&scanned](const ScannedArray& candidate) {
          return candidate.Array == scanned.Array && candidate.MTime == scanned.MTime;
        });
      if (known != this->Scanned.end())
      {
        scanned = *known;
      }
      else
      {
        scanned.Readable = ReadLabels(SegmentationVolume(image, chosen), threads, scanned.Labels);
      }
      arrays.push_back(std::move(scanned));
    }
  }
  if (!arrays.empty())
  {
    this->Scanned = std::move(arrays);
    this->FoundChoiceTime = choiceTime;
    this->RefreshFound();
  }
}

//------------------------------------------------------------------------------
void LabelSelection::RefreshFound()
{
  std::set<int64_t> labels;
  for (const ScannedArray& scanned : this->Scanned)
  {
    labels.insert(scanned.Labels.begin(), scanned.Labels.end());
  }
  this->Found->RemoveAllArrays();
  for (int64_t label : labels)
  {
    const std::string name = std::to_string(label);
    this->Found->AddArray(name.c_str(), this->IsTicked(name));
  }
}

//------------------------------------------------------------------------------
void LabelSelection::RequestChanged(vtkMTimeType choiceTime)
{
  const int count = this->Requested->GetNumberOfArrays();
  const int ticked = this->Requested->GetNumberOfArraysEnabled();
  this->Request = count == 0 ? Meaning::All : Meaning::Listed;
  // A list of all labels of another array says nothing about this one's.
  const bool isAboutFound =
    count > 0 && count == this->Found->GetNumberOfArrays() && choiceTime == this->FoundChoiceTime;
  if (!isAboutFound || (ticked != 0 && ticked != count))
  {
    return;
  }
  for (int index = 0; index < count; ++index)
  {
    if (!this->Found->ArrayExists(this->Requested->GetArrayName(index)))
    {
      return;
    }
  }
  this->Request = ticked ? Meaning::All : Meaning::None;
}

//------------------------------------------------------------------------------
bool LabelSelection::IsTicked(const std::string& label) const
{
  if (this->Request != Meaning::Listed)
  {
    return this->Request == Meaning::All;
  }
  if (this->Requested->ArrayExists(label.c_str()))
  {
    return this->Requested->ArrayIsEnabled(label.c_str()) != 0;
  }
  return this->Requested->GetNumberOfArraysEnabled() == 0;
}

//------------------------------------------------------------------------------
void LabelSelection::CheckPresence(const std::string& arrayName) const
{
  std::string absent;
  for (int index = 0; index < this->Requested->GetNumberOfArrays(); ++index)
  {
    const char* label = this->Requested->GetArrayName(index);
    if (this->Requested->GetArraySetting(index) && !this->Found->ArrayExists(label))
    {
      absent += (absent.empty() ? "" : ", ") + std::string(label);
    }
  }
  if (absent.empty())
  {
    return;
  }
  constexpr int shown = 20;
  const int count = this->Found->GetNumberOfArrays();
  std::string present;
  for (int index = 0; index < std::min(count, shown); ++index)
  {
    present += (present.empty() ? "" : ", ") + std::string(this->Found->GetArrayName(index));
  }
  throw std::runtime_error("Labels asks for " + absent + ", which the array \"" + arrayName +
    "\" does not hold. It holds " + (count ? present : "no label") +
    (count > shown ? " and more." : "."));
}

//------------------------------------------------------------------------------
void LabelSelection::Apply(FilterRun& run, const SegmentationVolume& volume) const
{
  const vtkDataArray* array = volume.Array();
  const auto scanned = std::find_if(this->Scanned.begin(), this->Scanned.end(),
    [array](const ScannedArray& candidate) { return candidate.Array == array; });
  const bool isReadable = scanned != this->Scanned.end() && scanned->Readable;
  // An array that cannot be read goes to the core as it is, which gives the reason.
  if (!isReadable || this->Request == Meaning::All)
  {
    return;
  }
  if (this->Request == Meaning::Listed)
  {
    this->CheckPresence(volume.Array()->GetName() ? volume.Array()->GetName() : "");
  }
  std::vector<int64_t> wanted;
  std::copy_if(scanned->Labels.begin(), scanned->Labels.end(), std::back_inserter(wanted),
    [this](int64_t label) { return this->IsTicked(std::to_string(label)); });
  if (wanted.empty() && this->Found->GetNumberOfArraysEnabled() > 0)
  {
    // Other blocks of the input hold what is wanted, so nothing is amiss.
    run.Options.Warning = nullptr;
  }
  run.Options.Labels = std::move(wanted);
}
