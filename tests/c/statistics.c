/* The table of a mesh's figures. */
#include "check.h"
#include "volumes.h"

#include <math.h>
#include <string.h>

/* A square of two triangles at z = 0, and a triangle beside it. */
static const double points[] = { 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0 };
static const int64_t triangles[] = { 0, 1, 2, 0, 2, 3, 4, 5, 6 };

static midsurface_triangle_mesh squares(void)
{
  const midsurface_triangle_mesh mesh = {
    .points = points,
    .point_count = 7,
    .triangles = triangles,
    .triangle_count = 3,
  };
  return mesh;
}

static void a_mesh_is_measured_in_total_and_in_parts(void)
{
  const int64_t labels[] = { 4, 4, -9 };
  const int64_t components[] = { 0, 0, 1 };
  const float thickness[] = { 1, 2, 3, 4, 7, 7, 7 };
  midsurface_triangle_mesh mesh = squares();
  mesh.labels = labels;
  mesh.components = components;
  mesh.thickness = thickness;
  midsurface_statistics* table = STALE(midsurface_statistics);
  midsurface_error* error = STALE(midsurface_error);
  if (!CHECK_SUCCEEDS(midsurface_measure(&mesh, &table, &error), error) ||
    !CHECK(midsurface_statistics_length(table) == 5))
  {
    return;
  }
  const midsurface_statistics_row* rows = midsurface_statistics_rows(table);
  CHECK(rows[0].scope == MIDSURFACE_SCOPE_TOTAL && !rows[0].has_label);
  CHECK(rows[0].points == 7 && rows[0].triangles == 3 && rows[0].euler_number == 2);
  CHECK(rows[0].area == 4.5 && rows[0].boundary_loops == 2);
  CHECK(rows[1].scope == MIDSURFACE_SCOPE_LABEL && rows[1].has_label && rows[1].label == -9);
  CHECK(rows[2].scope == MIDSURFACE_SCOPE_COMPONENT && rows[2].component == 1);
  CHECK(rows[3].scope == MIDSURFACE_SCOPE_LABEL && rows[3].label == 4);
  CHECK(rows[3].area == 4.0 && rows[3].boundary_length == 8.0 && rows[3].boundary_loops == 1);
  CHECK(rows[3].thickness_mean == 2.5 && rows[3].thickness_quantiles[2] == 2.5);
  CHECK(fabs(rows[3].mean_smallest_angle - 45.0) < 1e-9);
  CHECK(rows[4].scope == MIDSURFACE_SCOPE_COMPONENT && rows[4].label == 4);
  CHECK(rows[4].component == 0 && rows[4].points == 4);
  midsurface_statistics_free(table);
}

static void arrays_that_are_unknown_are_null(void)
{
  const midsurface_triangle_mesh mesh = squares();
  midsurface_statistics* table = NULL;
  midsurface_error* error = NULL;
  CHECK_SUCCEEDS(midsurface_measure(&mesh, &table, &error), error);
  if (CHECK(midsurface_statistics_length(table) == 1))
  {
    CHECK(isnan(midsurface_statistics_rows(table)->thickness_mean));
    CHECK(isnan(midsurface_statistics_rows(table)->thickness_quantiles[4]));
  }
  midsurface_statistics_free(table);
}

static void meshes_that_cannot_be_measured_are_refused(void)
{
  const int64_t outside[] = { 0, 1, 7 };
  midsurface_triangle_mesh mesh = squares();
  midsurface_statistics* table = STALE(midsurface_statistics);
  midsurface_error* error = NULL;
  mesh.triangles = outside;
  mesh.triangle_count = 1;
  CHECK_INVALID(midsurface_measure(&mesh, &table, &error), error, "uses point 7");
  CHECK(table == NULL);
  mesh.triangles = NULL;
  CHECK_INVALID(midsurface_measure(&mesh, &table, &error), error, "`mesh.triangles` is NULL");
  CHECK_INVALID(midsurface_measure(NULL, &table, &error), error, "`mesh` is NULL");
  CHECK_INVALID(midsurface_measure(&mesh, NULL, &error), error, "`out` is NULL");
  CHECK(midsurface_statistics_length(NULL) == 0);
  CHECK(midsurface_statistics_rows(NULL) == NULL);
  midsurface_statistics_free(NULL);
}

void test_statistics(void)
{
  RUN(a_mesh_is_measured_in_total_and_in_parts);
  RUN(arrays_that_are_unknown_are_null);
  RUN(meshes_that_cannot_be_measured_are_refused);
}
