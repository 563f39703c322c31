/* Runs on volumes whose mid-surface is known. */
#include "check.h"
#include "meshes.h"
#include "volumes.h"

#include <math.h>
#include <stdlib.h>
#include <threads.h>

static void labels_are_found(void)
{
  static uint8_t scalars[VOXELS];
  midsurface_volume volume = two_sheets(scalars);
  const midsurface_options options = midsurface_options_default();
  midsurface_error* error = STALE(midsurface_error);
  midsurface_label_list* list = NULL;
  if (CHECK_SUCCEEDS(midsurface_find_labels(&volume, &options, &list, &error), error) &&
    CHECK(midsurface_label_list_length(list) == 2))
  {
    CHECK(midsurface_label_list_values(list)[0] == 1);
    CHECK(midsurface_label_list_values(list)[1] == 3);
  }
  midsurface_label_list_free(list);
}

/* Checks a mesh of two_sheets() that holds the first sheet, the second or both. */
static void check_sheets(const midsurface_mesh* mesh, bool first, bool second)
{
  const midsurface_mesh_arrays arrays = arrays_of(mesh);
  bool found[2] = { false, false };
  bool labels = true, indices = true, places = true, normals = true, thickness = true;
  for (size_t t = 0; t < arrays.triangle_count; t++)
  {
    const bool is_first = arrays.labels[t] == 1;
    labels = labels && (is_first || arrays.labels[t] == 3) &&
      arrays.components[t] == (!is_first && first ? 1 : 0);
    found[is_first ? 0 : 1] = true;
    for (int corner = 0; corner < 3; corner++)
    {
      const int64_t p = arrays.triangles[3 * t + (size_t)corner];
      if (p < 0 || (size_t)p >= arrays.point_count)
      {
        indices = false;
        continue;
      }
      places = places && fabsf(arrays.points[3 * p] - (is_first ? 5.5F : 16.5F)) < 0.25F;
      normals = normals && fabsf(arrays.normals[3 * p]) > 0.95F;
      thickness = thickness && fabsf(arrays.thickness[p] - 4.0F) < 1.0F;
    }
  }
  CHECK(labels);
  CHECK(indices);
  CHECK(places);
  CHECK(normals);
  CHECK(thickness);
  CHECK(found[0] == first && found[1] == second);
}

static void sheets_lie_in_the_middle(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume volume = two_sheets(scalars);
  midsurface_options options = midsurface_options_default();
  midsurface_mesh* mesh = extracted(&volume, &options);
  check_sheets(mesh, true, true);
  midsurface_mesh_free(mesh);

  const int64_t second[] = { 3 };
  options.labels = second;
  options.label_count = 1;
  mesh = extracted(&volume, &options);
  check_sheets(mesh, false, true);
  midsurface_mesh_free(mesh);
}

static void no_labels_give_no_mesh(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume volume = two_sheets(scalars);
  const int64_t unused = 1;
  midsurface_options options = midsurface_options_default();
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = NULL;
  options.labels = &unused;
  options.label_count = 0;
  CHECK_SUCCEEDS(midsurface_extract(&volume, &options, &mesh, &error), error);
  CHECK(arrays_of(mesh).triangle_count == 0);
  midsurface_mesh_free(mesh);
}

#define CONVERT(type, array)                                                                       \
  for (int voxel = 0; voxel < VOXELS; voxel++)                                                     \
  ((type*)(array))[voxel] = (type)scalars[voxel]

