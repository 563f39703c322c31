/* The volumes of volume.c cut along z in two pieces, on a process each, into each function that
 * takes pieces: the mesh, and its statistics; the polylines, joined; the fields. Pieces may overlap
 * or lack a slice, a process may have none, and both may be told different things. */
#include "two_processes.h"
#include "volume.h"

#include <stdlib.h>

enum task
{
  TASK_MESH,
  TASK_ZIP,
  TASK_FIELDS,
  TASK_STATISTICS,
};

/** What a process has, and what it gets. */
typedef struct process
{
  enum task task;
  midsurface_piece piece;
  midsurface_options options;
  unsigned calls_until_cancel;
  midsurface_status status;
  size_t points;
  size_t triangles;
} process;

/** Slices from .. to; what the length lies by, this piece's does, too. */
static process process_of(const given* given, size_t from, size_t to)
{
  const midsurface_volume* volume = &given->volume;
  const size_t slice = volume->dimensions[0] * volume->dimensions[1];
  process process = { .task = given->last % 4, .piece = { .volume = *volume } };
  for (int axis = 0; axis < 3; axis++)
  {
    process.piece.whole_dimensions[axis] = volume->dimensions[axis];
    process.piece.whole_extent_start[axis] = volume->extent_start[axis];
  }
  midsurface_volume* own = &process.piece.volume;
  own->scalars = (const char*)volume->scalars + from * slice * given->scalar_size;
  own->dimensions[2] = to - from;
  own->length = (to - from) * slice + (volume->length - given->voxels);
  own->extent_start[2] = (int64_t)((uint64_t)volume->extent_start[2] + from);
  process.options = given->options;
  process.calls_until_cancel = *(const unsigned*)given->options.user;
  return process;
}

static void measure(midsurface_mesh* mesh, const midsurface_exchange* exchange)
{
  midsurface_mesh_arrays arrays;
  require(midsurface_mesh_view(mesh, &arrays, NULL) == MIDSURFACE_STATUS_OK);
  double* points = buffer_of(3 * arrays.point_count, sizeof *points);
  for (size_t index = 0; index < 3 * arrays.point_count; index++)
  {
    points[index] = arrays.points[index];
  }
  const midsurface_triangle_mesh triangles = {
    .points = points,
    .point_count = arrays.point_count,
    .triangles = arrays.triangles,
    .triangle_count = arrays.triangle_count,
    .thickness = arrays.thickness,
    .labels = arrays.labels,
    .components = arrays.components,
    .point_ids = arrays.point_ids,
  };
  midsurface_statistics* table = NULL;
  midsurface_error* error = NULL;
  const midsurface_status status = midsurface_measure_pieces(&triangles, exchange, &table, &error);
  check_outcome(status, error);
  require(status == MIDSURFACE_STATUS_OK);
  require((midsurface_statistics_length(table) > 0) == (exchange->process == 0));
  midsurface_statistics_free(table);
  free(points);
}

static midsurface_status write_fields(
  process* own, const midsurface_exchange* exchange, midsurface_error** error)
{
  /* A length that lies is refused before anything is written. */
  const size_t voxels = own->piece.volume.length;
  const size_t held = own->piece.volume.dimensions[0] * own->piece.volume.dimensions[1] *
    own->piece.volume.dimensions[2];
  float* distance = buffer_of(held, sizeof *distance);
  float* ridge = buffer_of(held, sizeof *ridge);
  const midsurface_status status = midsurface_ridge_field_piece(
    &own->piece, exchange, &own->options, distance, ridge, voxels, error);
  free(distance);
  free(ridge);
  return status;
}

static void work(void* of_process, const midsurface_exchange* exchange)
{
  process* own = of_process;
  own->options.user = &own->calls_until_cancel;
  midsurface_mesh* mesh = NULL;
  midsurface_polylines* polylines = NULL;
  midsurface_error* error = NULL;
  switch (own->task)
  {
    case TASK_ZIP:
      own->status = midsurface_extract_polylines_piece(
        &own->piece, exchange, &own->options, &polylines, &error);
      if (own->status == MIDSURFACE_STATUS_OK)
      {
        own->status = midsurface_zip_piece(polylines, exchange, &own->options, &mesh, &error);
      }
      break;
    case TASK_FIELDS:
      own->status = write_fields(own, exchange, &error);
      break;
    default:
      own->status = midsurface_extract_piece(&own->piece, exchange, &own->options, &mesh, &error);
  }
  check_outcome(own->status, error);
  if (mesh)
  {
    midsurface_mesh_arrays arrays;
    require(midsurface_mesh_view(mesh, &arrays, NULL) == MIDSURFACE_STATUS_OK);
    own->points = arrays.point_count;
    own->triangles = arrays.triangle_count;
    if (own->task == TASK_STATISTICS)
    {
      measure(mesh, exchange);
    }
    consume_mesh(mesh);
  }
  midsurface_polylines_free(polylines);
}

/** Where the whole has a mesh, the pieces have all of it. */
static void compare(const given* given, const process processes[2])
{
  midsurface_options options = given->options;
  options.progress = NULL;
  midsurface_mesh* mesh = NULL;
  const midsurface_status status = midsurface_extract(&given->volume, &options, &mesh, NULL);
  require(status == MIDSURFACE_STATUS_OK);
  midsurface_mesh_arrays arrays;
  require(midsurface_mesh_view(mesh, &arrays, NULL) == MIDSURFACE_STATUS_OK);
  require(processes[0].points + processes[1].points == arrays.point_count);
  require(processes[0].triangles + processes[1].triangles == arrays.triangle_count);
  midsurface_mesh_free(mesh);
}

static void run_pieces(const given* given)
{
  const size_t slices = given->volume.dimensions[2];
  const unsigned how = given->last / 4;
  const size_t first_to = slices * (how % 8) / 7;
  const unsigned shift = how / 8 % 4;
  const size_t second_from = shift == 1 && first_to > 0 ? first_to - 1
    : shift == 2 && first_to < slices                   ? first_to + 1
                                                        : first_to;
  process processes[2] = { process_of(given, 0, first_to), process_of(given, second_from, slices) };
  const bool differ = how / 32 && shift == 3;
  if (differ)
  {
    processes[1].options.edge_length += 1.0;
  }
  require(run_two(work, (void* [2]){ &processes[0], &processes[1] }));
  const bool is_good[2] = { processes[0].status == MIDSURFACE_STATUS_OK,
    processes[1].status == MIDSURFACE_STATUS_OK };
  require(is_good[0] == is_good[1]);
  if (is_good[0] && (processes[0].task == TASK_MESH || processes[0].task == TASK_STATISTICS))
  {
    compare(given, processes);
  }
}

void fuzz_volume_pieces(const uint8_t* data, size_t size)
{
  run_on_volume(data, size, run_pieces);
}
