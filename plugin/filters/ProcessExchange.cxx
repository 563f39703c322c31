#include "ProcessExchange.h"

#include "midsurface.hpp"

#include "vtkMultiProcessController.h"
#include "vtkMultiThreader.h"

#include "vtksys/SystemInformation.hxx"

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

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
int ProcessExchange::ShareThreads(int wanted) const
{
  vtksys::SystemInformation machine;
  const long long own =
    static_cast<long long>(std::hash<std::string>{}(machine.GetFullyQualifiedDomainName()));
  std::vector<long long> names(this->Target.processes);
  Controller()->AllGather(&own, names.data(), 1);
  const long here = std::max(1L, static_cast<long>(std::count(names.begin(), names.end(), own)));
  const long cores = vtkMultiThreader::GetGlobalDefaultNumberOfThreads();
  return wanted > 0 ? wanted : static_cast<int>(std::max(1L, cores / here));
}
