#include "vtkSegmentationFilter.h"

#include "BlockRun.h"
#include "FilterRun.h"
#include "ImageSpacing.h"
#include "LabelSelection.h"
#include "Pieces.h"
#include "ProcessExchange.h"
#include "SegmentationVolume.h"

#include "vtkAbstractArray.h"
#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <optional>

namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/** The extent of the image that `input` may be a piece or a block of. */
const int* WholeExtent(vtkInformationVector** inputVector, vtkImageData* input)
{
  const int* own = input->GetExtent();
  const int* whole = inputVector[0]->GetInformationObject(0)->Get(Pipeline::WHOLE_EXTENT());
  bool isPiece = whole != nullptr;
  for (int axis = 0; isPiece && axis < 3; ++axis)
  {
    isPiece = whole[2 * axis] <= own[2 * axis] && own[2 * axis + 1] <= whole[2 * axis + 1];
  }
  return isPiece ? whole : own;
}

constexpr const char* noVoxels = "The input has no voxels: the output is empty.";

/** Says why no process has labels. */
void ExplainAbsence(
  const FilterRun& run, vtkImageData* input, const ChosenArray& chosen, bool isFirst)
{
  if (input->GetNumberOfPoints() > 0)
  {
    SegmentationVolume(input, chosen);
  }
  if (isFirst)
  {
    run.Warn(noVoxels);
  }
}

/** What this process holds of `whole`: `volume`, or nothing. */
midsurface_piece DescribePiece(
  vtkImageData* whole, bool onCells, const double spacing[3], const SegmentationVolume* volume)
{
  midsurface_volume all{};
  DescribeGrid(whole, onCells, spacing, all);
  midsurface_piece piece{};
  std::copy_n(all.dimensions, 3, piece.whole_dimensions);
  std::copy_n(all.extent_start, 3, piece.whole_extent_start);
  piece.volume = volume ? volume->Description() : all;
  std::copy_n(all.spacing, 3, piece.volume.spacing);
  std::copy_n(all.origin, 3, piece.volume.origin);
  return piece;
}
} // namespace

class vtkSegmentationFilter::vtkInternals
{
public:
  explicit vtkInternals(vtkSegmentationFilter* self)
    : Run(self)
  {}

  LabelSelection Labels;
  BlockRun Run;

  static ChosenArray Find(vtkSegmentationFilter* self, vtkImageData* image)
  {
    vtkInformation* wanted = self->GetInputArrayInformation(0);
    const char* name =
      wanted->Has(vtkDataObject::FIELD_NAME()) ? wanted->Get(vtkDataObject::FIELD_NAME()) : "";
    ChosenArray chosen{ nullptr, vtkDataObject::FIELD_ASSOCIATION_POINTS, name, {} };
    chosen.Array = self->GetInputAbstractArrayToProcess(0, image, chosen.Association);
    if (!chosen.Array && !*name)
    {
      chosen = FindFirstArray(image);
    }
    if (self->UseThreshold)
    {
      chosen.Threshold = self->Threshold;
    }
    return chosen;
  }

  void RequestChanged(vtkSegmentationFilter* self)
  {
    this->Labels.RequestChanged(
      [self](vtkImageData* image) { return Find(self, image); }, self->GetInputDataObject(0, 0));
  }

  /**
   * What upstream made last may still be there before it runs again: that is shown meanwhile.
   * During a run the executive may go through the blocks of a composite input, and shows nothing
   * else; the labels are those of all blocks, found when the run started.
   */
  void FindLabels(vtkSegmentationFilter* self)
  {
    this->Labels.Update([self](vtkImageData* image) { return Find(self, image); },
      self->GetInputDataObject(0, 0), self->Threads);
  }

  /** Whether each process holds a piece of the image, so that all have to work together. */
  bool IsShared(vtkInformation* output) const
  {
    return !this->Run.HasBlocks() && Pieces::AreShared(output);
  }
};

