/* Tests of midsurface.h in plain C: every function, through the static library. */
#include "check.h"

void test_arguments(void);
void test_data(void);
void test_runs(void);
void test_callbacks(void);
void test_polylines(void);
void test_statistics(void);
void test_pieces(void);

int main(void)
{
  test_arguments();
  test_data();
  test_runs();
  test_callbacks();
  test_polylines();
  test_statistics();
  test_pieces();
  return finish_tests();
}
