#ifndef FilterRun_h
#define FilterRun_h

#include "midsurface.hpp"

#include <functional>

class vtkAlgorithm;
class vtkDataObject;

/**
 * One run of a filter: what the core is told, and what the filter tells its user meanwhile.
 *
 * Progress goes to the filter's UpdateProgress and SetProgressText, warnings to its warning macro,
 * and an abort of the filter cancels the core. All of that on the thread that runs the filter.
 */
class FilterRun
{
public:
  FilterRun(vtkAlgorithm* filter, int threads);
  FilterRun(const FilterRun&) = delete;
  FilterRun& operator=(const FilterRun&) = delete;

  /**
   * Runs `body`. Errors and an abort end in a message of the filter and an empty `output`.
   * @return what RequestData has to return.
   */
  static int Execute(vtkAlgorithm* filter, int threads, vtkDataObject* output,
    const std::function<void(FilterRun&)>& body);

  /** A warning in the name of the filter. */
  void Warn(const char* message) const;

  /** What the core is to be told. */
  midsurface::Options Options;

private:
  bool Report(double fraction, const char* stage) const;

  vtkAlgorithm* Filter;
};

#endif
