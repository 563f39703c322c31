/* Volumes and meshes in pieces, by two threads in place of two processes. */
#include "check.h"
#include "meshes.h"
#include "two_processes.h"
#include "volumes.h"

#include <stdlib.h>
#include <string.h>

/* What one process has, and what it gets. */
typedef struct
{
  const midsurface_piece* piece;
  const midsurface_triangle_mesh* triangles;
  const char* excuse;
  /* Whether the mesh is made by way of polylines. */
  bool zips;
  /* Room for the fields of the piece. */
  float* distance;
  float* ridge;
  midsurface_mesh* mesh;
  midsurface_statistics* table;
  midsurface_error* error;
  midsurface_status status;
} Process;

static void zip(Process* process, const midsurface_exchange* exchange)
{
  const midsurface_options options = midsurface_options_default();
  midsurface_polylines* lines = NULL;
  process->status =
    midsurface_extract_polylines_piece(process->piece, exchange, &options, &lines, &process->error);
  if (process->status == MIDSURFACE_STATUS_OK)
  {
    process->status =
      midsurface_zip_piece(lines, exchange, &options, &process->mesh, &process->error);
  }
  midsurface_polylines_free(lines);
}

static void work(void* argument, const midsurface_exchange* exchange)
{
  Process* process = argument;
  const midsurface_options options = midsurface_options_default();
  if (process->excuse)
  {
    process->status = midsurface_abandon(exchange, process->excuse, &process->error);
  }
  else if (process->triangles)
  {
    process->status =
      midsurface_measure_pieces(process->triangles, exchange, &process->table, &process->error);
  }
  else if (process->distance)
  {
    process->status = midsurface_ridge_field_piece(process->piece, exchange, &options,
      process->distance, process->ridge, process->piece->volume.length, &process->error);
  }
  else if (process->zips)
  {
    zip(process, exchange);
  }
  else
  {
    process->status =
      midsurface_extract_piece(process->piece, exchange, &options, &process->mesh, &process->error);
  }
}

static void run_both(Process processes[2])
{
  CHECK(run_two(work, (void* [2]){ &processes[0], &processes[1] }));
}

/* Slices from .. to of a volume of DEPTH. */
static midsurface_piece slices(const midsurface_volume* whole, size_t from, size_t to)
{
  midsurface_piece piece = { .volume = *whole, .whole_dimensions = { WIDTH, HEIGHT, DEPTH } };
  piece.volume.scalars = (const uint8_t*)whole->scalars + from * WIDTH * HEIGHT;
  piece.volume.dimensions[2] = to - from;
  piece.volume.length = (to - from) * WIDTH * HEIGHT;
  piece.volume.extent_start[2] = (int64_t)from;
  return piece;
}

/* Both must fail, the second with what happened in the first. */
static void check_failures(Process processes[2], const char* first, const char* second)
{
  run_both(processes);
  const char* texts[] = { first, second };
  for (int i = 0; i < 2; i++)
  {
    CHECK(texts[i] == NULL || strstr(midsurface_error_message(processes[i].error), texts[i]));
    CHECK(processes[i].mesh == NULL);
    midsurface_error_free(processes[i].error);
  }
}

/* The mesh that one process makes of the whole, or of its lines. */
static midsurface_mesh* mesh_of_whole(
  bool zips, const midsurface_volume* whole, const midsurface_options* options)
{
  if (!zips)
  {
    return extracted(whole, options);
  }
  midsurface_polylines* lines = NULL;
  midsurface_mesh* mesh = NULL;
  midsurface_error* error = NULL;
  CHECK_SUCCEEDS(midsurface_extract_polylines(whole, options, &lines, &error), error);
  CHECK_SUCCEEDS(midsurface_zip(lines, options, &mesh, &error), error);
  midsurface_polylines_free(lines);
  return mesh;
}

