/**
 * @class vtkMidPolylines
 * @brief The lines of the mid-surface in every slice of a segmentation.
 *
 * Input: vtkImageData with labels, see vtkSegmentationFilter. Output: vtkPolyData with one polyline
 * cell a line, in the image's world coordinates, double precision. A line is the cut of the
 * mid-surface with a slice along the image's z axis; a closed line repeats its first point at its
 * end. vtkPolylineZipper joins them to the mesh that vtkMidSurfaceFilter makes.
 *
 * - Point array `Thickness`: distance between both faces of the membrane, in world units.
 * - Point array `BorderDistance`: distance from the border of the image within the slice, in world
 *   units. vtkPolylineZipper moves no point over that border.
 * - Cell arrays `Label` and `Component`: as in vtkMidSurfaceFilter.
 * - Cell array `Slice`: the index of the slice along z, in the image's extent.
 * - Field data array `VoxelSteps`: a matrix of 9 values, row by row, whose columns are the
 *   steps from voxel to voxel along the image's axes.
 */

#ifndef vtkMidPolylines_h
#define vtkMidPolylines_h

#include "vtkSegmentationFilter.h"

class vtkPolyData;

class MIDSURFACEFILTERS_EXPORT vtkMidPolylines : public vtkSegmentationFilter
{
public:
  static vtkMidPolylines* New();
  vtkTypeMacro(vtkMidPolylines, vtkSegmentationFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The polylines, once updated.
   */
  vtkPolyData* GetOutput();

protected:
  vtkMidPolylines();
  ~vtkMidPolylines() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Extract(FilterRun& run, const SegmentationVolume& volume, vtkDataObject* output) override;
  void ExtractPiece(FilterRun& run, const SharedVolume& shared, vtkDataObject* output) override;

private:
  vtkMidPolylines(const vtkMidPolylines&) = delete;
  void operator=(const vtkMidPolylines&) = delete;
};

#endif
