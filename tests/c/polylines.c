/* Polylines as arrays: out, in again, zipped, and refused where they are broken. */
#include "check.h"
#include "meshes.h"
#include "volumes.h"

#include <math.h>
#include <string.h>

static midsurface_polylines* traced(const midsurface_volume* volume)
{
  const midsurface_options options = midsurface_options_default();
  midsurface_error* error = STALE(midsurface_error);
  midsurface_polylines* lines = NULL;
  CHECK_SUCCEEDS(midsurface_extract_polylines(volume, &options, &lines, &error), error);
  return lines;
}

static midsurface_polyline_arrays arrays_of_lines(const midsurface_polylines* lines)
{
  midsurface_polyline_arrays arrays = { 0 };
  midsurface_error* error = STALE(midsurface_error);
  CHECK_SUCCEEDS(midsurface_polylines_arrays(lines, &arrays, &error), error);
  return arrays;
}

/* Whether line l ends where it began. */
static bool is_closed(const midsurface_polyline_arrays* arrays, size_t l)
{
  const int64_t first = arrays->offsets[l];
  const int64_t last = arrays->offsets[l + 1] - 1;
  return last > first && arrays->connectivity[first] == arrays->connectivity[last];
}

static void the_lines_of_a_tube_are_closed(void)
{
  static uint8_t scalars[VOXELS];
  midsurface_volume volume = tube(scalars);
  volume.extent_start[2] = 40;
  midsurface_polylines* lines = traced(&volume);
  const midsurface_polyline_arrays arrays = arrays_of_lines(lines);
  bool slices[DEPTH] = { false };
  CHECK(arrays.line_count == DEPTH);
  for (size_t l = 0; l < arrays.line_count; l++)
  {
    const int64_t slice = arrays.slices[l] - 40;
    CHECK(is_closed(&arrays, l));
    CHECK(arrays.labels[l] == 1);
    CHECK(arrays.components[l] == 0);
    if (CHECK(slice >= 0 && slice < DEPTH))
    {
      slices[slice] = true;
    }
    for (int64_t entry = arrays.offsets[l]; entry < arrays.offsets[l + 1]; entry++)
    {
      const double* point = arrays.points + 3 * arrays.connectivity[entry];
      const double radius = hypot(point[0] - 11.5, point[1] - 9.5);
      CHECK(fabs(radius - 6.75) < 1.0);
      CHECK(fabs(point[2] - (double)arrays.slices[l]) < 1e-9);
    }
  }
  for (int slice = 0; slice < DEPTH; slice++)
  {
    CHECK(slices[slice]);
  }
  midsurface_polylines_free(lines);
}

/* Out as arrays, in again, zipped: the mesh of the lines themselves, and the one call's surface. */
static void check_round_trip(const midsurface_volume* volume)
{
  midsurface_options options = midsurface_options_default();
  options.method = MIDSURFACE_METHOD_POLYLINE_ZIPPER;
  midsurface_error* error = NULL;
  midsurface_polylines* lines = traced(volume);
  midsurface_mesh* expected = NULL;
  CHECK_SUCCEEDS(midsurface_zip(lines, &options, &expected, &error), error);
  const midsurface_polyline_arrays arrays = arrays_of_lines(lines);
  midsurface_polylines* again = NULL;
  CHECK_SUCCEEDS(midsurface_polylines_new(&arrays, &again, &error), error);
  midsurface_polylines_free(lines);
  midsurface_mesh* zipped = NULL;
  CHECK_SUCCEEDS(midsurface_zip(again, &options, &zipped, &error), error);
  CHECK(arrays_of(zipped).triangle_count > 0);
  CHECK(same_mesh(expected, zipped));
  midsurface_mesh* whole = extracted(volume, &options);
  CHECK(fabs(area_of(whole) / area_of(zipped) - 1.0) < 0.02);
  midsurface_mesh_free(whole);
  midsurface_mesh_free(expected);
  midsurface_mesh_free(zipped);
  midsurface_polylines_free(again);
}

