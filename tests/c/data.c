/* Volumes that cannot be used, or hold unusual labels. */
#include "check.h"
#include "volumes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Every run must refuse the volume, with the text in its message. */
static void refused(const midsurface_volume* volume, const char* text)
{
  static float floats[2][VOXELS];
  const midsurface_options options = midsurface_options_default();
  midsurface_error* error = NULL;
  midsurface_label_list* list = STALE(midsurface_label_list);
  midsurface_polylines* lines = STALE(midsurface_polylines);
  midsurface_mesh* mesh = STALE(midsurface_mesh);
  CHECK_INVALID(midsurface_find_labels(volume, &options, &list, &error), error, text);
  CHECK_INVALID(midsurface_extract_polylines(volume, &options, &lines, &error), error, text);
  CHECK_INVALID(midsurface_extract(volume, &options, &mesh, &error), error, text);
  CHECK_INVALID(
    midsurface_ridge_field(volume, &options, floats[0], floats[1], VOXELS, &error), error, text);
  CHECK(list == NULL && lines == NULL && mesh == NULL);
}

static void buffers_of_another_length_are_refused(void)
{
  /* On the heap and no longer than said: the sanitizer would see a read beyond it. */
  uint8_t* scalars = calloc(VOXELS / 2, 1);
  midsurface_volume volume = volume_of(scalars, MIDSURFACE_SCALAR_TYPE_UINT8);
  volume.length = VOXELS / 2;
  refused(&volume, "holds 2880 values");
  volume.dimensions[2] = DEPTH / 4;
  refused(&volume, "holds 2880 values");
  volume.dimensions[0] = SIZE_MAX;
  refused(&volume, "too large");
  volume.dimensions[0] = SIZE_MAX / 2 + 1;
  volume.dimensions[1] = 2;
  volume.length = 0; /* the product, modulo 2^64 */
  refused(&volume, "too large");
  free(scalars);
}

static void scalars_must_be_there_and_aligned(void)
{
  static double scalars[VOXELS + 1];
  midsurface_volume volume = volume_of(NULL, MIDSURFACE_SCALAR_TYPE_FLOAT64);
  refused(&volume, "`volume.scalars` is NULL");
  volume.scalars = (unsigned char*)scalars + 4;
  refused(&volume, "`volume.scalars` is not aligned");
}

static void frames_must_be_usable(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume good = two_sheets(scalars);
  const double bad_lengths[] = { 0.0, -1.0, NAN, INFINITY };
  for (int axis = 0; axis < 3; axis++)
  {
    for (int which = 0; which < 4; which++)
    {
      midsurface_volume volume = good;
      volume.spacing[axis] = bad_lengths[which];
      refused(&volume, "spacing");
    }
    midsurface_volume volume = good;
    volume.origin[axis] = NAN;
    refused(&volume, "origin");
  }
  midsurface_volume volume = good;
  volume.direction[4] = 0.0; /* singular */
  refused(&volume, "direction");
  volume.direction[4] = INFINITY;
  refused(&volume, "direction");
}

static void labels_must_be_whole_numbers(void)
{
  static float floats[VOXELS];
  static double doubles[VOXELS];
  static uint64_t integers[VOXELS];
  const midsurface_volume of_floats = volume_of(floats, MIDSURFACE_SCALAR_TYPE_FLOAT32);
  const midsurface_volume of_doubles = volume_of(doubles, MIDSURFACE_SCALAR_TYPE_FLOAT64);
  const midsurface_volume of_integers = volume_of(integers, MIDSURFACE_SCALAR_TYPE_UINT64);
  const double bad[] = { NAN, INFINITY, -INFINITY, 1.5, -0.25 };
  const int voxel = 3 + WIDTH * (4 + HEIGHT * 5);
  for (int which = 0; which < 5; which++)
  {
    floats[voxel] = (float)bad[which];
    refused(&of_floats, "whole numbers");
    doubles[voxel] = bad[which];
    refused(&of_doubles, "whole numbers");
  }
  refused(&of_doubles, "-0.25 at voxel [3, 4, 5]");
  integers[voxel] = UINT64_MAX;
  refused(&of_integers, "18446744073709551615 at voxel [3, 4, 5], which is too large for a label");
  doubles[voxel] = 1e20;
  refused(&of_doubles, "too large for a label");
}

static void labels_that_are_not_there_are_refused(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume volume = two_sheets(scalars);
  const int64_t absent[] = { 7, -2 };
  midsurface_options options = midsurface_options_default();
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = NULL;
  midsurface_polylines* lines = NULL;
  options.labels = absent;
  options.label_count = 2;
  CHECK_INVALID(midsurface_extract(&volume, &options, &mesh, &error), error, "7");
  CHECK_INVALID(midsurface_extract_polylines(&volume, &options, &lines, &error), error, "7");
}

static void a_raw_tomogram_is_refused(void)
{
  static int16_t scalars[VOXELS];
  for (int voxel = 0; voxel < VOXELS; voxel++)
  {
    scalars[voxel] = (int16_t)(voxel % 5003);
  }
  const midsurface_volume volume = volume_of(scalars, MIDSURFACE_SCALAR_TYPE_INT16);
  refused(&volume, "tomogram");
}

static void a_stretched_z_is_recognised(void)
{
  const size_t dimensions[3] = { 928, 960, 312 };
  const double stretched[3] = { 12.44, 12.44, 3881.28 };
  const double usual[3] = { 12.44, 12.44, 12.44 };
  double meant[3] = { -1.0, -1.0, -1.0 };
  CHECK(!midsurface_unstretched_spacing(dimensions, usual, meant));
  CHECK(meant[0] == -1.0 && meant[1] == -1.0 && meant[2] == -1.0);
  CHECK(midsurface_unstretched_spacing(dimensions, stretched, meant));
  CHECK(meant[0] == 12.44 && meant[1] == 12.44 && meant[2] == 12.44);
  CHECK(!midsurface_unstretched_spacing(NULL, stretched, meant));
  CHECK(!midsurface_unstretched_spacing(dimensions, NULL, meant));
  CHECK(!midsurface_unstretched_spacing(dimensions, stretched, NULL));
}

void test_data(void)
{
  RUN(buffers_of_another_length_are_refused);
  RUN(scalars_must_be_there_and_aligned);
  RUN(frames_must_be_usable);
  RUN(labels_must_be_whole_numbers);
  RUN(labels_that_are_not_there_are_refused);
  RUN(a_raw_tomogram_is_refused);
  RUN(a_stretched_z_is_recognised);
}
