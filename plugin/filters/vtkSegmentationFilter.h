/**
 * @class vtkSegmentationFilter
 * @brief What the filters share that read labels from an image.
 *
 * The labels are the array that SetInputArrayToProcess(0, ...) names: one whole number a voxel, on
 * points or on cells, 0 for background, of any numeric type. Default: the active scalars, else the
 * first such array by name. With cells the surface lies on the grid of the cell centres.
 *
 * Which labels are extracted is told by text, as in GetLabels()->EnableArray("3"). Without a
 * request, all are. A label that is asked for and not there is an error. Field data may name the
 * labels: the vtkStringArray `LabelNames` holds the names of the labels 0, 1, 2 and so on, or of
 * those that the numeric array `LabelValues` lists. The text of a label is then its number, its
 * name, or both as in "3: outer membrane".
 *
 * Under MPI (a vtkMultiProcessController with many processes) all processes update the filter
 * together. What is made of a part of the volume depends on what lies around that part, so the
 * connected components are dealt out: each process makes the output of whole ones, and none ever
 * holds the volume. Where the output is an image, each process works on all components near its
 * piece. Blocks of a collection are worked on by the process that holds them.
 *
 * Bad input is reported by an error or warning of the filter, and the output is empty (an image
 * has no arrays). So it is, with a warning, after an abort.
 */

#ifndef vtkSegmentationFilter_h
#define vtkSegmentationFilter_h

#include "MidSurfaceFiltersModule.h"
#include "vtkAlgorithm.h"

#include <memory>

struct midsurface_piece;
class FilterRun;
class ProcessExchange;
class SegmentationVolume;
class vtkDataArraySelection;
class vtkDataObject;
class vtkImageData;

class MIDSURFACEFILTERS_EXPORT vtkSegmentationFilter : public vtkAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkSegmentationFilter, vtkAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The image to work on, where it does not come from another filter.
   */
  void SetInputData(vtkImageData* image);

  /**
   * The labels asked for: "1", "3" and so on, or their names, on or off. Empty, the default: all
   * labels. Where some are on: those. Where some are off and none is on: all but those. Where
   * exactly the labels of GetFoundLabels() are on (off), it means all (none), also after the input
   * has changed.
   */
  vtkDataArraySelection* GetLabels();

  /**
   * Turns one label of GetLabels() on or off.
   */
  void SetLabelStatus(const char* label, int status);

  /**
   * Empties GetLabels(), so that all labels are extracted.
   */
  void ClearLabels();

  /**
   * The labels that the input holds, on where they are going to be extracted. Not to be changed.
   * Up to date once upstream and this filter's information or data have been updated.
   */
  vtkDataArraySelection* GetFoundLabels();

  ///@{
  /**
   * Number of threads; 0, the default: one a core, shared among the processes on a machine. The
   * output does not depend on it.
   */
  vtkSetClampMacro(Threads, int, 0, VTK_INT_MAX);
  vtkGetMacro(Threads, int);
  ///@}

  enum Spacings
  {
    AUTOMATIC = 0,
    AS_GIVEN = 1
  };

  ///@{
  /**
   * Whether a spacing that looks wrong is corrected, with a warning. AUTOMATIC, the default: where
   * z spacing is the number of slices times the x spacing, as readers make of an MRC file whose
   * header lacks the number of slices, the z spacing is taken to be the x spacing. AS_GIVEN: never.
   */
  vtkSetClampMacro(Spacing, int, AUTOMATIC, AS_GIVEN);
  vtkGetMacro(Spacing, int);
  ///@}

  ///@{
  /**
   * Whether the array is no segmentation but a map of any values, such as the probabilities that a
   * network gives: everything at or above Threshold is label 1. Default: off; 0.5.
   */
  vtkSetMacro(UseThreshold, bool);
  vtkGetMacro(UseThreshold, bool);
  vtkBooleanMacro(UseThreshold, bool);
  vtkSetMacro(Threshold, double);
  vtkGetMacro(Threshold, double);
  ///@}

  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

protected:
  vtkSegmentationFilter();
  ~vtkSegmentationFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformationVector** inputVector, vtkInformationVector* outputVector);
  int RequestUpdateExtent(vtkInformationVector** inputVector, vtkInformationVector* outputVector);
  int RequestData(vtkInformationVector** inputVector, vtkInformationVector* outputVector);

  /**
   * Fills `output`. Exceptions become errors of the filter.
   */
  virtual void Extract(FilterRun& run, const SegmentationVolume& volume, vtkDataObject* output) = 0;

  /**
   * What this process holds of a volume that all have in pieces, and how it reaches the others.
   */
  struct SharedVolume
  {
    const midsurface_piece& Piece;
    const ProcessExchange& Exchange;
    /** Null where this process holds no voxel. */
    const SegmentationVolume* Volume;
  };

  /**
   * Fills `output` with this process's share. All processes call it at once.
   */
  virtual void ExtractPiece(FilterRun& run, const SharedVolume& shared, vtkDataObject* output) = 0;

  int Threads = 0;
  int Spacing = AUTOMATIC;
  bool UseThreshold = false;
  double Threshold = 0.5;

private:
  vtkSegmentationFilter(const vtkSegmentationFilter&) = delete;
  void operator=(const vtkSegmentationFilter&) = delete;

  int RequestAll(vtkInformationVector** inputVector, vtkInformationVector* outputVector);
  int RequestShare(vtkInformationVector** inputVector, vtkInformationVector* outputVector);
  void LabelsChanged();
  void RunStarts();

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