static void the_chain_gives_the_one_calls_surface(void)
{
  static uint8_t scalars[VOXELS];
  midsurface_volume volume = tube(scalars);
  check_round_trip(&volume);
  volume = two_sheets(scalars);
  check_round_trip(&volume);
  volume.spacing[0] = 1.3;
  volume.spacing[2] = 2.1;
  volume.origin[1] = -1234.567;
  volume.extent_start[2] = -3;
  check_round_trip(&volume);
}

/* Two straight lines in slices 0 and 1, and a square in slice 1, which uses points of its own. */
enum
{
  POINTS = 8,
  LINES = 3,
  ENTRIES = 9
};

struct drawing
{
  double points[POINTS][3];
  float thickness[POINTS];
  float border_distance[POINTS];
  int64_t offsets[LINES + 1];
  int64_t connectivity[ENTRIES];
  int64_t labels[LINES];
  int64_t components[LINES];
  int64_t slices[LINES];
  double voxel_steps[9];
};

static const struct drawing good_drawing = {
  .points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 5, 5, 1 }, { 6, 5, 1 },
    { 6, 6, 1 }, { 5, 6, 1 } },
  .thickness = { 2, 2, 2, 2, 3, 3, 3, 3 },
  .border_distance = { 0, 1, 0, 1, 5, 5, 6, 6 },
  .offsets = { 0, 2, 4, 9 },
  .connectivity = { 0, 1, 3, 2, 4, 5, 6, 7, 4 },
  .labels = { 1, 1, -4 },
  .components = { 0, 0, 9 },
  .slices = { 0, 1, 1 },
  .voxel_steps = { 0, 1, 0, 1, 0, 0, 0, 0, -1 },
};

static midsurface_polyline_arrays arrays_of_drawing(const struct drawing* drawing)
{
  const midsurface_polyline_arrays arrays = {
    .points = drawing->points[0],
    .point_count = POINTS,
    .thickness = drawing->thickness,
    .border_distance = drawing->border_distance,
    .offsets = drawing->offsets,
    .line_count = LINES,
    .connectivity = drawing->connectivity,
    .connectivity_length = ENTRIES,
    .labels = drawing->labels,
    .components = drawing->components,
    .slices = drawing->slices,
    .voxel_steps = drawing->voxel_steps,
  };
  return arrays;
}

static midsurface_polylines* drawn(const midsurface_polyline_arrays* arrays)
{
  midsurface_error* error = STALE(midsurface_error);
  midsurface_polylines* lines = NULL;
  CHECK_SUCCEEDS(midsurface_polylines_new(arrays, &lines, &error), error);
  return lines;
}

static void arrays_are_copied_as_they_are(void)
{
  struct drawing drawing = good_drawing;
  const midsurface_polyline_arrays in = arrays_of_drawing(&drawing);
  midsurface_polylines* lines = drawn(&in);
  memset(&drawing, 0xff, sizeof drawing);
  const midsurface_polyline_arrays out = arrays_of_lines(lines);
  if (CHECK(out.line_count == LINES) && CHECK(out.connectivity_length == ENTRIES))
  {
    CHECK(memcmp(out.offsets, good_drawing.offsets, sizeof good_drawing.offsets) == 0);
    CHECK(memcmp(out.labels, good_drawing.labels, sizeof good_drawing.labels) == 0);
    CHECK(memcmp(out.components, good_drawing.components, sizeof good_drawing.components) == 0);
    CHECK(memcmp(out.slices, good_drawing.slices, sizeof good_drawing.slices) == 0);
    CHECK(memcmp(out.voxel_steps, good_drawing.voxel_steps, sizeof good_drawing.voxel_steps) == 0);
    for (int entry = 0; entry < ENTRIES; entry++)
    {
      const int64_t from = good_drawing.connectivity[entry];
      const int64_t to = out.connectivity[entry];
      CHECK(memcmp(out.points + 3 * to, good_drawing.points[from], 3 * sizeof(double)) == 0);
      CHECK(out.thickness[to] == good_drawing.thickness[from]);
      CHECK(out.border_distance[to] == good_drawing.border_distance[from]);
    }
    CHECK(!is_closed(&out, 0) && !is_closed(&out, 1) && is_closed(&out, 2));
  }
  midsurface_polylines_free(lines);
}