//------------------------------------------------------------------------------
vtkSegmentationFilter::vtkSegmentationFilter()
  : Internals(std::make_unique<vtkInternals>(this))
{
  this->SetNumberOfInputPorts(1);
  this->SetNumberOfOutputPorts(1);
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS_THEN_CELLS, vtkDataSetAttributes::SCALARS);
  this->GetLabels()->AddObserver(
    vtkCommand::ModifiedEvent, this, &vtkSegmentationFilter::LabelsChanged);
  this->AddObserver(vtkCommand::StartEvent, this, &vtkSegmentationFilter::RunStarts);
}

//------------------------------------------------------------------------------
vtkSegmentationFilter::~vtkSegmentationFilter() = default;

//------------------------------------------------------------------------------
void vtkSegmentationFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Threads: " << this->Threads << "\n";
  os << indent << "Spacing: " << this->Spacing << "\n";
  os << indent << "UseThreshold: " << this->UseThreshold << "\n";
  os << indent << "Threshold: " << this->Threshold << "\n";
  os << indent << "Labels:\n";
  this->GetLabels()->PrintSelf(os, indent.GetNextIndent());
  os << indent << "FoundLabels:\n";
  this->GetFoundLabels()->PrintSelf(os, indent.GetNextIndent());
}

//------------------------------------------------------------------------------
void vtkSegmentationFilter::SetInputData(vtkImageData* image)
{
  this->SetInputDataInternal(0, image);
}

//------------------------------------------------------------------------------
vtkDataArraySelection* vtkSegmentationFilter::GetLabels()
{
  return this->Internals->Labels.Requested;
}

//------------------------------------------------------------------------------
void vtkSegmentationFilter::SetLabelStatus(const char* label, int status)
{
  this->GetLabels()->SetArraySetting(label, status);
}

//------------------------------------------------------------------------------
void vtkSegmentationFilter::ClearLabels()
{
  this->GetLabels()->RemoveAllArrays();
}

//------------------------------------------------------------------------------
vtkDataArraySelection* vtkSegmentationFilter::GetFoundLabels()
{
  return this->Internals->Labels.Found;
}

//------------------------------------------------------------------------------
void vtkSegmentationFilter::LabelsChanged()
{
  this->Internals->RequestChanged(this);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkSegmentationFilter::RunStarts()
{
  if (this->Internals->Run.Depth() == 1)
  {
    this->Internals->FindLabels(this);
  }
}

//------------------------------------------------------------------------------
vtkTypeBool vtkSegmentationFilter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_INFORMATION()))
  {
    return this->RequestInformation(inputVector, outputVector);
  }
  if (request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_UPDATE_EXTENT()))
  {
    return this->RequestUpdateExtent(inputVector, outputVector);
  }
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()))
  {
    return this->RequestData(inputVector, outputVector);
  }
  return this->Superclass::ProcessRequest(request, inputVector, outputVector);
}

