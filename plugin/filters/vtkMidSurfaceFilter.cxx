#include "vtkMidSurfaceFilter.h"

#include "FilterRun.h"
#include "PolyDataConversion.h"
#include "ProcessExchange.h"
#include "SegmentationVolume.h"

#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkMidSurfaceFilter);

static_assert(static_cast<int>(vtkMidSurfaceFilter::POLYLINE_ZIPPER) ==
      static_cast<int>(MIDSURFACE_METHOD_POLYLINE_ZIPPER) &&
    static_cast<int>(vtkMidSurfaceFilter::RIDGE_SURFACE) ==
      static_cast<int>(MIDSURFACE_METHOD_RIDGE_SURFACE),
  "Method is passed on as it is");

//------------------------------------------------------------------------------
vtkMidSurfaceFilter::vtkMidSurfaceFilter() = default;

//------------------------------------------------------------------------------
vtkMidSurfaceFilter::~vtkMidSurfaceFilter() = default;

//------------------------------------------------------------------------------
void vtkMidSurfaceFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Method: " << this->Method << "\n";
  os << indent << "EdgeLength: " << this->EdgeLength << "\n";
}

//------------------------------------------------------------------------------
vtkPolyData* vtkMidSurfaceFilter::GetOutput()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(0));
}

//------------------------------------------------------------------------------
int vtkMidSurfaceFilter::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkMidSurfaceFilter::SetOptions(FilterRun& run) const
{
  run.Options.Method = static_cast<uint32_t>(this->Method);
  run.Options.EdgeLength = this->EdgeLength;
}

//------------------------------------------------------------------------------
void vtkMidSurfaceFilter::Extract(
  FilterRun& run, const SegmentationVolume& volume, vtkDataObject* output)
{
  this->SetOptions(run);
  const midsurface::Mesh mesh = midsurface::Extract(volume.Description(), run.Options);
  CopyMesh(midsurface::Arrays(mesh), vtkPolyData::SafeDownCast(output));
}

//------------------------------------------------------------------------------
void vtkMidSurfaceFilter::ExtractPiece(
  FilterRun& run, const SharedVolume& shared, vtkDataObject* output)
{
  this->SetOptions(run);
  const midsurface::Mesh mesh =
    midsurface::ExtractPiece(shared.Piece, shared.Exchange.Functions(), run.Options);
  CopyMeshPiece(midsurface::Arrays(mesh), vtkPolyData::SafeDownCast(output));
}