/* Both processes together make the mesh of the whole, each some of its two components. */
static void check_components(bool zips, const midsurface_options* options)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume whole = two_sheets(scalars);
  const midsurface_piece pieces[] = { slices(&whole, 0, 7), slices(&whole, 6, DEPTH) };
  Process processes[2] = { { .piece = &pieces[0], .zips = zips },
    { .piece = &pieces[1], .zips = zips } };
  run_both(processes);
  midsurface_mesh* all = mesh_of_whole(zips, &whole, options);
  size_t points = 0, triangles = 0;
  for (int i = 0; i < 2; i++)
  {
    if (CHECK(processes[i].status == MIDSURFACE_STATUS_OK))
    {
      const midsurface_mesh_arrays arrays = arrays_of(processes[i].mesh);
      CHECK(arrays.triangle_count > 0);
      CHECK(arrays.first_triangle == triangles);
      for (size_t p = 0; p < arrays.point_count; p++)
      {
        CHECK(arrays.point_ids[p] == (int64_t)(points + p));
      }
      points += arrays.point_count;
      triangles += arrays.triangle_count;
      for (size_t t = 1; t < arrays.triangle_count; t++)
      {
        CHECK(arrays.components[t] == arrays.components[0]);
      }
    }
    midsurface_mesh_free(processes[i].mesh);
  }
  CHECK(points == arrays_of(all).point_count);
  CHECK(triangles == arrays_of(all).triangle_count);
  CHECK(arrays_of(all).point_ids == NULL && arrays_of(all).first_triangle == 0);
  midsurface_mesh_free(all);
}

static void each_process_gets_whole_components(void)
{
  midsurface_options options = midsurface_options_default();
  check_components(false, &options);
  options.method = MIDSURFACE_METHOD_POLYLINE_ZIPPER;
  check_components(true, &options);
}

static void each_process_gets_the_fields_of_its_piece(void)
{
  static uint8_t scalars[VOXELS];
  static float fields[2][VOXELS], expected[2][VOXELS];
  const midsurface_volume whole = two_sheets(scalars);
  const midsurface_options options = midsurface_options_default();
  CHECK(midsurface_ridge_field(&whole, &options, expected[0], expected[1], VOXELS, NULL) ==
    MIDSURFACE_STATUS_OK);
  const midsurface_piece pieces[] = { slices(&whole, 0, 7), slices(&whole, 7, DEPTH) };
  const size_t second = 7 * WIDTH * HEIGHT;
  Process processes[2] = {
    { .piece = &pieces[0], .distance = fields[0], .ridge = fields[1] },
    { .piece = &pieces[1], .distance = fields[0] + second, .ridge = fields[1] + second },
  };
  run_both(processes);
  CHECK(processes[0].status == MIDSURFACE_STATUS_OK && processes[1].status == MIDSURFACE_STATUS_OK);
  CHECK(memcmp(fields, expected, sizeof fields) == 0);

  midsurface_piece wrong = pieces[1];
  wrong.volume.length -= 1;
  Process failing[2] = { { .piece = &wrong, .distance = fields[0], .ridge = fields[1] },
    { .piece = &pieces[1], .distance = fields[0] + second, .ridge = fields[1] + second } };
  check_failures(failing, "its array holds", "process 0 failed");
}

static void a_process_may_have_no_piece(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume whole = two_sheets(scalars);
  midsurface_piece pieces[] = { slices(&whole, 0, 0), slices(&whole, 0, DEPTH) };
  pieces[0].volume.scalars = NULL;
  Process processes[2] = { { .piece = &pieces[0] }, { .piece = &pieces[1] } };
  run_both(processes);
  for (int i = 0; i < 2; i++)
  {
    CHECK(processes[i].status == MIDSURFACE_STATUS_OK);
    CHECK(arrays_of(processes[i].mesh).triangle_count > 0);
    midsurface_mesh_free(processes[i].mesh);
  }
}

static void a_failure_of_one_reaches_the_other(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume whole = two_sheets(scalars);
  midsurface_piece pieces[] = { slices(&whole, 0, 7), slices(&whole, 6, DEPTH) };
  pieces[0].volume.length -= 1;
  Process processes[2] = { { .piece = &pieces[0] }, { .piece = &pieces[1] } };
  check_failures(processes, "its array holds", "process 0 failed: the volume is said to have");

  Process excused[2] = { { .excuse = "no array" }, { .piece = &pieces[1] } };
  check_failures(excused, NULL, "process 0 failed: no array");

  const midsurface_piece gap[] = { slices(&whole, 0, 5), slices(&whole, 6, DEPTH) };
  Process apart[2] = { { .piece = &gap[0] }, { .piece = &gap[1] } };
  check_failures(apart, "do not make up one image", "do not make up one image");
}

