#include "volumes.h"

#include <string.h>

midsurface_volume volume_of(const void* scalars, midsurface_scalar_type type)
{
  const midsurface_volume volume = {
    .scalars = scalars,
    .length = VOXELS,
    .scalar_type = type,
    .dimensions = { WIDTH, HEIGHT, DEPTH },
    .spacing = { 1.0, 1.0, 1.0 },
    .direction = { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 },
  };
  return volume;
}

midsurface_volume two_sheets(uint8_t scalars[VOXELS])
{
  memset(scalars, 0, VOXELS);
  for (int row = 0; row < HEIGHT * DEPTH; row++)
  {
    memset(scalars + row * WIDTH + 4, 1, 4);
    memset(scalars + row * WIDTH + 15, 3, 4);
  }
  return volume_of(scalars, MIDSURFACE_SCALAR_TYPE_UINT8);
}

midsurface_volume tube(uint8_t scalars[VOXELS])
{
  for (int voxel = 0; voxel < VOXELS; voxel++)
  {
    const double x = voxel % WIDTH - 11.5;
    const double y = voxel / WIDTH % HEIGHT - 9.5;
    const double squared_radius = x * x + y * y;
    scalars[voxel] = squared_radius > 5.0 * 5.0 && squared_radius < 8.5 * 8.5;
  }
  return volume_of(scalars, MIDSURFACE_SCALAR_TYPE_UINT8);
}
