#include "vtkMidPolylines.h"

#include "FilterRun.h"
#include "PolyDataConversion.h"
#include "ProcessExchange.h"
#include "SegmentationVolume.h"

#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkMidPolylines);

//------------------------------------------------------------------------------
vtkMidPolylines::vtkMidPolylines() = default;

//------------------------------------------------------------------------------
vtkMidPolylines::~vtkMidPolylines() = default;

//------------------------------------------------------------------------------
void vtkMidPolylines::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

//------------------------------------------------------------------------------
vtkPolyData* vtkMidPolylines::GetOutput()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(0));
}

//------------------------------------------------------------------------------
int vtkMidPolylines::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkMidPolylines::Extract(
  FilterRun& run, const SegmentationVolume& volume, vtkDataObject* output)
{
  const midsurface::Polylines polylines =
    midsurface::ExtractPolylines(volume.Description(), run.Options);
  CopyPolylines(midsurface::Arrays(polylines), vtkPolyData::SafeDownCast(output));
}

//------------------------------------------------------------------------------
void vtkMidPolylines::ExtractPiece(
  FilterRun& run, const SharedVolume& shared, vtkDataObject* output)
{
  const midsurface::Polylines polylines =
    midsurface::ExtractPolylinesPiece(shared.Piece, shared.Exchange.Functions(), run.Options);
  CopyPolylines(midsurface::Arrays(polylines), vtkPolyData::SafeDownCast(output));
}
