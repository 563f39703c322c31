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

/** What tells the chosen array from others; "" where there is none. */
std::string ArrayName(const ArrayFinder& find, vtkDataObject* input)
{
  for (vtkImageData* image : ListImages(input))
  {
    const ChosenArray chosen = find(image);
    if (chosen.Labels() && chosen.Array->GetName())
    {
      return std::to_string(chosen.Association) + " " + chosen.Array->GetName();
    }
  }
  return "";
}

/** The names of a block come before those of the whole. */
void ReadNames(LabelTable& table, vtkDataObject* input)
{
  for (vtkImageData* image : ListImages(input))
  {
    table.ReadNames(image->GetFieldData());
  }
  if (input)
  {
    table.ReadNames(input->GetFieldData());
  }
}
} // namespace

//------------------------------------------------------------------------------
void LabelSelection::Update(const ArrayFinder& find, vtkDataObject* input, int threads)
{
  LabelTable table;
  try
  {
    std::vector<ScannedArray> arrays = this->Scan(find, input, threads);
    for (const ScannedArray& scanned : arrays)
    {
      scanned.Readable ? table.Add(scanned.Labels) : table.AddUnreadable();
    }
    this->Scanned = arrays.empty() ? std::move(this->Scanned) : std::move(arrays);
    ReadNames(table, input);
  }
  catch (const std::exception&)
  {
    // The run that follows meets it again and says so. The other processes wait for this one.
  }
  table.GatherFromAllProcesses();
  if (table.IsKnown())
  {
    this->Table = std::move(table);
    this->FoundArray = ArrayName(find, input);
    this->RefreshTicks();
    this->Found->RemoveAllArrays();
    for (const auto& entry : this->Table.Entries())
    {
      this->Found->AddArray(LabelTable::Text(entry).c_str(), this->IsTicked(entry.first));
    }
  }
}

//------------------------------------------------------------------------------
std::vector<LabelSelection::ScannedArray> LabelSelection::Scan(
  const ArrayFinder& find, vtkDataObject* input, int threads) const
{
  std::vector<ScannedArray> arrays;
  for (vtkImageData* image : ListImages(input))
  {
    const ChosenArray chosen = find(image);
    if (const vtkDataArray* array = chosen.Labels())
    {
      ScannedArray scanned{ array, chosen.Array->GetMTime(), chosen.Threshold, false, {} };
      const auto known = std::find_if(
        this->Scanned.begin(), this->Scanned.end(), [&scanned](const ScannedArray& candidate) {
          return candidate.Array == scanned.Array && candidate.MTime == scanned.MTime &&
            candidate.Threshold == scanned.Threshold;
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
  return arrays;
}

//------------------------------------------------------------------------------
void LabelSelection::RefreshTicks()
{
  this->Ticks.clear();
  for (int index = 0; index < this->Requested->GetNumberOfArrays(); ++index)
  {
    for (const int64_t label : this->Table.Find(this->Requested->GetArrayName(index)))
    {
      bool& isTicked = this->Ticks[label];
      isTicked = isTicked || this->Requested->GetArraySetting(index);
    }
  }
}

//------------------------------------------------------------------------------
void LabelSelection::RequestChanged(const ArrayFinder& find, vtkDataObject* input)
{
  this->Request = this->Requested->GetNumberOfArrays() == 0 ? Meaning::All : Meaning::Listed;
  this->RefreshTicks();
  const auto& found = this->Table.Entries();
  // A list of all labels of another array says nothing about this one's.
  const bool isAboutFound = !this->Ticks.empty() && this->FoundArray == ArrayName(find, input) &&
    this->Ticks.size() == found.size() &&
    std::all_of(this->Ticks.begin(), this->Ticks.end(),
      [this](const auto& tick) { return this->Table.Holds(tick.first); });
  const auto isOn = [](const auto& tick) { return tick.second; };
  if (isAboutFound && std::all_of(this->Ticks.begin(), this->Ticks.end(), isOn))
  {
    this->Request = Meaning::All;
  }
  else if (isAboutFound && std::none_of(this->Ticks.begin(), this->Ticks.end(), isOn))
  {
    this->Request = Meaning::None;
  }
}

//------------------------------------------------------------------------------
bool LabelSelection::IsTicked(int64_t label) const
{
  if (this->Request != Meaning::Listed)
  {
    return this->Request == Meaning::All;
  }
  const auto tick = this->Ticks.find(label);
  return tick != this->Ticks.end() ? tick->second
                                   : this->Requested->GetNumberOfArraysEnabled() == 0;
}

//------------------------------------------------------------------------------
void LabelSelection::CheckPresence(const std::string& arrayName) const
{
  std::string absent;
  for (int index = 0; index < this->Requested->GetNumberOfArrays(); ++index)
  {
    const char* text = this->Requested->GetArrayName(index);
    const std::set<int64_t> labels = this->Table.Find(text);
    const bool isPresent = std::any_of(
      labels.begin(), labels.end(), [this](int64_t label) { return this->Table.Holds(label); });
    if (this->Requested->GetArraySetting(index) && !isPresent)
    {
      absent += (absent.empty() ? "" : ", ") + std::string(text);
    }
  }
  if (absent.empty())
  {
    return;
  }
  constexpr size_t shown = 20;
  const auto& found = this->Table.Entries();
  std::string present;
  size_t count = 0;
  for (auto entry = found.begin(); entry != found.end() && count < shown; ++entry, ++count)
  {
    present += (present.empty() ? "" : ", ") + LabelTable::Text(*entry);
  }
  throw std::runtime_error("Labels asks for " + absent + ", which the array \"" + arrayName +
    "\" does not hold. It holds " + (count ? present : "no label") +
    (found.size() > shown ? " and more." : "."));
}

//------------------------------------------------------------------------------
void LabelSelection::Apply(FilterRun& run, const SegmentationVolume& volume) const
{
  vtkDataArray* array = volume.Array();
  const auto scanned = std::find_if(this->Scanned.begin(), this->Scanned.end(),
    [array](const ScannedArray& candidate) { return candidate.Array == array; });
  const bool isReadable = scanned != this->Scanned.end() && scanned->Readable;
  // An array that cannot be read goes to the core as it is, which gives the reason.
  if (!isReadable)
  {
    return;
  }
  this->Choose(run, array->GetName() ? array->GetName() : "", scanned->Labels);
}

//------------------------------------------------------------------------------
void LabelSelection::ApplyToAll(FilterRun& run, const std::string& arrayName) const
{
  if (this->Table.IsIncomplete())
  {
    return;
  }
  std::vector<int64_t> labels;
  for (const auto& entry : this->Table.Entries())
  {
    labels.push_back(entry.first);
  }
  this->Choose(run, arrayName, labels);
}

//------------------------------------------------------------------------------
void LabelSelection::Choose(
  FilterRun& run, const std::string& arrayName, const std::vector<int64_t>& present) const
{
  if (this->Request == Meaning::Listed)
  {
    this->CheckPresence(arrayName);
  }
  std::vector<int64_t> wanted;
  std::copy_if(present.begin(), present.end(), std::back_inserter(wanted),
    [this](int64_t label) { return this->IsTicked(label); });
  if (wanted.empty() && this->Found->GetNumberOfArraysEnabled() > 0)
  {
    // Other blocks or processes hold what is wanted, so nothing is amiss.
    run.Options.Warning = nullptr;
  }
  if (this->Request != Meaning::All)
  {
    run.Options.Labels = std::move(wanted);
  }
}