static void every_scalar_type_gives_the_same_mesh(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume volume = two_sheets(scalars);
  const midsurface_options options = midsurface_options_default();
  midsurface_mesh* expected = extracted(&volume, &options);
  void* converted = malloc(VOXELS * sizeof(double));
  for (uint32_t type = 0; type <= MIDSURFACE_SCALAR_TYPE_FLOAT64; type++)
  {
    switch ((midsurface_scalar_type)type)
    {
      case MIDSURFACE_SCALAR_TYPE_INT8:
        CONVERT(int8_t, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_UINT8:
        CONVERT(uint8_t, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_INT16:
        CONVERT(int16_t, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_UINT16:
        CONVERT(uint16_t, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_INT32:
        CONVERT(int32_t, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_UINT32:
        CONVERT(uint32_t, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_INT64:
        CONVERT(int64_t, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_UINT64:
        CONVERT(uint64_t, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_FLOAT32:
        CONVERT(float, converted);
        break;
      case MIDSURFACE_SCALAR_TYPE_FLOAT64:
        CONVERT(double, converted);
        break;
    }
    const midsurface_volume other = volume_of(converted, (midsurface_scalar_type)type);
    midsurface_mesh* mesh = extracted(&other, &options);
    CHECK(same_mesh(expected, mesh));
    midsurface_mesh_free(mesh);
  }
  free(converted);
  midsurface_mesh_free(expected);
}

/* Everything at or above a threshold is label 1. */
static void a_map_with_a_threshold_gives_the_mesh_of_its_label(void)
{
  static uint8_t scalars[VOXELS];
  static float map[VOXELS];
  const midsurface_options options = midsurface_options_default();
  midsurface_volume labels = tube(scalars);
  for (int voxel = 0; voxel < VOXELS; voxel++)
  {
    map[voxel] = scalars[voxel] ? 0.7F : voxel % 2 ? 0.6F : NAN;
  }
  midsurface_volume volume = volume_of(map, MIDSURFACE_SCALAR_TYPE_FLOAT32);
  volume.use_threshold = true;
  volume.threshold = 0.65;
  midsurface_mesh* expected = extracted(&labels, &options);
  midsurface_mesh* mesh = extracted(&volume, &options);
  CHECK(arrays_of(mesh).triangle_count > 0);
  CHECK(same_mesh(expected, mesh));
  midsurface_mesh_free(mesh);

  midsurface_error* error = NULL;
  volume.threshold = NAN;
  CHECK_INVALID(midsurface_extract(&volume, &options, &mesh, &error), error, "threshold");
  volume.threshold = 0.5F;
  volume.use_threshold = false;
  CHECK_INVALID(midsurface_extract(&volume, &options, &mesh, &error), error, "whole numbers");
  midsurface_mesh_free(expected);
}

static void the_frame_places_the_mesh(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_options options = midsurface_options_default();
  midsurface_volume volume = two_sheets(scalars);
  midsurface_mesh* plain = extracted(&volume, &options);
  volume.extent_start[0] = 100;
  volume.extent_start[2] = -7;
  volume.origin[1] = 50.0;
  for (int axis = 0; axis < 3; axis++)
  {
    volume.spacing[axis] = 2.0;
  }
  const double quarter_turn[9] = { 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 };
  for (int entry = 0; entry < 9; entry++)
  {
    volume.direction[entry] = quarter_turn[entry];
  }
  midsurface_mesh* placed = extracted(&volume, &options);
  const midsurface_mesh_arrays a = arrays_of(plain);
  const midsurface_mesh_arrays b = arrays_of(placed);
  if (CHECK(a.point_count == b.point_count))
  {
    float farthest = 0.0F;
    for (size_t p = 0; p < a.point_count; p++)
    {
      const float* from = a.points + 3 * p;
      const float* to = b.points + 3 * p;
      farthest = fmaxf(farthest, fabsf(to[0] - -2.0F * from[1]));
      farthest = fmaxf(farthest, fabsf(to[1] - (50.0F + 2.0F * (from[0] + 100.0F))));
      farthest = fmaxf(farthest, fabsf(to[2] - 2.0F * (from[2] - 7.0F)));
      farthest = fmaxf(farthest, fabsf(b.thickness[p] - 2.0F * a.thickness[p]));
    }
    CHECK(farthest < 1e-3F);
  }
  midsurface_mesh_free(placed);
  midsurface_mesh_free(plain);
}

static void the_number_of_threads_does_not_matter(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume volume = tube(scalars);
  midsurface_options options = midsurface_options_default();
  midsurface_mesh* expected = extracted(&volume, &options);
  const uint32_t counts[] = { 1, 2, 5 };
  for (int which = 0; which < 3; which++)
  {
    options.threads = counts[which];
    midsurface_mesh* mesh = extracted(&volume, &options);
    CHECK(same_mesh(expected, mesh));
    midsurface_mesh_free(mesh);
  }
  midsurface_mesh_free(expected);
}

struct job
{
  midsurface_volume volume;
  midsurface_mesh* mesh;
};

static int work(void* argument)
{
  struct job* job = argument;
  const midsurface_options options = midsurface_options_default();
  for (int again = 0; again < 5; again++)
  {
    midsurface_mesh_free(job->mesh);
    job->mesh = NULL;
    if (midsurface_extract(&job->volume, &options, &job->mesh, NULL) != MIDSURFACE_STATUS_OK)
    {
      return 1;
    }
  }
  return 0;
}

static void two_runs_at_once_do_not_meet(void)
{
  static uint8_t scalars[2][VOXELS];
  const midsurface_options options = midsurface_options_default();
  struct job jobs[2] = { { two_sheets(scalars[0]), NULL }, { tube(scalars[1]), NULL } };
  thrd_t threads[2];
  for (int which = 0; which < 2; which++)
  {
    CHECK(thrd_create(&threads[which], work, &jobs[which]) == thrd_success);
  }
  for (int which = 0; which < 2; which++)
  {
    int result = 1;
    CHECK(thrd_join(threads[which], &result) == thrd_success && result == 0);
    midsurface_mesh* alone = extracted(&jobs[which].volume, &options);
    CHECK(same_mesh(alone, jobs[which].mesh));
    midsurface_mesh_free(alone);
    midsurface_mesh_free(jobs[which].mesh);
  }
}

static void the_ridge_field_has_its_crest_in_the_middle(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume volume = two_sheets(scalars);
  const midsurface_options options = midsurface_options_default();
  midsurface_error* error = NULL;
  /* On the heap, uninitialised: every float must be written, and none beyond. */
  float* distance = malloc(VOXELS * sizeof *distance);
  float* ridge = malloc(VOXELS * sizeof *ridge);
  CHECK_SUCCEEDS(midsurface_ridge_field(&volume, &options, distance, ridge, VOXELS, &error), error);
  bool inside = true, outside = true, finite = true;
  for (int voxel = 0; voxel < VOXELS; voxel++)
  {
    inside = inside && (scalars[voxel] == 0 || distance[voxel] > 0.0F);
    outside = outside && (scalars[voxel] != 0 || distance[voxel] == 0.0F);
    finite = finite && isfinite(distance[voxel]) && isfinite(ridge[voxel]);
  }
  CHECK(inside);
  CHECK(outside);
  CHECK(finite);
  const int row = WIDTH * (HEIGHT / 2 + HEIGHT * (DEPTH / 2));
  CHECK(distance[row + 5] > distance[row + 4]);
  CHECK(ridge[row + 5] > ridge[row + 3]);
  CHECK(ridge[row + WIDTH - 1] == 0.0F);
  free(ridge);
  free(distance);
}

void test_runs(void)
{
  RUN(labels_are_found);
  RUN(sheets_lie_in_the_middle);
  RUN(no_labels_give_no_mesh);
  RUN(every_scalar_type_gives_the_same_mesh);
  RUN(a_map_with_a_threshold_gives_the_mesh_of_its_label);
  RUN(the_frame_places_the_mesh);
  RUN(the_number_of_threads_does_not_matter);
  RUN(two_runs_at_once_do_not_meet);
  RUN(the_ridge_field_has_its_crest_in_the_middle);
}
