#include "vtkPolylineZipper.h"

#include "BlockRun.h"
#include "FilterRun.h"
#include "Pieces.h"
#include "PolyDataConversion.h"
#include "ProcessExchange.h"

#include "vtkFieldData.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkPolylineZipper);

namespace
{
midsurface::Polylines ReadLines(vtkPolyData* input)
{
  const PolylineInput lines(input);
  return midsurface::MakePolylines(lines.Arrays());
}

/** Each process joins the lines that it has. */
void ZipTogether(FilterRun& run, int threads, vtkPolyData* input, vtkPolyData* output)
{
  const ProcessExchange exchange;
  run.Options.Threads = static_cast<uint32_t>(exchange.ShareThreads(threads));
  const bool hasLines = input->GetNumberOfLines() > 0;
  // Where nobody has any, the first one says so.
  const bool isAmiss = !exchange.Any(hasLines) && exchange.IsFirst();
  midsurface::Polylines lines;
  exchange.Guard(
    [&] { lines = hasLines || isAmiss ? ReadLines(input) : midsurface::MakePolylines({}); });
  const midsurface::Mesh mesh = midsurface::ZipPiece(lines, exchange.Functions(), run.Options);
  CopyMeshPiece(midsurface::Arrays(mesh), output);
}
} // namespace

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
    if (!this->Run->HasBlocks() && Pieces::AreShared(outputInformation))
    {
      ZipTogether(run, this->Threads, input, output);
    }
    else if (Pieces::HasToWork(*this->Run, outputInformation))
    {
      const midsurface::Polylines lines = ReadLines(input);
      const midsurface::Mesh mesh = midsurface::Zip(lines, run.Options);
      CopyMesh(midsurface::Arrays(mesh), output);
    }
    output->GetFieldData()->PassData(input->GetFieldData());
  });
  return Pieces::Result(outputInformation, result);
}