static void arrays_that_may_be_null_have_defaults(void)
{
  midsurface_polyline_arrays arrays = arrays_of_drawing(&good_drawing);
  arrays.thickness = NULL;
  arrays.border_distance = NULL;
  arrays.labels = NULL;
  arrays.components = NULL;
  arrays.voxel_steps = NULL;
  midsurface_polylines* lines = drawn(&arrays);
  const midsurface_polyline_arrays out = arrays_of_lines(lines);
  for (size_t l = 0; l < out.line_count; l++)
  {
    CHECK(out.labels[l] == 1);
    CHECK(out.components[l] == 0);
  }
  for (size_t p = 0; p < out.point_count; p++)
  {
    CHECK(out.thickness[p] == 0.0F);
    CHECK(isinf(out.border_distance[p]));
  }
  for (int i = 0; i < 9; i++)
  {
    CHECK(out.voxel_steps[i] == 0.0);
  }
  CHECK(out.line_count == LINES && out.point_count == POINTS);
  midsurface_polylines_free(lines);
}

static void lines_that_face_each_other_are_joined(void)
{
  const midsurface_polyline_arrays arrays = arrays_of_drawing(&good_drawing);
  const midsurface_options options = midsurface_options_default();
  midsurface_polylines* lines = drawn(&arrays);
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = NULL;
  CHECK_SUCCEEDS(midsurface_zip(lines, &options, &mesh, &error), error);
  CHECK_SUCCEEDS(midsurface_mesh_check(mesh, &error), error);
  const midsurface_mesh_arrays out = arrays_of(mesh);
  CHECK(out.triangle_count == 2);
  for (size_t t = 0; t < out.triangle_count; t++)
  {
    CHECK(out.labels[t] == 1);
  }
  midsurface_mesh_free(mesh);
  midsurface_polylines_free(lines);
}

static void the_order_of_lines_does_not_matter(void)
{
  struct drawing drawing = good_drawing;
  drawing.slices[0] = 1; /* the upper line first */
  drawing.slices[1] = 0;
  for (int p = 0; p < 4; p++)
  {
    drawing.points[p][2] = 1.0 - drawing.points[p][2];
  }
  const midsurface_polyline_arrays arrays = arrays_of_drawing(&drawing);
  const midsurface_options options = midsurface_options_default();
  midsurface_polylines* lines = drawn(&arrays);
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = NULL;
  CHECK_SUCCEEDS(midsurface_zip(lines, &options, &mesh, &error), error);
  CHECK_SUCCEEDS(midsurface_mesh_check(mesh, &error), error);
  CHECK(arrays_of(mesh).triangle_count == 2);
  midsurface_mesh_free(mesh);
  midsurface_polylines_free(lines);
}

static void lines_that_leave_their_slice_are_refused(void)
{
  struct drawing drawing = good_drawing;
  drawing.points[1][2] = 0.5;
  const midsurface_polyline_arrays arrays = arrays_of_drawing(&drawing);
  const midsurface_options options = midsurface_options_default();
  midsurface_polylines* lines = drawn(&arrays);
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = STALE(midsurface_mesh);
  CHECK_INVALID(
    midsurface_zip(lines, &options, &mesh, &error), error, "polylines cannot be joined");
  midsurface_mesh_free(mesh);
  midsurface_polylines_free(lines);
}