static void the_first_process_gets_the_table_of_all(void)
{
  const double points[] = { 0, 0, 0, 2, 0, 0, 0, 2, 0 };
  const int64_t triangle[] = { 0, 1, 2 };
  const int64_t labels[] = { 4 };
  const int64_t components[] = { 0, 1 };
  midsurface_triangle_mesh meshes[2];
  for (int i = 0; i < 2; i++)
  {
    meshes[i] = (midsurface_triangle_mesh){
      .points = points,
      .point_count = 3,
      .triangles = triangle,
      .triangle_count = 1,
      .labels = labels,
      .components = &components[i],
    };
  }
  Process processes[2] = { { .triangles = &meshes[0] }, { .triangles = &meshes[1] } };
  run_both(processes);
  CHECK(processes[0].status == MIDSURFACE_STATUS_OK && processes[1].status == MIDSURFACE_STATUS_OK);
  CHECK(midsurface_statistics_length(processes[1].table) == 0);
  if (CHECK(midsurface_statistics_length(processes[0].table) == 4))
  {
    const midsurface_statistics_row* rows = midsurface_statistics_rows(processes[0].table);
    CHECK(rows[0].area == 4.0 && rows[0].points == 6 && rows[0].euler_number == 2);
    CHECK(rows[1].scope == MIDSURFACE_SCOPE_LABEL && rows[1].triangles == 2);
    CHECK(rows[2].component == 0 && rows[3].component == 1 && rows[3].area == 2.0);
  }
  midsurface_statistics_free(processes[0].table);
  midsurface_statistics_free(processes[1].table);

  meshes[1].components = components;
  Process split[2] = { { .triangles = &meshes[0] }, { .triangles = &meshes[1] } };
  check_failures(split, "spread over several processes", "process 0 failed");

  /* Two triangles of a component with an edge in common. */
  const int64_t ids[][3] = { { 7, 0, 3 }, { 3, 0, 5 } };
  const double beside[] = { 0, 2, 0, 2, 0, 0, 2, 2, 0 };
  meshes[1].points = beside;
  for (int i = 0; i < 2; i++)
  {
    meshes[i].point_ids = ids[i];
  }
  Process joined[2] = { { .triangles = &meshes[0] }, { .triangles = &meshes[1] } };
  run_both(joined);
  CHECK(joined[0].status == MIDSURFACE_STATUS_OK && joined[1].status == MIDSURFACE_STATUS_OK);
  if (CHECK(midsurface_statistics_length(joined[0].table) == 3))
  {
    const midsurface_statistics_row* square = midsurface_statistics_rows(joined[0].table) + 2;
    CHECK(square->points == 4 && square->triangles == 2 && square->area == 4.0);
    CHECK(square->euler_number == 1 && square->boundary_loops == 1);
    CHECK(square->boundary_length == 8.0);
  }
  midsurface_statistics_free(joined[0].table);
  midsurface_statistics_free(joined[1].table);
}

static bool send_nothing(void* user, size_t to, const int64_t* numbers, size_t length)
{
  (void)user, (void)to, (void)numbers, (void)length;
  return false;
}

static bool receive_nothing(void* user, size_t from, int64_t* numbers, size_t length)
{
  (void)user, (void)from, (void)numbers, (void)length;
  return false;
}

static void an_exchange_that_cannot_be_used_is_refused(void)
{
  static uint8_t scalars[VOXELS];
  const midsurface_volume whole = two_sheets(scalars);
  const midsurface_piece piece = slices(&whole, 0, DEPTH);
  const midsurface_options options = midsurface_options_default();
  midsurface_exchange exchange = { .processes = 1, .send = send_nothing };
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = STALE(midsurface_mesh);
  CHECK_INVALID(
    midsurface_extract_piece(&piece, &exchange, &options, &mesh, &error), error, "receive");
  CHECK(mesh == NULL);
  CHECK_INVALID(midsurface_extract_piece(&piece, NULL, &options, &mesh, &error), error, "exchange");
  exchange.receive = receive_nothing;
  CHECK_INVALID(midsurface_extract_piece(NULL, &exchange, &options, &mesh, &error), error, "piece");
  CHECK_INVALID(midsurface_abandon(&exchange, NULL, &error), error, "message");
  exchange.process = 1;
  CHECK_INVALID(
    midsurface_extract_piece(&piece, &exchange, &options, &mesh, &error), error, "process");
}

void test_pieces(void)
{
  RUN(each_process_gets_whole_components);
  RUN(each_process_gets_the_fields_of_its_piece);
  RUN(a_process_may_have_no_piece);
  RUN(a_failure_of_one_reaches_the_other);
  RUN(the_first_process_gets_the_table_of_all);
  RUN(an_exchange_that_cannot_be_used_is_refused);
}
