#include "BlockRun.h"

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkCompositeDataSet.h"

//------------------------------------------------------------------------------
BlockRun::BlockRun(vtkAlgorithm* filter)
  : Filter(filter)
{
  // Before the filter's own observers, whichever was added first.
  constexpr float early = 1.0F;
  filter->AddObserver(vtkCommand::StartEvent, this, &BlockRun::Starts, early);
  filter->AddObserver(vtkCommand::EndEvent, this, &BlockRun::Ends);
}

//------------------------------------------------------------------------------
void BlockRun::Starts()
{
  if (this->Running == 0)
  {
    this->Blocks = vtkCompositeDataSet::SafeDownCast(this->Filter->GetInputDataObject(0, 0));
  }
  ++this->Running;
}

//------------------------------------------------------------------------------
void BlockRun::Ends()
{
  --this->Running;
}
