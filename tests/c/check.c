#include "check.h"

#include <stdio.h>
#include <string.h>

static int passed_tests = 0;
static int failed_tests = 0;
static int failed_checks = 0;

bool check(bool condition, const char* text, const char* file, int line)
{
  if (!condition)
  {
    printf("%s:%d: not true: %s\n", file, line, text);
    failed_checks++;
  }
  return condition;
}

static void complain(const char* what, midsurface_status status, const midsurface_error* error,
  const char* call, const char* file, int line)
{
  printf("%s:%d: %s: %s\n  status %d, message \"%s\"\n", file, line, what, call, (int)status,
    midsurface_error_message(error));
  failed_checks++;
}

void check_failure(midsurface_status status, midsurface_error** error, midsurface_status expected,
  const char* text, const char* call, const char* file, int line)
{
  if (status != expected || *error == NULL)
  {
    complain("not the failure expected", status, *error, call, file, line);
  }
  else if (midsurface_error_status(*error) != status)
  {
    complain("status and error disagree", status, *error, call, file, line);
  }
  else if (strstr(midsurface_error_message(*error), text) == NULL)
  {
    printf("  expected in the message: \"%s\"\n", text);
    complain("not the message expected", status, *error, call, file, line);
  }
  midsurface_error_free(*error);
  *error = NULL;
}

bool check_success(
  midsurface_status status, midsurface_error** error, const char* call, const char* file, int line)
{
  const bool good = status == MIDSURFACE_STATUS_OK && *error == NULL;
  if (!good)
  {
    complain("failed", status, *error, call, file, line);
  }
  midsurface_error_free(*error);
  *error = NULL;
  return good;
}

void run_test(void (*test)(void), const char* name)
{
  failed_checks = 0;
  test();
  if (failed_checks == 0)
  {
    passed_tests++;
    return;
  }
  failed_tests++;
  printf("FAILED %s\n", name);
}

int finish_tests(void)
{
  printf("%d passed, %d failed\n", passed_tests, failed_tests);
  return failed_tests == 0 && passed_tests > 0 ? 0 : 1;
}
