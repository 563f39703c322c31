#include "vtkRidgeField.h"

#include "ArrayValues.h"
#include "FilterRun.h"
#include "ProcessExchange.h"
#include "SegmentationVolume.h"

#include "vtkCellData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

#include <optional>

vtkStandardNewMacro(vtkRidgeField);

namespace
{
/** The arrays that the filter adds, of one value a voxel. */
struct Fields
{
  explicit Fields(size_t length)
  {
    this->Distance->SetName("Distance");
    AllocateTuples(this->Distance, length);
    this->Ridge->SetName("RidgeField");
    AllocateTuples(this->Ridge, length);
  }

  /** Makes `output` the image of `volume` with these arrays, at this spacing. */
  void AddTo(const SegmentationVolume& volume, const double spacing[3], vtkImageData* output) const
  {
    output->ShallowCopy(volume.Image());
    output->SetSpacing(spacing);
    vtkDataSetAttributes* fields = output->GetPointData();
    if (volume.OnCells())
    {
      fields = output->GetCellData();
    }
    fields->AddArray(this->Distance);
    fields->AddArray(this->Ridge);
  }

  vtkNew<vtkFloatArray> Distance;
  vtkNew<vtkFloatArray> Ridge;
};
} // namespace

//------------------------------------------------------------------------------
vtkRidgeField::vtkRidgeField() = default;

//------------------------------------------------------------------------------
vtkRidgeField::~vtkRidgeField() = default;

//------------------------------------------------------------------------------
void vtkRidgeField::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

//------------------------------------------------------------------------------
vtkImageData* vtkRidgeField::GetOutput()
{
  return vtkImageData::SafeDownCast(this->GetOutputDataObject(0));
}

//------------------------------------------------------------------------------
int vtkRidgeField::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkRidgeField::Extract(FilterRun& run, const SegmentationVolume& volume, vtkDataObject* output)
{
  const Fields fields(volume.Description().length);
  midsurface::RidgeField(volume.Description(), fields.Distance->GetPointer(0),
    fields.Ridge->GetPointer(0), volume.Description().length, run.Options);
  fields.AddTo(volume, volume.Description().spacing, vtkImageData::SafeDownCast(output));
}

//------------------------------------------------------------------------------
void vtkRidgeField::ExtractPiece(FilterRun& run, const SharedVolume& shared, vtkDataObject* output)
{
  const size_t length = shared.Piece.volume.length;
  std::optional<Fields> fields;
  shared.Exchange.Guard([&] { fields.emplace(length); });
  midsurface::RidgeFieldPiece(shared.Piece, shared.Exchange.Functions(),
    fields->Distance->GetPointer(0), fields->Ridge->GetPointer(0), length, run.Options);
  if (shared.Volume)
  {
    fields->AddTo(*shared.Volume, shared.Piece.volume.spacing, vtkImageData::SafeDownCast(output));
  }
}
