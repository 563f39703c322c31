#ifndef LabelSelection_h
#define LabelSelection_h

#include "LabelTable.h"
#include "SegmentationVolume.h"

#include "vtkDataArraySelection.h"
#include "vtkNew.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

class FilterRun;
class vtkDataObject;

/**
 * Which labels there are, and which of them are wanted.
 *
 * `Requested` is what the user ticked and unticked, by number or name; `Found` is the list of what
 * the input holds, in all processes, each with its tick as the request leaves it. The rules:
 * - No request, or all that was found ticked: all labels, new ones too when the input changes.
 * - All that was found unticked: none, whatever the input becomes.
 * - Else the ticked ones; where the request only unticks, all but those.
 * A label that is ticked by one of its texts and unticked by another is ticked.
 */
class LabelSelection
{
public:
  vtkNew<vtkDataArraySelection> Requested;
  vtkNew<vtkDataArraySelection> Found;

  /**
   * Brings `Found` up to date with the arrays of `input`, which may be null, empty or a composite.
   * Arrays that did not change are not read again. An array that holds no labels adds none: the
   * run that follows has to say so. Where there are many processes, all have to call this at once.
   */
  void Update(const ArrayFinder& find, vtkDataObject* input, int threads);

  /** To be called after every change of `Requested`; the arguments as for Update. */
  void RequestChanged(const ArrayFinder& find, vtkDataObject* input);

  /**
   * Tells `run` which labels of `volume` to extract.
   * @throws std::runtime_error where a label is asked for that the input does not hold.
   */
  void Apply(FilterRun& run, const SegmentationVolume& volume) const;

  /** The same for an array called `arrayName` that is spread over processes. */
  void ApplyToAll(FilterRun& run, const std::string& arrayName) const;

private:
  enum class Meaning
  {
    All,
    None,
    Listed
  };
  struct ScannedArray
  {
    const vtkDataArray* Array;
    vtkMTimeType MTime;
    std::optional<double> Threshold;
    bool Readable;
    std::vector<int64_t> Labels;
  };

  std::vector<ScannedArray> Scan(const ArrayFinder& find, vtkDataObject* input, int threads) const;
  void RefreshTicks();
  bool IsTicked(int64_t label) const;
  void Choose(
    FilterRun& run, const std::string& arrayName, const std::vector<int64_t>& present) const;
  void CheckPresence(const std::string& arrayName) const;

  Meaning Request = Meaning::All;
  std::vector<ScannedArray> Scanned;
  /** What `Found` shows. */
  LabelTable Table;
  /** The labels that `Requested` means. */
  std::map<int64_t, bool> Ticks;
  /** The name of the array that `Found` belongs to. */
  std::string FoundArray;
};

#endif
