#include "vtkSegmentationFilter.h"

#include "FilterRun.h"
#include "ImageSpacing.h"
#include "LabelSelection.h"
#include "SegmentationVolume.h"

#include "vtkCommand.h"
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
    ChosenArray chosen{ nullptr, vtkDataObject::FIELD_ASSOCIATION_POINTS, name };
    chosen.Array = self->GetInputAbstractArrayToProcess(0, image, chosen.Association);
    return chosen.Array || *name ? chosen : FindFirstArray(image);
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
    if (!this->Running)
    {
      this->Labels.Update([self](vtkImageData* image) { return Find(self, image); },
        self->GetInputDataObject(0, 0), self->Threads);
    }
  }

  bool Running = false;
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
  this->Internals->FindLabels(this);
  this->Internals->Running = true;
}

//------------------------------------------------------------------------------
void vtkSegmentationFilter::RunEnds()
{
  this->Internals->Running = false;
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
  return FilterRun::Execute(this, this->Threads, output, [=](FilterRun& run) {
    if (!input || input->GetNumberOfPoints() == 0)
    {
      run.Warn("The input has no voxels: the output is empty.");
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
