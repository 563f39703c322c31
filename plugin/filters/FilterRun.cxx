#include "FilterRun.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkVersionMacros.h"

#include <exception>
#include <new>

namespace
{
bool IsAborted(vtkAlgorithm* filter)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20230111)
  return filter->CheckAbort();
#else
  return filter->GetAbortExecute() != 0;
#endif
}

void ClearAborted(vtkAlgorithm* filter)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20230111)
  filter->SetAbortOutput(false);
#else
  static_cast<void>(filter);
#endif
}

int Fail(vtkAlgorithm* filter, vtkDataObject* output, const char* message)
{
  output->Initialize();
  vtkErrorWithObjectMacro(filter, << message);
  return 0;
}
} // namespace

//------------------------------------------------------------------------------
FilterRun::FilterRun(vtkAlgorithm* filter, int threads)
  : Filter(filter)
{
  this->Options.Threads = static_cast<uint32_t>(threads);
  this->Options.Progress = [this](double fraction, const char* stage) {
    return this->Report(fraction, stage);
  };
  this->Options.Warning = [this](const char* message) { this->Warn(message); };
}

//------------------------------------------------------------------------------
int FilterRun::Execute(vtkAlgorithm* filter, int threads, vtkDataObject* output,
  const std::function<void(FilterRun&)>& body)
{
  try
  {
    FilterRun run(filter, threads);
    body(run);
    return 1;
  }
  catch (const midsurface::Error& error)
  {
    if (error.Status != MIDSURFACE_STATUS_CANCELLED)
    {
      return Fail(filter, output, error.what());
    }
    output->Initialize();
    // What counts as aborted is run again whenever anybody looks, each time with the same message.
    ClearAborted(filter);
    vtkWarningWithObjectMacro(filter, << "The run was cancelled: the output is empty.");
    return 1;
  }
  catch (const std::bad_alloc&)
  {
    return Fail(filter, output, "There is not enough memory for the output.");
  }
  catch (const std::exception& error)
  {
    return Fail(filter, output, error.what());
  }
}

//------------------------------------------------------------------------------
void FilterRun::Warn(const char* message) const
{
  vtkWarningWithObjectMacro(this->Filter, << message);
}

//------------------------------------------------------------------------------
bool FilterRun::Report(double fraction, const char* stage) const
{
  this->Filter->SetProgressText(stage);
  this->Filter->UpdateProgress(fraction);
  return !IsAborted(this->Filter);
}
