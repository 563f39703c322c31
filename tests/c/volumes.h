/* Small label volumes whose mid-surface is known. */
#ifndef MIDSURFACE_TESTS_VOLUMES_H
#define MIDSURFACE_TESTS_VOLUMES_H

#include "midsurface.h"

#ifdef __cplusplus
extern "C"
{
#endif

  enum
  {
    WIDTH = 24,
    HEIGHT = 20,
    DEPTH = 12,
    VOXELS = WIDTH * HEIGHT * DEPTH
  };

  /* A volume of WIDTH x HEIGHT x DEPTH voxels, spacing 1, at the origin. */
  midsurface_volume volume_of(const void* scalars, midsurface_scalar_type type);

  /* Two upright sheets from border to border, 4 voxels thick: label 1 at x = 4 to 7 (middle 5.5),
   * label 3 at x = 15 to 18 (middle 16.5). */
  midsurface_volume two_sheets(uint8_t scalars[VOXELS]);

  /* A tube along z with label 1, from the first to the last slice: its lines are closed. */
  midsurface_volume tube(uint8_t scalars[VOXELS]);

#ifdef __cplusplus
}
#endif

#endif
