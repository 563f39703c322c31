/* Polylines of any kind into the zipper: indices, offsets and slices may be lies. */
#include "bytes.h"

#include <stdlib.h>

static int64_t* take_indices(bytes* input, size_t count)
{
  int64_t* indices = buffer_of(count, sizeof *indices);
  for (size_t index = 0; index < count; index++)
  {
    indices[index] = take_index(input);
  }
  return indices;
}

void fuzz_polylines(const uint8_t* data, size_t size)
{
  bytes input = { data, size };
  int64_t labels[4];
  unsigned calls = 0;
  midsurface_options options = take_options(&input, labels, &calls);
  const uint8_t flags = take_byte(&input);
  midsurface_polyline_arrays arrays = { 0 };
  arrays.point_count = take_byte(&input);
  arrays.line_count = take_byte(&input) % 32;
  arrays.connectivity_length = take_byte(&input);
  const size_t coordinates = 3 * arrays.point_count;
  double* points = buffer_of(coordinates, sizeof *points);
  float* thickness = buffer_of(arrays.point_count, sizeof *thickness);
  for (size_t index = 0; index < coordinates; index++)
  {
    /* Mostly, in planes along z as lines of slices are. */
    points[index] =
      index % 3 == 2 && !(flags & 8) ? (double)(take_byte(&input) % 4) : take_number(&input);
    thickness[index / 3] = (float)points[index];
  }
  arrays.points = points;
  arrays.thickness = flags & 1 ? thickness : NULL;
  arrays.border_distance = flags & 32 ? thickness : NULL;
  int64_t* offsets = take_indices(&input, arrays.line_count + 1);
  if (!(flags & 16))
  {
    /* Lines as long as each other. */
    for (size_t line = 0; line <= arrays.line_count; line++)
    {
      offsets[line] =
        arrays.line_count ? (int64_t)(line * arrays.connectivity_length / arrays.line_count) : 0;
    }
  }
  int64_t* connectivity = take_indices(&input, arrays.connectivity_length);
  int64_t* lines = take_indices(&input, 3 * arrays.line_count);
  arrays.offsets = offsets;
  arrays.connectivity = connectivity;
  arrays.slices = lines;
  arrays.labels = flags & 2 ? lines + arrays.line_count : NULL;
  arrays.components = flags & 4 ? lines + 2 * arrays.line_count : NULL;
  double* voxel_steps = buffer_of(9, sizeof *voxel_steps);
  for (size_t index = 0; index < 9; index++)
  {
    voxel_steps[index] = take_number(&input);
  }
  arrays.voxel_steps = flags & 64 ? voxel_steps : NULL;

  midsurface_polylines* polylines = NULL;
  midsurface_error* error = NULL;
  midsurface_status status = midsurface_polylines_new(&arrays, &polylines, &error);
  check_outcome(status, error);
  if (status == MIDSURFACE_STATUS_OK)
  {
    midsurface_mesh* mesh = NULL;
    error = NULL;
    status = midsurface_zip(polylines, &options, &mesh, &error);
    check_outcome(status, error);
    if (status == MIDSURFACE_STATUS_OK)
    {
      consume_mesh(mesh);
    }
  }
  midsurface_polylines_free(polylines);
  free(points);
  free(thickness);
  free(offsets);
  free(connectivity);
  free(lines);
  free(voxel_steps);
}
