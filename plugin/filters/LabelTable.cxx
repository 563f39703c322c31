#include "LabelTable.h"

#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace
{
constexpr const char* separator = ": ";
/** A line of a message between processes that tells of an array without labels. */
constexpr const char* unreadable = "?";

/** The label that a numeric array names at `index`; false where it is none. */
bool ReadLabel(vtkDataArray* values, vtkIdType index, int64_t& label)
{
  // As text, since a double does not hold all 64-bit labels.
  const std::string text = values->GetVariantValue(index).ToString();
  char* end = nullptr;
  label = std::strtoll(text.c_str(), &end, 10);
  return !text.empty() && *end == '\0';
}

/** The number that a request begins with, alone or before a name; false where there is none. */
bool ReadNumber(const std::string& request, int64_t& label)
{
  const std::string digits = request.substr(0, request.find(separator));
  char* end = nullptr;
  label = std::strtoll(digits.c_str(), &end, 10);
  return end != digits.c_str() && *end == '\0';
}
} // namespace

//------------------------------------------------------------------------------
void LabelTable::ReadNames(vtkFieldData* fields)
{
  auto* names = vtkStringArray::SafeDownCast(fields->GetAbstractArray("LabelNames"));
  vtkDataArray* values = fields->GetArray("LabelValues");
  if (!names || (values && values->GetNumberOfValues() != names->GetNumberOfValues()))
  {
    return;
  }
  for (vtkIdType index = 0; index < names->GetNumberOfValues(); ++index)
  {
    int64_t label = index;
    if (values && !ReadLabel(values, index, label))
    {
      continue;
    }
    const auto entry = this->Names.find(label);
    if (entry != this->Names.end() && entry->second.empty())
    {
      entry->second = names->GetValue(index);
      std::replace(entry->second.begin(), entry->second.end(), '\n', ' ');
    }
  }
}

//------------------------------------------------------------------------------
std::string LabelTable::Text(const std::pair<const int64_t, std::string>& entry)
{
  const std::string number = std::to_string(entry.first);
  return entry.second.empty() ? number : number + separator + entry.second;
}

//------------------------------------------------------------------------------
std::set<int64_t> LabelTable::Find(const std::string& request) const
{
  int64_t label = 0;
  if (ReadNumber(request, label))
  {
    return { label };
  }
  std::set<int64_t> named;
  for (const auto& entry : this->Names)
  {
    if (!entry.second.empty() && entry.second == request)
    {
      named.insert(entry.first);
    }
  }
  return named;
}

//------------------------------------------------------------------------------
void LabelTable::GatherFromAllProcesses()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  if (!controller || controller->GetNumberOfProcesses() < 2)
  {
    return;
  }
  const std::string own = this->Pack();
  vtkNew<vtkCharArray> sent;
  sent->SetNumberOfValues(static_cast<vtkIdType>(own.size()));
  std::copy(own.begin(), own.end(), sent->GetPointer(0));
  vtkNew<vtkCharArray> received;
  if (controller->AllGatherV(sent, received))
  {
    const char* begin = received->GetPointer(0);
    // From nothing, so that the order of the processes decides on names alike everywhere.
    *this = LabelTable();
    this->Unpack(begin, begin + received->GetNumberOfValues());
  }
}

//------------------------------------------------------------------------------
std::string LabelTable::Pack() const
{
  // A line a label; an empty line where labels were looked for, so that nothing is a message too.
  std::string lines = this->Known ? "\n" : " \n";
  lines += this->Incomplete ? unreadable + std::string("\n") : "";
  for (const auto& entry : this->Names)
  {
    lines += LabelTable::Text(entry) + "\n";
  }
  return lines;
}

//------------------------------------------------------------------------------
void LabelTable::Unpack(const char* begin, const char* end)
{
  for (const char* line = begin; line != end;)
  {
    const char* lineEnd = std::find(line, end, '\n');
    const std::string text(line, lineEnd);
    line = lineEnd == end ? end : lineEnd + 1;
    int64_t label = 0;
    this->Known = this->Known || text != " ";
    this->Incomplete = this->Incomplete || text == unreadable;
    if (ReadNumber(text, label))
    {
      std::string& name = this->Names[label];
      const size_t start = text.find(separator);
      if (name.empty() && start != std::string::npos)
      {
        name = text.substr(start + std::string(separator).size());
      }
    }
  }
}
