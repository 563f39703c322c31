#ifndef LabelTable_h
#define LabelTable_h

#include <cstdint>
#include <map>
#include <set>
#include <string>

class vtkFieldData;

/**
 * The labels that an input holds, and the names that its field data gives them.
 *
 * Names come from the string array `LabelNames`. Where there is a numeric array `LabelValues`, its
 * entries are the labels that are named, in the same order; else entry i names label i.
 *
 * A label is shown as "3", or with its name as "3: outer membrane". A request may be either of
 * these, or the name alone.
 */
class LabelTable
{
public:
  /** Adds labels, without names. */
  template <typename Labels>
  void Add(const Labels& labels)
  {
    for (const int64_t label : labels)
    {
      this->Names.emplace(label, "");
    }
    this->Known = true;
  }

  /** An array was looked at that holds no labels. */
  void AddUnreadable()
  {
    this->Known = true;
    this->Incomplete = true;
  }

  /** Names the labels that have no name yet. */
  void ReadNames(vtkFieldData* fields);

  /**
   * Adds what the other processes know, where this is one of many. All of them have to call this
   * at once, and have the same table then.
   */
  void GatherFromAllProcesses();

  /** Whether labels were looked for at all. */
  bool IsKnown() const { return this->Known; }
  /** Whether an array could not be read, so that there may be more labels. */
  bool IsIncomplete() const { return this->Incomplete; }
  bool Holds(int64_t label) const { return this->Names.count(label) > 0; }
  const std::map<int64_t, std::string>& Entries() const { return this->Names; }

  /** How a label is shown. */
  static std::string Text(const std::pair<const int64_t, std::string>& entry);

  /** The labels that a request means; one that is only a number may not be in the table. */
  std::set<int64_t> Find(const std::string& request) const;

private:
  std::string Pack() const;
  void Unpack(const char* begin, const char* end);

  bool Known = false;
  bool Incomplete = false;
  /** By label; "" where a label has no name. */
  std::map<int64_t, std::string> Names;
};

#endif