static void refused(const midsurface_polyline_arrays* arrays, const char* text)
{
  midsurface_error* error = STALE(midsurface_error);
  midsurface_polylines* lines = STALE(midsurface_polylines);
  CHECK_INVALID(midsurface_polylines_new(arrays, &lines, &error), error, text);
  CHECK(lines == NULL);
}

static void null_arrays_are_named(void)
{
  const midsurface_polyline_arrays good = arrays_of_drawing(&good_drawing);
  midsurface_polyline_arrays arrays = good;
  arrays.points = NULL;
  refused(&arrays, "`arrays.points` is NULL");
  arrays = good;
  arrays.offsets = NULL;
  refused(&arrays, "`arrays.offsets` is NULL");
  arrays = good;
  arrays.connectivity = NULL;
  refused(&arrays, "`arrays.connectivity` is NULL");
  arrays = good;
  arrays.slices = NULL;
  refused(&arrays, "`arrays.slices` is NULL");
  arrays = good;
  arrays.point_count = SIZE_MAX / 8;
  refused(&arrays, "`arrays.points` is said to hold");
  arrays = good;
  arrays.line_count = SIZE_MAX;
  refused(&arrays, "`arrays.offsets` is said to hold");
}

static void refused_drawing(const struct drawing* drawing, const char* text)
{
  const midsurface_polyline_arrays arrays = arrays_of_drawing(drawing);
  refused(&arrays, text);
}

static void broken_indices_are_refused(void)
{
  struct drawing drawing = good_drawing;
  drawing.offsets[0] = 1;
  refused_drawing(&drawing, "starts at 1");
  drawing = good_drawing;
  drawing.offsets[LINES] = ENTRIES + 1;
  refused_drawing(&drawing, "ends at 10");
  drawing = good_drawing;
  drawing.offsets[LINES] = -1;
  refused_drawing(&drawing, "ends at -1");
  drawing = good_drawing;
  drawing.offsets[1] = 100; /* beyond the end, and then back */
  refused_drawing(&drawing, "line 1");
  drawing = good_drawing;
  drawing.offsets[2] = 2;
  refused_drawing(&drawing, "line 1 has no points");
  drawing = good_drawing;
  drawing.connectivity[3] = POINTS;
  refused_drawing(&drawing, "holds 8 at 3");
  drawing.connectivity[3] = -1;
  refused_drawing(&drawing, "holds -1 at 3");
  drawing = good_drawing;
  drawing.connectivity[1] = 0;
  refused_drawing(&drawing, "line 0 is closed");
}

static void broken_values_are_refused(void)
{
  struct drawing drawing = good_drawing;
  drawing.points[2][1] = NAN;
  refused_drawing(&drawing, "point 2");
  drawing.points[2][1] = INFINITY;
  refused_drawing(&drawing, "point 2");
  drawing = good_drawing;
  drawing.thickness[5] = NAN;
  refused_drawing(&drawing, "point 5");
  drawing.thickness[5] = -1.0F;
  refused_drawing(&drawing, "point 5");
  drawing = good_drawing;
  drawing.border_distance[6] = NAN;
  refused_drawing(&drawing, "point 6");
  drawing.border_distance[6] = -1.0F;
  refused_drawing(&drawing, "point 6");
  drawing = good_drawing;
  drawing.components[1] = -1;
  refused_drawing(&drawing, "`arrays.components` holds -1");
  drawing.components[1] = (int64_t)1 << 32;
  refused_drawing(&drawing, "`arrays.components` holds 4294967296");
}

void test_polylines(void)
{
  RUN(the_lines_of_a_tube_are_closed);
  RUN(the_chain_gives_the_one_calls_surface);
  RUN(arrays_are_copied_as_they_are);
  RUN(arrays_that_may_be_null_have_defaults);
  RUN(lines_that_face_each_other_are_joined);
  RUN(the_order_of_lines_does_not_matter);
  RUN(lines_that_leave_their_slice_are_refused);
  RUN(null_arrays_are_named);
  RUN(broken_indices_are_refused);
  RUN(broken_values_are_refused);
}
