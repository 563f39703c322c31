/**
 * @class vtkMidSurfaceStatistics
 * @brief The figures of a triangle mesh: size, shape, thickness and quality, as a table.
 *
 * Input: vtkPolyData whose polygons are triangles, such as vtkMidSurfaceFilter makes; other cells
 * are not looked at. Output: vtkTable with a row in total, then one for each label of the cell
 * array `Label`, in ascending order, followed by one for each of its components in the cell array
 * `Component`. Without these arrays there is the total only, or no rows for labels.
 *
 * Columns, lengths in the mesh's units:
 * - `Of`: "total", "label 1", or "label 1: outer membrane" where field data names it (see
 *   vtkSegmentationFilter), and "component 0".
 * - `Label`, `Component`: numbers; NaN where a row is about more than one.
 * - `Points`, `Triangles`, `Area`.
 * - `Closed`: 1 where no edge has a single triangle, else 0. `EulerNumber`: points - edges +
 *   triangles. `BoundaryLength`, and `BoundaryLoops`: the number of connected rims.
 * - `ThicknessMean`, `Thickness5`, `Thickness25`, `ThicknessMedian`, `Thickness75`, `Thickness95`:
 *   mean and quantiles of the point array `Thickness`; NaN where there is none.
 * - `Qmin`, `Qavg`: least and mean shape factor of the triangles, 1 for equilateral ones.
 *   `MeanSmallestAngle` in degrees; `ShareUnder30` and `ShareOver120` of the angles; `V567`: the
 *   share of the points off the boundary that have five, six or seven edges. Shares are 0 to 1.
 *
 * Under MPI the mesh may be spread over the processes, each component on one of them, as
 * vtkMidSurfaceFilter leaves it: the first process makes the table of all.
 */

#ifndef vtkMidSurfaceStatistics_h
#define vtkMidSurfaceStatistics_h

#include "MidSurfaceFiltersModule.h"
#include "vtkTableAlgorithm.h"

#include <memory>

class BlockRun;

class MIDSURFACEFILTERS_EXPORT vtkMidSurfaceStatistics : public vtkTableAlgorithm
{
public:
  static vtkMidSurfaceStatistics* New();
  vtkTypeMacro(vtkMidSurfaceStatistics, vtkTableAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkMidSurfaceStatistics();
  ~vtkMidSurfaceStatistics() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

private:
  vtkMidSurfaceStatistics(const vtkMidSurfaceStatistics&) = delete;
  void operator=(const vtkMidSurfaceStatistics&) = delete;

  std::unique_ptr<BlockRun> Run;
};

#endif
