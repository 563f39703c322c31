/* Arguments that are null, out of range or contradict each other. */
#include "check.h"
#include "volumes.h"

#include <ctype.h>
#include <string.h>

static void version_is_a_number(void)
{
  const char* version = midsurface_version();
  CHECK(isdigit((unsigned char)version[0]));
  CHECK(strchr(version, '.') != NULL);
}

static void defaults_are_as_documented(void)
{
  const midsurface_options options = midsurface_options_default();
  CHECK(options.method == MIDSURFACE_METHOD_RIDGE_SURFACE);
  CHECK(options.threads == 0);
  CHECK(options.edge_length == 0.0);
  CHECK(options.labels == NULL);
  CHECK(options.label_count == 0);
  CHECK(options.progress == NULL);
  CHECK(options.warning == NULL);
  CHECK(options.user == NULL);
}

static void null_handles_are_harmless(void)
{
  midsurface_error_free(NULL);
  midsurface_label_list_free(NULL);
  midsurface_polylines_free(NULL);
  midsurface_mesh_free(NULL);
  CHECK(midsurface_error_status(NULL) == MIDSURFACE_STATUS_OK);
  CHECK(strcmp(midsurface_error_message(NULL), "") == 0);
  CHECK(midsurface_label_list_length(NULL) == 0);
  CHECK(midsurface_label_list_values(NULL) == NULL);
}

static void null_arguments_of_runs_are_named(void)
{
  static uint8_t scalars[VOXELS];
  static float floats[2][VOXELS];
  const midsurface_volume volume = two_sheets(scalars);
  const midsurface_options options = midsurface_options_default();
  midsurface_error* error = STALE(midsurface_error);

  midsurface_label_list* list = STALE(midsurface_label_list);
  CHECK_INVALID(midsurface_find_labels(NULL, &options, &list, &error), error, "`volume` is NULL");
  CHECK(list == NULL);
  CHECK_INVALID(midsurface_find_labels(&volume, NULL, &list, &error), error, "`options` is NULL");
  CHECK_INVALID(midsurface_find_labels(&volume, &options, NULL, &error), error, "`out` is NULL");

  midsurface_mesh* mesh = STALE(midsurface_mesh);
  CHECK_INVALID(midsurface_extract(NULL, &options, &mesh, &error), error, "`volume` is NULL");
  CHECK(mesh == NULL);
  CHECK_INVALID(midsurface_extract(&volume, NULL, &mesh, &error), error, "`options` is NULL");
  CHECK_INVALID(midsurface_extract(&volume, &options, NULL, &error), error, "`out` is NULL");

  midsurface_polylines* lines = STALE(midsurface_polylines);
  CHECK_INVALID(
    midsurface_extract_polylines(NULL, &options, &lines, &error), error, "`volume` is NULL");
  CHECK(lines == NULL);
  CHECK_INVALID(
    midsurface_extract_polylines(&volume, NULL, &lines, &error), error, "`options` is NULL");
  CHECK_INVALID(
    midsurface_extract_polylines(&volume, &options, NULL, &error), error, "`out` is NULL");

  CHECK_INVALID(midsurface_ridge_field(NULL, &options, floats[0], floats[1], VOXELS, &error), error,
    "`volume` is NULL");
  CHECK_INVALID(midsurface_ridge_field(&volume, NULL, floats[0], floats[1], VOXELS, &error), error,
    "`options` is NULL");
  CHECK_INVALID(midsurface_ridge_field(&volume, &options, NULL, floats[1], VOXELS, &error), error,
    "`distance` is NULL");
  CHECK_INVALID(midsurface_ridge_field(&volume, &options, floats[0], NULL, VOXELS, &error), error,
    "`ridge` is NULL");

  /* Without a place for the error the status remains. */
  CHECK(midsurface_extract(NULL, &options, &mesh, NULL) == MIDSURFACE_STATUS_INVALID_ARGUMENT);
}