//------------------------------------------------------------------------------
int vtkSegmentationFilter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkSegmentationFilter::RequestInformation(
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (this->Internals->Run.Depth() == 0)
  {
    this->Internals->FindLabels(this);
  }
  vtkInformation* input = inputVector[0]->GetInformationObject(0);
  if (input->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()) &&
    input->Has(vtkDataObject::SPACING()))
  {
    ImageSpacing spacing(input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()),
      input->Get(vtkDataObject::SPACING()));
    if (this->Spacing == AUTOMATIC && spacing.IsStretched())
    {
      outputVector->GetInformationObject(0)->Set(vtkDataObject::SPACING(), spacing.GetMeant(), 3);
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkSegmentationFilter::RequestUpdateExtent(
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* input = inputVector[0]->GetInformationObject(0);
  vtkInformation* output = outputVector->GetInformationObject(0);
  // The surface within a part depends on what lies around it: work on all of the image. Processes
  // ask for their pieces, which need not cross the network twice, and join them.
  if (!Pieces::AreShared(output) && input->Has(Pipeline::WHOLE_EXTENT()))
  {
    input->Set(Pipeline::UPDATE_EXTENT(), input->Get(Pipeline::WHOLE_EXTENT()), 6);
    input->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
    input->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkSegmentationFilter::RequestData(
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* outputInformation = outputVector->GetInformationObject(0);
  const int result = this->Internals->IsShared(outputInformation)
    ? this->RequestShare(inputVector, outputVector)
    : this->RequestAll(inputVector, outputVector);
  vtkImageData* image = vtkImageData::SafeDownCast(vtkDataObject::GetData(outputVector));
  vtkImageData* piece = vtkImageData::GetData(inputVector[0]);
  if (image && piece && image->GetNumberOfPoints() == 0)
  {
    // An image that lacks the extent that was asked for would be asked for again and again, each
    // time with the same message.
    image->CopyStructure(piece);
  }
  return Pieces::Result(outputInformation, result);
}

//------------------------------------------------------------------------------
int vtkSegmentationFilter::RequestAll(
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* input = vtkImageData::GetData(inputVector[0]);
  vtkDataObject* output = vtkDataObject::GetData(outputVector);
  vtkInformation* outputInformation = outputVector->GetInformationObject(0);
  const BlockRun& blocks = this->Internals->Run;
  return FilterRun::Execute(this, this->Threads, output, [=, &blocks](FilterRun& run) {
    if (!Pieces::HasToWork(blocks, outputInformation) && !vtkImageData::SafeDownCast(output))
    {
      return;
    }
    if (!input || input->GetNumberOfPoints() == 0)
    {
      if (!blocks.HasBlocks() && Pieces::IsFirst(outputInformation))
      {
        run.Warn(noVoxels);
      }
      return;
    }
    SegmentationVolume volume(input, vtkInternals::Find(this, input));
    const ImageSpacing spacing(WholeExtent(inputVector, input), input->GetSpacing());
    if (this->Spacing == AUTOMATIC && spacing.IsStretched())
    {
      volume.SetSpacing(spacing.GetMeant());
      run.Warn(spacing.Explain(input->GetOrigin()[2]).c_str());
    }
    this->Internals->Labels.Apply(run, volume);
    this->Extract(run, volume, output);
    output->GetFieldData()->PassData(input->GetFieldData());
  });
}

//------------------------------------------------------------------------------
int vtkSegmentationFilter::RequestShare(
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* input = vtkImageData::GetData(inputVector[0]);
  vtkDataObject* output = vtkDataObject::GetData(outputVector);
  vtkInformation* outputInformation = outputVector->GetInformationObject(0);
  return FilterRun::Execute(this, this->Threads, output, [=](FilterRun& run) {
    const ChosenArray chosen = vtkInternals::Find(this, input);
    int association = chosen.Association;
    const vtkSmartPointer<vtkImageData> whole =
      Pieces::Frame(inputVector[0]->GetInformationObject(0), input, chosen, association);
    if (!whole)
    {
      ExplainAbsence(run, input, chosen, Pieces::IsFirst(outputInformation));
      return;
    }
    const ProcessExchange exchange;
    run.Options.Threads = static_cast<uint32_t>(exchange.ShareThreads(this->Threads));
    std::optional<SegmentationVolume> volume;
    exchange.Guard([&] {
      if (input->GetNumberOfPoints() > 0)
      {
        volume.emplace(input, chosen);
      }
      const char* name = chosen.Array ? chosen.Array->GetName() : nullptr;
      this->Internals->Labels.ApplyToAll(run, name ? name : chosen.Name);
    });
    const ImageSpacing spacing(whole->GetExtent(), whole->GetSpacing());
    const bool isStretched = this->Spacing == AUTOMATIC && spacing.IsStretched();
    if (isStretched && exchange.IsFirst())
    {
      run.Warn(spacing.Explain(whole->GetOrigin()[2]).c_str());
    }
    const midsurface_piece piece =
      DescribePiece(whole, association == vtkDataObject::FIELD_ASSOCIATION_CELLS,
        isStretched ? spacing.GetMeant() : whole->GetSpacing(), volume ? &*volume : nullptr);
    this->ExtractPiece(run, { piece, exchange, volume ? &*volume : nullptr }, output);
    output->GetFieldData()->PassData(input->GetFieldData());
  });
}
