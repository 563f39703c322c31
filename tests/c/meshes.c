#include "meshes.h"

#include "check.h"

#include <math.h>
#include <string.h>

midsurface_mesh_arrays arrays_of(const midsurface_mesh* mesh)
{
  midsurface_mesh_arrays arrays = { 0 };
  if (mesh != NULL)
  {
    (void)midsurface_mesh_view(mesh, &arrays, NULL);
  }
  return arrays;
}

static bool same_bytes(const void* one, const void* other, size_t size)
{
  return size == 0 || memcmp(one, other, size) == 0;
}

bool same_mesh(const midsurface_mesh* one, const midsurface_mesh* other)
{
  const midsurface_mesh_arrays a = arrays_of(one);
  const midsurface_mesh_arrays b = arrays_of(other);
  const size_t points = a.point_count;
  const size_t triangles = a.triangle_count;
  return points == b.point_count && triangles == b.triangle_count &&
    same_bytes(a.points, b.points, 3 * points * sizeof *a.points) &&
    same_bytes(a.normals, b.normals, 3 * points * sizeof *a.normals) &&
    same_bytes(a.thickness, b.thickness, points * sizeof *a.thickness) &&
    same_bytes(a.triangles, b.triangles, 3 * triangles * sizeof *a.triangles) &&
    same_bytes(a.labels, b.labels, triangles * sizeof *a.labels) &&
    same_bytes(a.components, b.components, triangles * sizeof *a.components);
}

double area_of(const midsurface_mesh* mesh)
{
  const midsurface_mesh_arrays arrays = arrays_of(mesh);
  double area = 0.0;
  for (size_t t = 0; t < arrays.triangle_count; t++)
  {
    const float* corners[3];
    double sides[2][3];
    for (int k = 0; k < 3; k++)
    {
      corners[k] = arrays.points + 3 * (size_t)arrays.triangles[3 * t + k];
    }
    for (int axis = 0; axis < 3; axis++)
    {
      sides[0][axis] = (double)corners[1][axis] - corners[0][axis];
      sides[1][axis] = (double)corners[2][axis] - corners[0][axis];
    }
    const double x = sides[0][1] * sides[1][2] - sides[0][2] * sides[1][1];
    const double y = sides[0][2] * sides[1][0] - sides[0][0] * sides[1][2];
    const double z = sides[0][0] * sides[1][1] - sides[0][1] * sides[1][0];
    area += 0.5 * sqrt(x * x + y * y + z * z);
  }
  return area;
}

midsurface_mesh* extracted(const midsurface_volume* volume, const midsurface_options* options)
{
  midsurface_error* error = NULL;
  midsurface_mesh* mesh = NULL;
  if (CHECK_SUCCEEDS(midsurface_extract(volume, options, &mesh, &error), error))
  {
    CHECK_SUCCEEDS(midsurface_mesh_check(mesh, &error), error);
    CHECK(arrays_of(mesh).triangle_count > 0);
  }
  return mesh;
}
