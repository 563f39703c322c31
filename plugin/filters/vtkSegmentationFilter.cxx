#include "vtkSegmentationFilter.h"

#include "FilterRun.h"
#include "ImageSpacing.h"
#include "LabelSelection.h"
#include "SegmentationVolume.h"

#include "vtkCommand.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

namespace
{
/** The extent of the image that `input` may be a piece or a block of. */
const int* WholeExtent(vtkInformationVector** inputVector, vtkImageData* input)
{
  const int* own = input->GetExtent();
  const int* whole =
    inputVector[0]->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT());
  bool isPiece = whole != nullptr;
  for (int axis = 0; isPiece && axis < 3; ++axis)
  {
    isPiece = whole[2 * axis] <= own[2 * axis] && own[2 * axis + 1] <= whole[2 * axis + 1];
  }
  return isPiece ? whole : own;
}
} // namespace

class vtkSegmentationFilter::vtkInternals
{
public:
  LabelSelection Labels;

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
    if (this->RunDepth == 0)
    {
      this->Labels.Update([self](vtkImageData* image) { return Find(self, image); },
        self->GetInputDataObject(0, 0), self->Threads);
    }
  }

  /** Whether the input is a collection of blocks, or a piece of which others have the rest. */
  static bool IsInputSplit(vtkSegmentationFilter* self)
  {
    return vtkCompositeDataSet::SafeDownCast(self->GetInputDataObject(0, 0)) ||
      self->GetOutputInformation(0)->Get(
        vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES()) > 1;
  }

  int RunDepth = 0;
  bool InputIsSplit = false;
};

//------------------------------------------------------------------------------
vtkSegmentationFilter::vtkSegmentationFilter()
  : Internals(std::make_unique<vtkInternals>())
{
  this->SetNumberOfInputPorts(1);
  this->SetNumberOfOutputPorts(1);
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS_THEN_CELLS, vtkDataSetAttributes::SCALARS);
  this->GetLabels()->AddObserver(
    vtkCommand::ModifiedEvent, this, &vtkSegmentationFilter::LabelsChanged);
  this->AddObserver(vtkCommand::StartEvent, this, &vtkSegmentationFilter::RunStarts);
  this->AddObserver(vtkCommand::EndEvent, this, &vtkSegmentationFilter::RunEnds);
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
  // A run on a collection holds one on each of its blocks.
  if (this->Internals->RunDepth == 0)
  {
    this->Internals->FindLabels(this);
    this->Internals->InputIsSplit = vtkInternals::IsInputSplit(this);
  }
  ++this->Internals->RunDepth;
}

//------------------------------------------------------------------------------
void vtkSegmentationFilter::RunEnds()
{
  --this->Internals->RunDepth;
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
  this->Internals->FindLabels(this);
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
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  // The surface within a part depends on what lies around it: work on all of the image.
  if (output->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) <= 1 && input->Has(Pipeline::WHOLE_EXTENT()))
  {
    input->Set(Pipeline::UPDATE_EXTENT(), input->Get(Pipeline::WHOLE_EXTENT()), 6);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkSegmentationFilter::RequestData(
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* input = vtkImageData::GetData(inputVector[0]);
  vtkDataObject* output = vtkDataObject::GetData(outputVector);
  const int result = FilterRun::Execute(this, this->Threads, output, [=](FilterRun& run) {
    if (!input || input->GetNumberOfPoints() == 0)
    {
      if (!this->Internals->InputIsSplit)
      {
        run.Warn("The input has no voxels: the output is empty.");
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
  auto* image = vtkImageData::SafeDownCast(output);
  if (image && input && image->GetNumberOfPoints() == 0)
  {
    // An image that lacks the extent that was asked for would be asked for again and again, each
    // time with the same message.
    image->CopyStructure(input);
  }
  return result;
}
