#include "vtkSegmentationFilter.h"

#include "FilterRun.h"
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

class vtkSegmentationFilter::vtkInternals
{
public:
  LabelSelection Labels;

  static vtkMTimeType ChoiceTime(vtkSegmentationFilter* self)
  {
    return self->GetInputArrayInformation(0)->GetMTime();
  }

  static ChosenArray Find(vtkSegmentationFilter* self, vtkImageData* image)
  {
    vtkInformation* wanted = self->GetInputArrayInformation(0);
    const char* name =
      wanted->Has(vtkDataObject::FIELD_NAME()) ? wanted->Get(vtkDataObject::FIELD_NAME()) : nullptr;
    ChosenArray chosen{ nullptr, vtkDataObject::FIELD_ASSOCIATION_POINTS, name ? name : "" };
    chosen.Array = self->GetInputAbstractArrayToProcess(0, image, chosen.Association);
    return chosen;
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
        ChoiceTime(self), self->GetInputDataObject(0, 0), self->Threads);
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
  this->Internals->Labels.RequestChanged(vtkInternals::ChoiceTime(this));
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
    this->Internals->FindLabels(this);
    return 1;
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
  return FilterRun::Execute(this, this->Threads, output, [this, input, output](FilterRun& run) {
    if (!input || input->GetNumberOfPoints() == 0)
    {
      run.Warn("The input has no voxels: the output is empty.");
      return;
    }
    const SegmentationVolume volume(input, vtkInternals::Find(this, input));
    this->Internals->Labels.Apply(run, volume);
    this->Extract(run, volume, output);
    output->GetFieldData()->PassData(input->GetFieldData());
  });
}
