/* Meshes, compared and judged. */
#ifndef MIDSURFACE_TESTS_MESHES_H
#define MIDSURFACE_TESTS_MESHES_H

#include "midsurface.h"

#include <stdbool.h>

/* The arrays of a mesh; all zero where the mesh is NULL. */
midsurface_mesh_arrays arrays_of(const midsurface_mesh* mesh);

/* Whether every array of both meshes is the same, bit for bit. */
bool same_mesh(const midsurface_mesh* one, const midsurface_mesh* other);

/* The area of all triangles, world units squared. */
double area_of(const midsurface_mesh* mesh);

/* The mesh of a volume, checked; NULL, after a failed check, where there is none. */
midsurface_mesh* extracted(const midsurface_volume* volume, const midsurface_options* options);

#endif
