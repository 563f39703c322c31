/* Triangles of any kind into the statistics: indices may be lies, coordinates infinite. */
#include "bytes.h"

#include <stdlib.h>

void fuzz_triangles(const uint8_t* data, size_t size)
{
  bytes input = { data, size };
  const uint8_t flags = take_byte(&input);
  midsurface_triangle_mesh mesh = { 0 };
  mesh.point_count = take_byte(&input);
  mesh.triangle_count = take_byte(&input);
  double* points = buffer_of(3 * mesh.point_count, sizeof *points);
  float* thickness = buffer_of(mesh.point_count, sizeof *thickness);
  int64_t* triangles = buffer_of(5 * mesh.triangle_count, sizeof *triangles);
  for (size_t index = 0; index < 3 * mesh.point_count; index++)
  {
    points[index] = take_number(&input);
    thickness[index / 3] = (float)points[index];
  }
  for (size_t index = 0; index < 5 * mesh.triangle_count; index++)
  {
    triangles[index] = take_index(&input);
  }
  mesh.points = points;
  mesh.triangles = triangles;
  mesh.thickness = flags & 1 ? thickness : NULL;
  mesh.labels = flags & 2 ? triangles + 3 * mesh.triangle_count : NULL;
  mesh.components = flags & 4 ? triangles + 4 * mesh.triangle_count : NULL;

  midsurface_statistics* statistics = NULL;
  midsurface_error* error = NULL;
  const midsurface_status status = midsurface_measure(&mesh, &statistics, &error);
  check_outcome(status, error);
  if (status == MIDSURFACE_STATUS_OK)
  {
    const midsurface_statistics_row* rows = midsurface_statistics_rows(statistics);
    require(midsurface_statistics_length(statistics) >= 1);
    require(rows[0].triangles == mesh.triangle_count);
  }
  midsurface_statistics_free(statistics);
  free(points);
  free(thickness);
  free(triangles);
}
