#include "ProcessExchange.h"

#include "midsurface.hpp"

#include "vtkCommunicator.h"
#include "vtkMultiProcessController.h"
#include "vtkMultiThreader.h"

#include "vtksys/SystemInformation.hxx"

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

#ifdef __linux__
#include <sched.h>
#endif

namespace
{
/** Tells the messages of this class from others between the same processes. */
constexpr int tag = 0x6d69;

vtkMultiProcessController* Controller()
{
  return vtkMultiProcessController::GetGlobalController();
}

bool Send(void*, size_t to, const int64_t* numbers, size_t length)
{
  return Controller()->Send(numbers, static_cast<vtkIdType>(length), static_cast<int>(to), tag) !=
    0;
}

bool Receive(void*, size_t from, int64_t* numbers, size_t length)
{
  return Controller()->Receive(
           numbers, static_cast<vtkIdType>(length), static_cast<int>(from), tag) != 0;
}

/** Whether this process is bound to some of the machine's cores, as mpiexec may do. */
bool HasCoresOfItsOwn(long cores)
{
#ifdef __linux__
  cpu_set_t own;
  return sched_getaffinity(0, sizeof own, &own) == 0 && CPU_COUNT(&own) < cores;
#else
  static_cast<void>(cores);
  return false;
#endif
}
} // namespace

//------------------------------------------------------------------------------
ProcessExchange::ProcessExchange()
{
  this->Target.processes = static_cast<size_t>(Controller()->GetNumberOfProcesses());
  this->Target.process = static_cast<size_t>(Controller()->GetLocalProcessId());
  this->Target.send = Send;
  this->Target.receive = Receive;
}

//------------------------------------------------------------------------------
void ProcessExchange::Guard(const std::function<void()>& preparation) const
{
  try
  {
    preparation();
  }
  catch (const std::exception& error)
  {
    midsurface::Abandon(this->Target, error.what());
    throw;
  }
}

//------------------------------------------------------------------------------
bool ProcessExchange::Any(bool own) const
{
  const int one = own ? 1 : 0;
  int any = one;
  Controller()->AllReduce(&one, &any, 1, vtkCommunicator::MAX_OP);
  return any != 0;
}

//------------------------------------------------------------------------------
int ProcessExchange::ShareThreads(int wanted) const
{
  vtksys::SystemInformation machine;
  const char* name = machine.GetHostname();
  const auto own = static_cast<long long>(std::hash<std::string>{}(name ? name : ""));
  std::vector<long long> names(this->Target.processes);
  Controller()->AllGather(&own, names.data(), 1);
  const long here = std::max(1L, static_cast<long>(std::count(names.begin(), names.end(), own)));
  const long cores = vtkMultiThreader::GetGlobalDefaultNumberOfThreads();
  if (wanted > 0 || HasCoresOfItsOwn(cores))
  {
    return wanted;
  }
  return static_cast<int>(std::max(1L, cores / here));
}
