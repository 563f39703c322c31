#include "bytes.h"

#include <stdlib.h>
#include <string.h>

void require(bool condition)
{
  if (!condition)
  {
    abort();
  }
}

uint8_t take_byte(bytes* input)
{
  if (input->size == 0)
  {
    return 0;
  }
  input->size--;
  return *input->data++;
}

uint64_t take_word(bytes* input)
{
  uint64_t word = 0;
  for (int index = 0; index < 8; index++)
  {
    word = word << 8 | take_byte(input);
  }
  return word;
}

double take_number(bytes* input)
{
  const uint8_t kind = take_byte(input);
  if (kind < 240)
  {
    return (kind - 60) / 4.0;
  }
  const uint64_t word = take_word(input);
  double number = 0.0;
  memcpy(&number, &word, sizeof number);
  return number;
}

int64_t take_index(bytes* input)
{
  const uint8_t kind = take_byte(input);
  return kind < 250 ? kind - 2 : (int64_t)take_word(input);
}

void* buffer_of(size_t count, size_t size)
{
  void* buffer = malloc(count * size);
  require(buffer != NULL || count * size == 0);
  return buffer;
}

static bool keep_going(void* user, double fraction, const char* stage)
{
  unsigned* calls_left = user;
  require(fraction >= 0.0 && fraction <= 1.0 && stage[0] != '\0');
  return *calls_left == 0 || --*calls_left > 0;
}

static void look_at_warning(void* user, const char* message)
{
  (void)user;
  require(strlen(message) > 5);
}

midsurface_options take_options(bytes* input, int64_t labels[4], unsigned* calls_until_cancel)
{
  midsurface_options options = midsurface_options_default();
  const uint8_t flags = take_byte(input);
  options.method = flags % 8 == 7 ? take_byte(input) : flags % 2;
  options.threads = 1;
  options.edge_length = flags & 8 ? take_number(input) : 0.0;
  options.progress = keep_going;
  options.warning = look_at_warning;
  *calls_until_cancel = flags & 16 ? take_byte(input) : 0;
  options.user = calls_until_cancel;
  if (flags & 32)
  {
    options.label_count = take_byte(input) % 5;
    options.labels = labels;
    for (size_t index = 0; index < options.label_count; index++)
    {
      labels[index] = take_index(input);
    }
  }
  return options;
}

void check_outcome(midsurface_status status, midsurface_error* error)
{
  require((status == MIDSURFACE_STATUS_OK) == (error == NULL));
  require(status != MIDSURFACE_STATUS_PANIC && status != MIDSURFACE_STATUS_OUT_OF_MEMORY);
  if (error)
  {
    require(midsurface_error_status(error) == status);
    require(strlen(midsurface_error_message(error)) > 5);
  }
  midsurface_error_free(error);
}

static void check_mesh(const midsurface_mesh_arrays* arrays)
{
  for (size_t index = 0; index < 3 * arrays->point_count; index++)
  {
    require(arrays->points[index] - arrays->points[index] == 0.0F);
    require(arrays->normals[index] >= -1.001F && arrays->normals[index] <= 1.001F);
  }
  for (size_t index = 0; index < arrays->point_count; index++)
  {
    require(arrays->thickness[index] >= 0.0F);
  }
  for (size_t index = 0; index < 3 * arrays->triangle_count; index++)
  {
    require(arrays->triangles[index] >= 0);
    require((size_t)arrays->triangles[index] < arrays->point_count);
  }
  for (size_t index = 0; index < arrays->triangle_count; index++)
  {
    require(arrays->components[index] >= 0);
  }
}

void consume_mesh(midsurface_mesh* mesh)
{
  midsurface_mesh_arrays arrays;
  midsurface_error* error = NULL;
  require(midsurface_mesh_view(mesh, &arrays, &error) == MIDSURFACE_STATUS_OK && error == NULL);
  check_mesh(&arrays);
  require(midsurface_mesh_check(mesh, &error) == MIDSURFACE_STATUS_OK && error == NULL);
  midsurface_mesh_free(mesh);
}
