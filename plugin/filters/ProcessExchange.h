#ifndef ProcessExchange_h
#define ProcessExchange_h

#include "midsurface.h"

#include <functional>

/**
 * How this process reaches the others that update the same pipeline, as the core wants it: by VTK's
 * global controller. Only where Pieces::AreShared.
 */
class ProcessExchange
{
public:
  ProcessExchange();

  const midsurface_exchange& Functions() const { return this->Target; }

  /**
   * Runs `preparation` for what all processes do next. Where it throws, the others are told, so
   * that they do not wait for this one.
   */
  void Guard(const std::function<void()>& preparation) const;

  /** Whether this process is the one that speaks for all. */
  bool IsFirst() const { return this->Target.process == 0; }

  /** Whether any process says so. All processes have to call this at once. */
  bool Any(bool own) const;

  /**
   * The number of threads where `wanted` are asked for: for 0, this machine's cores, shared among
   * the processes on it, or 0 where this one is bound to cores of its own. All processes have to
   * call this at once.
   */
  int ShareThreads(int wanted) const;

private:
  midsurface_exchange Target{};
};

#endif
