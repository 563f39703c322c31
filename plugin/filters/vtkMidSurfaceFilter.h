/**
 * @class vtkMidSurfaceFilter
 * @brief The mid-surface of every segmented membrane, as a triangle mesh.
 *
 * Input: vtkImageData with labels, see vtkSegmentationFilter. Output: vtkPolyData with triangles in
 * the image's world coordinates, single precision: a 2-manifold with boundary, consistently wound
 * in each component.
 *
 * - Point array `Normals`: unit normals, which agree with the winding.
 * - Point array `Thickness`: distance between both faces of the membrane, in world units.
 * - Cell array `Label`: the label a triangle belongs to.
 * - Cell array `Component`: the connected part of the label, from 0; labels in ascending order,
 *   within a label the largest part first.
 */

#ifndef vtkMidSurfaceFilter_h
#define vtkMidSurfaceFilter_h

#include "vtkSegmentationFilter.h"

class vtkPolyData;

class MIDSURFACEFILTERS_EXPORT vtkMidSurfaceFilter : public vtkSegmentationFilter
{
public:
  static vtkMidSurfaceFilter* New();
  vtkTypeMacro(vtkMidSurfaceFilter, vtkSegmentationFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Methods
  {
    POLYLINE_ZIPPER = 0,
    RIDGE_SURFACE = 1
  };

  ///@{
  /**
   * How the mid-surface is found. RIDGE_SURFACE, the default: in the volume as a whole, whichever
   * way the membrane lies. POLYLINE_ZIPPER: a line in every slice along z, the lines of
   * neighbouring slices joined by triangles.
   */
  vtkSetMacro(Method, int);
  vtkGetMacro(Method, int);
  ///@}

  ///@{
  /**
   * The length of the mesh's edges to aim at, in the image's units; 0, the default: the square root
   * of 2 times the finest spacing. A negative length is an error of the run.
   */
  vtkSetMacro(EdgeLength, double);
  vtkGetMacro(EdgeLength, double);
  ///@}

  /**
   * The mesh, once updated.
   */
  vtkPolyData* GetOutput();

protected:
  vtkMidSurfaceFilter();
  ~vtkMidSurfaceFilter() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Extract(FilterRun& run, const SegmentationVolume& volume, vtkDataObject* output) override;
  void ExtractPiece(FilterRun& run, const SharedVolume& shared, vtkDataObject* output) override;

  int Method = RIDGE_SURFACE;
  double EdgeLength = 0.0;

private:
  void SetOptions(FilterRun& run) const;

  vtkMidSurfaceFilter(const vtkMidSurfaceFilter&) = delete;
  void operator=(const vtkMidSurfaceFilter&) = delete;
};

#endif