static void null_arguments_of_views_are_named(void)
{
  const midsurface_options options = midsurface_options_default();
  midsurface_error* error = STALE(midsurface_error);

  midsurface_mesh_arrays mesh_arrays;
  memset(&mesh_arrays, 0xff, sizeof mesh_arrays);
  CHECK_INVALID(midsurface_mesh_view(NULL, &mesh_arrays, &error), error, "`mesh` is NULL");
  CHECK(mesh_arrays.points == NULL && mesh_arrays.point_count == 0);
  CHECK(mesh_arrays.triangles == NULL && mesh_arrays.triangle_count == 0);
  CHECK_INVALID(midsurface_mesh_check(NULL, &error), error, "`mesh` is NULL");

  midsurface_polyline_arrays arrays;
  memset(&arrays, 0xff, sizeof arrays);
  CHECK_INVALID(midsurface_polylines_arrays(NULL, &arrays, &error), error, "`polylines` is NULL");
  CHECK(arrays.points == NULL && arrays.line_count == 0 && arrays.connectivity_length == 0);

  midsurface_polylines* lines = STALE(midsurface_polylines);
  CHECK_INVALID(midsurface_polylines_new(NULL, &lines, &error), error, "`arrays` is NULL");
  CHECK(lines == NULL);
  CHECK_INVALID(midsurface_polylines_new(&arrays, NULL, &error), error, "`out` is NULL");

  midsurface_mesh* mesh = STALE(midsurface_mesh);
  CHECK_INVALID(midsurface_zip(NULL, &options, &mesh, &error), error, "`polylines` is NULL");
  CHECK(mesh == NULL);

  /* Empty polylines are fine, so that the arguments after them can be tried. */
  memset(&arrays, 0, sizeof arrays);
  CHECK_SUCCEEDS(midsurface_polylines_new(&arrays, &lines, &error), error);
  CHECK_INVALID(midsurface_zip(lines, NULL, &mesh, &error), error, "`options` is NULL");
  CHECK_INVALID(midsurface_zip(lines, &options, NULL, &error), error, "`out` is NULL");
  CHECK_INVALID(midsurface_polylines_arrays(lines, NULL, &error), error, "`out` is NULL");
  CHECK_SUCCEEDS(midsurface_zip(lines, &options, &mesh, &error), error);
  CHECK_INVALID(midsurface_mesh_view(mesh, NULL, &error), error, "`out` is NULL");
  midsurface_mesh_free(mesh);
  midsurface_polylines_free(lines);
}

static void unknown_numbers_are_refused(void)
{
  static uint8_t scalars[VOXELS];
  midsurface_volume volume = two_sheets(scalars);
  midsurface_options options = midsurface_options_default();
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = NULL;

  volume.scalar_type = MIDSURFACE_SCALAR_TYPE_FLOAT64 + 1;
  CHECK_INVALID(
    midsurface_extract(&volume, &options, &mesh, &error), error, "`volume.scalar_type` is 10");
  volume.scalar_type = MIDSURFACE_SCALAR_TYPE_UINT8;
  options.method = UINT32_MAX;
  CHECK_INVALID(
    midsurface_extract(&volume, &options, &mesh, &error), error, "`options.method` is 4294967295");
  options.method = MIDSURFACE_METHOD_POLYLINE_ZIPPER;
  CHECK_SUCCEEDS(midsurface_extract(&volume, &options, &mesh, &error), error);
  midsurface_mesh_free(mesh);
  options.method = MIDSURFACE_METHOD_RIDGE_SURFACE;
  options.edge_length = -1.5;
  CHECK_INVALID(midsurface_extract(&volume, &options, &mesh, &error), error, "edge length -1.5");
  options.edge_length = 0.0;
  options.label_count = 2;
  CHECK_INVALID(midsurface_extract(&volume, &options, &mesh, &error), error, "`options.labels`");
}

static void ridge_field_arrays_are_checked(void)
{
  static union
  {
    uint8_t scalars[VOXELS];
    float floats[3 * VOXELS];
  } memory;
  float* const floats = memory.floats + VOXELS;
  const midsurface_volume volume = two_sheets(memory.scalars);
  const midsurface_options options = midsurface_options_default();
  midsurface_error* error = NULL;

  CHECK_INVALID(
    midsurface_ridge_field(&volume, &options, floats, floats + VOXELS, VOXELS - 1, &error), error,
    "`length` is 5759");
  CHECK_INVALID(midsurface_ridge_field(&volume, &options, floats, floats + 1, VOXELS, &error),
    error, "`distance` and `ridge` overlap");
  CHECK_INVALID(midsurface_ridge_field(&volume, &options, floats, memory.floats, VOXELS, &error),
    error, "`ridge` and `volume.scalars` overlap");
  void* odd = (unsigned char*)floats + 1;
  CHECK_INVALID(midsurface_ridge_field(&volume, &options, odd, floats + VOXELS, VOXELS, &error),
    error, "`distance` is not aligned");
}

void test_arguments(void)
{
  RUN(version_is_a_number);
  RUN(defaults_are_as_documented);
  RUN(null_handles_are_harmless);
  RUN(null_arguments_of_runs_are_named);
  RUN(null_arguments_of_views_are_named);
  RUN(unknown_numbers_are_refused);
  RUN(ridge_field_arrays_are_checked);
}
