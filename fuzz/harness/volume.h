#ifndef VOLUME_H
#define VOLUME_H

#include "bytes.h"

/** A volume, and what is asked of it. */
typedef struct given
{
  midsurface_volume volume;
  /** What its buffer holds, and bytes of each, whatever its length and its type say. */
  size_t voxels;
  size_t scalar_size;
  midsurface_options options;
  /** The last byte of the input, for what else there is to decide. */
  uint8_t last;
} given;

typedef void run_function(const given* given);

void run_on_volume(const uint8_t* data, size_t size, run_function* run);

#endif
