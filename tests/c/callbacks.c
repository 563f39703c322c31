/* Progress, cancelling and warnings. */
#include "check.h"
#include "meshes.h"
#include "volumes.h"

#include <string.h>
#include <threads.h>

struct watch
{
  thrd_t caller;
  int calls;
  int cancel_at; /* 0: never */
  double last;
  bool in_order;
  bool on_caller;
  bool stages_named;
  int warnings;
  char warning[200];
};

static bool watch_progress(void* user, double fraction, const char* stage)
{
  struct watch* watch = user;
  watch->calls++;
  watch->in_order = watch->in_order && fraction >= watch->last && fraction <= 1.0;
  watch->last = fraction;
  watch->on_caller = watch->on_caller && thrd_equal(thrd_current(), watch->caller);
  watch->stages_named = watch->stages_named && stage != NULL && stage[0] != '\0';
  return watch->calls != watch->cancel_at;
}

static void watch_warning(void* user, const char* message)
{
  struct watch* watch = user;
  watch->warnings++;
  watch->on_caller = watch->on_caller && thrd_equal(thrd_current(), watch->caller);
  strncpy(watch->warning, message, sizeof watch->warning - 1);
}

static midsurface_options watched(struct watch* watch, int cancel_at)
{
  const struct watch fresh = { .caller = thrd_current(),
    .cancel_at = cancel_at,
    .in_order = true,
    .on_caller = true,
    .stages_named = true };
  *watch = fresh;
  midsurface_options options = midsurface_options_default();
  options.progress = watch_progress;
  options.warning = watch_warning;
  options.user = watch;
  return options;
}

static void progress_comes_in_order_on_the_calling_thread(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume volume = two_sheets(scalars);
  struct watch watch;
  const midsurface_options options = watched(&watch, 0);
  midsurface_mesh_free(extracted(&volume, &options));
  CHECK(watch.calls > 1);
  CHECK(watch.in_order);
  CHECK(watch.on_caller);
  CHECK(watch.stages_named);
  CHECK(watch.last > 0.5);
  CHECK(watch.warnings == 0);
}

/* What a run is called with beside the options. */
struct subject
{
  midsurface_volume volume;
  midsurface_polylines* lines;
};

typedef midsurface_status run_function(
  const struct subject* subject, const midsurface_options* options, midsurface_error** error);

static midsurface_status run_extract(
  const struct subject* subject, const midsurface_options* options, midsurface_error** error)
{
  midsurface_mesh* mesh = STALE(midsurface_mesh);
  const midsurface_status status = midsurface_extract(&subject->volume, options, &mesh, error);
  CHECK((mesh == NULL) == (status != MIDSURFACE_STATUS_OK));
  midsurface_mesh_free(mesh);
  return status;
}

static midsurface_status run_extract_polylines(
  const struct subject* subject, const midsurface_options* options, midsurface_error** error)
{
  midsurface_polylines* lines = STALE(midsurface_polylines);
  const midsurface_status status =
    midsurface_extract_polylines(&subject->volume, options, &lines, error);
  CHECK((lines == NULL) == (status != MIDSURFACE_STATUS_OK));
  midsurface_polylines_free(lines);
  return status;
}

static midsurface_status run_zip(
  const struct subject* subject, const midsurface_options* options, midsurface_error** error)
{
  midsurface_mesh* mesh = STALE(midsurface_mesh);
  const midsurface_status status = midsurface_zip(subject->lines, options, &mesh, error);
  CHECK((mesh == NULL) == (status != MIDSURFACE_STATUS_OK));
  midsurface_mesh_free(mesh);
  return status;
}

static midsurface_status run_find_labels(
  const struct subject* subject, const midsurface_options* options, midsurface_error** error)
{
  midsurface_label_list* list = STALE(midsurface_label_list);
  const midsurface_status status = midsurface_find_labels(&subject->volume, options, &list, error);
  CHECK((list == NULL) == (status != MIDSURFACE_STATUS_OK));
  midsurface_label_list_free(list);
  return status;
}

static midsurface_status run_ridge_field(
  const struct subject* subject, const midsurface_options* options, midsurface_error** error)
{
  static float floats[2][VOXELS];
  return midsurface_ridge_field(&subject->volume, options, floats[0], floats[1], VOXELS, error);
}

/* Cancels at the first call of progress, then at the second, until the run gets through. */
static void check_cancelling(run_function* run, const struct subject* subject)
{
  struct watch watch;
  for (int at = 1; at < 10000; at++)
  {
    const midsurface_options options = watched(&watch, at);
    midsurface_error* error = NULL;
    const midsurface_status status = run(subject, &options, &error);
    if (watch.calls < at)
    {
      CHECK_SUCCEEDS(status, error);
      CHECK(at > 1); /* else progress never came */
      return;
    }
    CHECK_FAILS(status, error, MIDSURFACE_STATUS_CANCELLED, "cancelled");
    CHECK(watch.calls == at); /* not asked again */
  }
  CHECK(!"a run that ends");
}

static void every_run_can_be_cancelled_at_any_time(void)
{
  static uint8_t scalars[VOXELS];
  struct subject subject = { .volume = two_sheets(scalars) };
  const midsurface_options options = midsurface_options_default();
  midsurface_error* error = NULL;
  CHECK_SUCCEEDS(
    midsurface_extract_polylines(&subject.volume, &options, &subject.lines, &error), error);
  check_cancelling(run_find_labels, &subject);
  check_cancelling(run_extract, &subject);
  check_cancelling(run_extract_polylines, &subject);
  check_cancelling(run_zip, &subject);
  check_cancelling(run_ridge_field, &subject);
  midsurface_polylines_free(subject.lines);
}

static void a_volume_without_labels_gives_an_empty_mesh_and_a_warning(void)
{
  static uint8_t scalars[VOXELS];
  memset(scalars, 0, sizeof scalars);
  const midsurface_volume volume = volume_of(scalars, MIDSURFACE_SCALAR_TYPE_UINT8);
  struct watch watch;
  const midsurface_options options = watched(&watch, 0);
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = NULL;
  CHECK_SUCCEEDS(midsurface_extract(&volume, &options, &mesh, &error), error);
  CHECK(mesh != NULL);
  CHECK(arrays_of(mesh).triangle_count == 0);
  CHECK(arrays_of(mesh).points == NULL);
  CHECK(watch.warnings > 0);
  CHECK(strstr(watch.warning, "label") != NULL);
  CHECK(watch.on_caller);
  midsurface_mesh_free(mesh);
}

void test_callbacks(void)
{
  RUN(progress_comes_in_order_on_the_calling_thread);
  RUN(every_run_can_be_cancelled_at_any_time);
  RUN(a_volume_without_labels_gives_an_empty_mesh_and_a_warning);
}
