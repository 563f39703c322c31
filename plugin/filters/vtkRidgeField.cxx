#include "vtkRidgeField.h"

#include "ArrayValues.h"
#include "FilterRun.h"
#include "SegmentationVolume.h"

#include "vtkCellData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

vtkStandardNewMacro(vtkRidgeField);

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
  vtkNew<vtkFloatArray> distance;
  distance->SetName("Distance");
  AllocateTuples(distance, volume.Description().length);
  vtkNew<vtkFloatArray> ridge;
  ridge->SetName("RidgeField");
  AllocateTuples(ridge, volume.Description().length);
  midsurface::RidgeField(volume.Description(), distance->GetPointer(0), ridge->GetPointer(0),
    volume.Description().length, run.Options);

  vtkImageData* image = vtkImageData::SafeDownCast(output);
  image->ShallowCopy(volume.Image());
  image->SetSpacing(volume.Description().spacing);
  vtkDataSetAttributes* fields = image->GetPointData();
  if (volume.OnCells())
  {
    fields = image->GetCellData();
  }
  fields->AddArray(distance);
  fields->AddArray(ridge);
}
