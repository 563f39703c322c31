/**
 * @class vtkPolylineZipper
 * @brief Joins the lines of neighbouring slices to a triangle mesh.
 *
 * Input: the vtkPolyData that vtkMidPolylines makes, of which the line cells with these arrays are
 * read: cell array `Slice` (required); `Label` and `Component` (default: 1 and 0), and the point
 * arrays `Thickness` (default: 0) and `BorderDistance` (default: there is no border); and the field
 * data array `VoxelSteps` (default: unknown, so that terraces of voxels are flattened less).
 * Output: the mesh that vtkMidSurfaceFilter makes before it is remeshed, see there.
 */

#ifndef vtkPolylineZipper_h
#define vtkPolylineZipper_h

#include "MidSurfaceFiltersModule.h"
#include "vtkPolyDataAlgorithm.h"

#include <memory>

class BlockRun;

class MIDSURFACEFILTERS_EXPORT vtkPolylineZipper : public vtkPolyDataAlgorithm
{
public:
  static vtkPolylineZipper* New();
  vtkTypeMacro(vtkPolylineZipper, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Number of threads; 0, the default: one a core. The output does not depend on it.
   */
  vtkSetClampMacro(Threads, int, 0, VTK_INT_MAX);
  vtkGetMacro(Threads, int);
  ///@}

protected:
  vtkPolylineZipper();
  ~vtkPolylineZipper() override;

  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

  int Threads = 0;

private:
  vtkPolylineZipper(const vtkPolylineZipper&) = delete;
  void operator=(const vtkPolylineZipper&) = delete;

  std::unique_ptr<BlockRun> Run;
};

#endif
