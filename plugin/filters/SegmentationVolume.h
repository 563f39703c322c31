#ifndef SegmentationVolume_h
#define SegmentationVolume_h

#include "midsurface.h"

#include "vtkSmartPointer.h"

#include <functional>
#include <optional>
#include <string>

class vtkAbstractArray;
class vtkDataArray;
class vtkImageData;

/** The array that a filter is told to take its labels from. */
struct ChosenArray
{
  /** Null where the image has no such array. */
  vtkAbstractArray* Array;
  /** One of vtkDataObject::FieldAssociations. */
  int Association;
  /** The name it is asked for by; empty: by its role, as the active scalars. */
  std::string Name;
  /** Where there is one, everything at or above it is label 1, and the values are no labels. */
  std::optional<double> Threshold;

  /** The array where it can hold labels, else null. */
  vtkDataArray* Labels() const;
};

/**
 * The array to take where none is named: the active scalars, else the first by name that can hold
 * labels, on points before cells.
 */
ChosenArray FindFirstArray(vtkImageData* image);

/** Looks up the array in an image. */
using ArrayFinder = std::function<ChosenArray(vtkImageData*)>;

/**
 * Where the voxels lie, on the points of `image` or the centres of its cells, had it this spacing:
 * fills dimensions, extent_start, spacing, origin and direction.
 */
void DescribeGrid(
  vtkImageData* image, bool onCells, const double spacing[3], midsurface_volume& volume);

/**
 * The label array of an image and where its voxels lie, as the core wants them described.
 *
 * Labels on points lie on the image's points, labels on cells on the centres of its cells. The
 * array is not copied, unless its values are not contiguous in memory or its type is not one of C's
 * (bits). The image must outlive this object.
 */
class SegmentationVolume
{
public:
  /** @throws std::runtime_error with a message for the user where the array is no label array. */
  SegmentationVolume(vtkImageData* image, const ChosenArray& chosen);

  /** Lets the voxels lie at another spacing than the image's. */
  void SetSpacing(const double spacing[3]);

  const midsurface_volume& Description() const { return this->Volume; }
  vtkImageData* Image() const { return this->Source; }
  /** The array as it is in the image. */
  vtkDataArray* Array() const { return this->Labels; }
  /** Whether the labels lie on cells. */
  bool OnCells() const { return this->CellData; }

private:
  void DescribeScalars();

  vtkImageData* Source;
  vtkDataArray* Labels;
  bool CellData;
  vtkSmartPointer<vtkDataArray> Contiguous;
  midsurface_volume Volume{};
};

#endif
