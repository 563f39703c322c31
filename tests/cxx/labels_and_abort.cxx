// Labels chosen from C++, and an abort from a progress observer.
#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkDataArraySelection.h"
#include "vtkImageData.h"
#include "vtkMidSurfaceFilter.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

#include <iostream>

namespace
{
int failures = 0;

void Check(bool condition, const char* what)
{
  if (!condition)
  {
    std::cerr << "failed: " << what << "\n";
    ++failures;
  }
}

/** Two upright sheets, labels 1 and 2. */
void FillSheets(vtkImageData* image)
{
  image->SetDimensions(20, 24, 10);
  image->AllocateScalars(VTK_SHORT, 1);
  auto* values = static_cast<short*>(image->GetScalarPointer());
  for (int index = 0; index < 20 * 24 * 10; ++index)
  {
    const int y = index / 20 % 24;
    values[index] = static_cast<short>(y >= 4 && y < 8 ? 1 : y >= 14 && y < 18 ? 2 : 0);
  }
}

void CheckLabels(vtkMidSurfaceFilter* filter)
{
  filter->Update();
  Check(filter->GetFoundLabels()->GetNumberOfArrays() == 2, "two labels are found");
  const vtkIdType both = filter->GetOutput()->GetNumberOfPolys();

  filter->GetLabels()->EnableArray("2");
  filter->Update();
  double range[2];
  filter->GetOutput()->GetCellData()->GetArray("Label")->GetRange(range);
  Check(range[0] == 2 && range[1] == 2, "only label 2 is extracted");

  filter->ClearLabels();
  filter->GetLabels()->DisableArray("2");
  filter->Update();
  filter->GetOutput()->GetCellData()->GetArray("Label")->GetRange(range);
  Check(range[0] == 1 && range[1] == 1, "all but label 2 is extracted");

  filter->ClearLabels();
  filter->Update();
  Check(filter->GetOutput()->GetNumberOfPolys() == both, "both are extracted again");
}

void CheckAbort(vtkMidSurfaceFilter* filter)
{
  vtkNew<vtkCallbackCommand> abort;
  abort->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
    static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1);
  });
  int warnings = 0;
  vtkNew<vtkCallbackCommand> count;
  count->SetClientData(&warnings);
  count->SetCallback(
    [](vtkObject*, unsigned long, void* client, void*) { ++*static_cast<int*>(client); });
  const unsigned long tag = filter->AddObserver(vtkCommand::ProgressEvent, abort);
  filter->AddObserver(vtkCommand::WarningEvent, count);
  filter->Modified();
  filter->Update();
  Check(filter->GetOutput()->GetNumberOfPoints() == 0, "an aborted run has an empty output");
  Check(warnings == 1, "an aborted run says so");

  filter->RemoveObserver(tag);
  filter->SetAbortExecute(0);
  filter->Modified();
  filter->Update();
  Check(filter->GetOutput()->GetNumberOfPolys() > 0, "the next run is a whole one");
}
} // namespace

int main()
{
  vtkNew<vtkImageData> image;
  FillSheets(image);
  vtkNew<vtkMidSurfaceFilter> filter;
  filter->SetInputData(image);
  CheckLabels(filter);
  CheckAbort(filter);
  return failures ? 1 : 0;
}
