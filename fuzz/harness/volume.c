/* Volumes of every scalar type, up to 18 voxels along each axis, mostly of runs of few labels, into
 * each function that takes a whole one: both methods; labels and ridge field; the polylines,
 * joined. Lengths, types, frames and options may be lies. */
#include "volume.h"

#include <stdlib.h>
#include <string.h>

static const size_t scalar_sizes[10] = { 1, 1, 2, 2, 4, 4, 8, 8, 4, 8 };

static void write_scalar(void* at, uint32_t type, uint8_t value)
{
  const float single = value;
  const double number = value;
  const int64_t whole = value;
  const size_t size = scalar_sizes[type];
  memcpy(at,
    type == MIDSURFACE_SCALAR_TYPE_FLOAT32     ? (const void*)&single
      : type == MIDSURFACE_SCALAR_TYPE_FLOAT64 ? (const void*)&number
                                               : (const void*)&whole,
    size);
}

/** Runs: a byte tells the value, with 252 and more any bits, and the next how many voxels. */
static void* take_scalars(bytes* input, uint32_t type, size_t count)
{
  const size_t size = scalar_sizes[type];
  uint8_t* scalars = buffer_of(count, size);
  for (size_t done = 0; done < count;)
  {
    const uint8_t kind = take_byte(input);
    const size_t length = input->size ? take_byte(input) % 40 + 1U : count;
    const uint64_t bits = kind >= 252 ? take_word(input) : 0;
    for (size_t step = 0; step < length && done < count; step++, done++)
    {
      if (kind >= 252)
      {
        memcpy(scalars + done * size, &bits, size);
      }
      else
      {
        write_scalar(scalars + done * size, type, kind % 4 == 3 ? kind : kind % 3);
      }
    }
  }
  return scalars;
}

static void take_frame(bytes* input, midsurface_volume* volume)
{
  const uint8_t flags = take_byte(input);
  for (int axis = 0; axis < 3; axis++)
  {
    volume->spacing[axis] = flags & 1 ? take_number(input) : 1.0;
    volume->origin[axis] = flags & 2 ? take_number(input) : 0.0;
    volume->extent_start[axis] = flags & 4 ? take_index(input) : 0;
    for (int column = 0; column < 3; column++)
    {
      volume->direction[3 * axis + column] = flags & 8 ? take_number(input) : axis == column;
    }
  }
  volume->use_threshold = flags & 16;
  volume->threshold = flags & 16 ? take_number(input) : 0.0;
  volume->length += flags & 32 ? take_index(input) : 0;
  volume->scalar_type = flags & 64 ? take_byte(input) : volume->scalar_type;
}

static void run_extract(const given* given)
{
  midsurface_mesh* mesh = NULL;
  midsurface_error* error = NULL;
  const midsurface_status status =
    midsurface_extract(&given->volume, &given->options, &mesh, &error);
  check_outcome(status, error);
  if (status == MIDSURFACE_STATUS_OK)
  {
    consume_mesh(mesh);
  }
}

static void run_polylines(const given* given)
{
  midsurface_polylines* polylines = NULL;
  midsurface_mesh* mesh = NULL;
  midsurface_error* error = NULL;
  midsurface_status status =
    midsurface_extract_polylines(&given->volume, &given->options, &polylines, &error);
  check_outcome(status, error);
  if (status == MIDSURFACE_STATUS_OK)
  {
    error = NULL;
    status = midsurface_zip(polylines, &given->options, &mesh, &error);
    check_outcome(status, error);
    if (status == MIDSURFACE_STATUS_OK)
    {
      consume_mesh(mesh);
    }
  }
  midsurface_polylines_free(polylines);
}

static void run_fields(const given* given)
{
  midsurface_label_list* labels = NULL;
  midsurface_error* error = NULL;
  midsurface_status status =
    midsurface_find_labels(&given->volume, &given->options, &labels, &error);
  check_outcome(status, error);
  for (size_t index = 1; index < midsurface_label_list_length(labels); index++)
  {
    const int64_t* values = midsurface_label_list_values(labels);
    require(values[index - 1] < values[index]);
  }
  midsurface_label_list_free(labels);

  const size_t voxels = given->voxels;
  float* distance = buffer_of(voxels, sizeof *distance);
  float* ridge = buffer_of(voxels, sizeof *ridge);
  error = NULL;
  status = midsurface_ridge_field(&given->volume, &given->options, distance, ridge, voxels, &error);
  check_outcome(status, error);
  for (size_t voxel = 0; status == MIDSURFACE_STATUS_OK && voxel < voxels; voxel++)
  {
    require(distance[voxel] >= 0.0F && ridge[voxel] - ridge[voxel] == 0.0F);
  }
  free(distance);
  free(ridge);
}

void run_on_volume(const uint8_t* data, size_t size, run_function* run)
{
  bytes input = { data, size };
  given given = { .last = size ? data[size - 1] : 0 };
  midsurface_volume* volume = &given.volume;
  const uint32_t type = take_byte(&input) % 10;
  volume->scalar_type = type;
  volume->length = 1;
  for (int axis = 0; axis < 3; axis++)
  {
    volume->dimensions[axis] = take_byte(&input) % 18 + 1;
    volume->length *= volume->dimensions[axis];
  }
  given.voxels = volume->length;
  given.scalar_size = scalar_sizes[type];
  int64_t labels[4];
  unsigned calls = 0;
  take_frame(&input, volume);
  given.options = take_options(&input, labels, &calls);
  void* scalars = take_scalars(&input, type, given.voxels);
  volume->scalars = scalars;
  /* What it may claim is a length or a type that must be refused, or that fits in what there is. */
  const bool fits = volume->length != given.voxels || volume->scalar_type >= 10 ||
    scalar_sizes[volume->scalar_type] <= given.scalar_size;
  if (fits)
  {
    run(&given);
  }
  free(scalars);
}

void fuzz_volume(const uint8_t* data, size_t size)
{
  run_on_volume(data, size, run_extract);
}

void fuzz_volume_polylines(const uint8_t* data, size_t size)
{
  run_on_volume(data, size, run_polylines);
}

void fuzz_volume_fields(const uint8_t* data, size_t size)
{
  run_on_volume(data, size, run_fields);
}
