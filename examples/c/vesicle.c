/*
 * The C interface: makes a vesicle of voxels, extracts its mid-surface and writes it to the file
 * named, as OBJ, which MeshLab and Blender open.
 *
 *     cc vesicle.c $(pkg-config --cflags --libs midsurface) -o vesicle && ./vesicle vesicle.obj
 */
#include "midsurface.h"

#include <stdio.h>
#include <stdlib.h>

enum
{
  SIZE = 48
};

/* Voxels between radius 15 and 19 around the middle are 1; x runs fastest, then y, then z. */
static void fill(unsigned char* labels)
{
  for (int i = 0; i < SIZE * SIZE * SIZE; ++i)
  {
    const double x = i % SIZE - 23.5;
    const double y = i / SIZE % SIZE - 23.5;
    const double z = i / SIZE / SIZE - 23.5;
    const double squared = x * x + y * y + z * z;
    labels[i] = squared >= 15 * 15 && squared <= 19 * 19;
  }
}

static int write_obj(const char* name, const midsurface_mesh_arrays* mesh)
{
  FILE* file = fopen(name, "w");
  if (!file)
  {
    return 0;
  }
  for (size_t i = 0; i < mesh->point_count; ++i)
  {
    const float* point = mesh->points + 3 * i;
    fprintf(file, "v %g %g %g\n", point[0], point[1], point[2]);
  }
  for (size_t i = 0; i < mesh->triangle_count; ++i)
  {
    const int64_t* corner = mesh->triangles + 3 * i; /* OBJ counts from 1 */
    fprintf(file, "f %lld %lld %lld\n", (long long)corner[0] + 1, (long long)corner[1] + 1,
      (long long)corner[2] + 1);
  }
  return fclose(file) == 0;
}

int main(int argc, char** argv)
{
  unsigned char* labels = argc == 2 ? malloc(SIZE * SIZE * SIZE) : NULL;
  if (!labels)
  {
    fprintf(stderr, "usage: vesicle FILE.obj\n");
    return 2;
  }
  fill(labels);
  const midsurface_volume volume = {
    .scalars = labels,
    .length = SIZE * SIZE * SIZE,
    .scalar_type = MIDSURFACE_SCALAR_TYPE_UINT8,
    .dimensions = { SIZE, SIZE, SIZE },
    .spacing = { 1.0, 1.0, 1.0 }, /* nm, say: the mesh and its thickness are then in nm */
    .direction = { 1, 0, 0, 0, 1, 0, 0, 0, 1 },
  };
  const midsurface_options options = midsurface_options_default();
  midsurface_mesh* mesh = NULL;
  midsurface_error* error = NULL;
  if (midsurface_extract(&volume, &options, &mesh, &error) != MIDSURFACE_STATUS_OK)
  {
    fprintf(stderr, "vesicle: %s\n", midsurface_error_message(error));
    midsurface_error_free(error);
    free(labels);
    return 1;
  }
  midsurface_mesh_arrays arrays;
  midsurface_mesh_view(mesh, &arrays, NULL);
  printf("%zu points, %zu triangles\n", arrays.point_count, arrays.triangle_count);
  const int written = write_obj(argv[1], &arrays);
  midsurface_mesh_free(mesh);
  free(labels);
  return written ? 0 : 1;
}
