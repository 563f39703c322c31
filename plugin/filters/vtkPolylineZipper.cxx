#include "vtkPolylineZipper.h"

#include "BlockRun.h"
#include "FilterRun.h"
#include "Pieces.h"
#include "PolyDataConversion.h"

#include "vtkFieldData.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkPolylineZipper);

//------------------------------------------------------------------------------
vtkPolylineZipper::vtkPolylineZipper()
  : Run(std::make_unique<BlockRun>(this))
{}

//------------------------------------------------------------------------------
vtkPolylineZipper::~vtkPolylineZipper() = default;

//------------------------------------------------------------------------------
void vtkPolylineZipper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Threads: " << this->Threads << "\n";
}

//------------------------------------------------------------------------------
int vtkPolylineZipper::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* input = vtkPolyData::GetData(inputVector[0]);
  vtkPolyData* output = vtkPolyData::GetData(outputVector);
  vtkInformation* outputInformation = outputVector->GetInformationObject(0);
  const int result = FilterRun::Execute(this, this->Threads, output, [=](FilterRun& run) {
    if (!Pieces::HasToWork(*this->Run, outputInformation, input))
    {
      return;
    }
    const PolylineInput lines(input);
    const midsurface::Polylines polylines = midsurface::MakePolylines(lines.Arrays());
    const midsurface::Mesh mesh = midsurface::Zip(polylines, run.Options);
    CopyMesh(midsurface::Arrays(mesh), output);
    output->GetFieldData()->PassData(input->GetFieldData());
  });
  return Pieces::Result(outputInformation, result);
}
