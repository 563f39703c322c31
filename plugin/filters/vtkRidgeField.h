/**
 * @class vtkRidgeField
 * @brief The distance to a membrane's faces, and the ridge field whose crests are its mid-surface.
 *
 * Input: vtkImageData with labels, see vtkSegmentationFilter. Output: the same vtkImageData with
 * two more single precision arrays, on points or cells as the labels are:
 *
 * - `Distance`: how far a labelled voxel is from the nearest voxel outside its label, in world
 *   units; 0 elsewhere.
 * - `RidgeField`: the distance smoothed, each connected part by its own thickness; 0 away from the
 *   labels.
 */

#ifndef vtkRidgeField_h
#define vtkRidgeField_h

#include "vtkSegmentationFilter.h"

class vtkImageData;

class MIDSURFACEFILTERS_EXPORT vtkRidgeField : public vtkSegmentationFilter
{
public:
  static vtkRidgeField* New();
  vtkTypeMacro(vtkRidgeField, vtkSegmentationFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The image, once updated.
   */
  vtkImageData* GetOutput();

protected:
  vtkRidgeField();
  ~vtkRidgeField() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Extract(FilterRun& run, const SegmentationVolume& volume, vtkDataObject* output) override;
  void ExtractPiece(FilterRun& run, const SharedVolume& shared, vtkDataObject* output) override;

private:
  vtkRidgeField(const vtkRidgeField&) = delete;
  void operator=(const vtkRidgeField&) = delete;
};

#endif
