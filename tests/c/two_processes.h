/* Two threads in place of two processes. */
#ifndef MIDSURFACE_TESTS_TWO_PROCESSES_H
#define MIDSURFACE_TESTS_TWO_PROCESSES_H

#include "midsurface.h"

/* What a process does. */
typedef void Work(void* of_process, const midsurface_exchange* exchange);

/* Lets two processes work, each on its own, until both are done; false where that cannot be. */
bool run_two(Work* work, void* of_processes[2]);

#endif
