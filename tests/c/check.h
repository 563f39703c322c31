/* Checks that count: a test goes on after a failed one, and fails as a whole. */
#ifndef MIDSURFACE_TESTS_CHECK_H
#define MIDSURFACE_TESTS_CHECK_H

#include "midsurface.h"

#include <stdbool.h>

/* Main thread only. */
#define CHECK(condition) check((condition), #condition, __FILE__, __LINE__)

/* The call must fail with the status and a message that holds the text; frees the error. */
#define CHECK_FAILS(call, error, expected, text)                                                   \
  check_failure((call), &(error), (expected), (text), #call, __FILE__, __LINE__)

#define CHECK_INVALID(call, error, text)                                                           \
  CHECK_FAILS(call, error, MIDSURFACE_STATUS_INVALID_ARGUMENT, text)

/* The call must succeed and leave no error. */
#define CHECK_SUCCEEDS(call, error) check_success((call), &(error), #call, __FILE__, __LINE__)

/* A pointer that must be overwritten, never followed: what uninitialised memory may hold. */
#define STALE(type) ((type*)(uintptr_t)8)

bool check(bool condition, const char* text, const char* file, int line);
void check_failure(midsurface_status status, midsurface_error** error, midsurface_status expected,
  const char* text, const char* call, const char* file, int line);
bool check_success(
  midsurface_status status, midsurface_error** error, const char* call, const char* file, int line);

/* Runs a test and prints its name where it fails. */
void run_test(void (*test)(void), const char* name);
#define RUN(test) run_test(test, #test)

/* Prints "N passed, N failed"; the program's exit code. */
int finish_tests(void);

#endif
