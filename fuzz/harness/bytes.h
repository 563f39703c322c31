#ifndef BYTES_H
#define BYTES_H

#include "midsurface.h"

/** What the fuzzer gives, read from front to back; zeros once it is used up. */
typedef struct bytes
{
  const uint8_t* data;
  size_t size;
} bytes;

uint8_t take_byte(bytes* input);
uint64_t take_word(bytes* input);

/** Often a small number, else any pattern of bits: infinite, not a number and so on. */
double take_number(bytes* input);

/** As take_number, a whole number. */
int64_t take_index(bytes* input);

/** A buffer of exactly that size, so that the sanitizer sees whatever is read beyond its end. */
void* buffer_of(size_t count, size_t size);

/** A method, an edge length, labels and so on; the labels point into `labels`. */
midsurface_options take_options(bytes* input, int64_t labels[4], unsigned* calls_until_cancel);

/** Fails unless success goes with no error, and failure with a status and a message; frees it. */
void check_outcome(midsurface_status status, midsurface_error* error);

/** Looks at every value of the mesh, checks its topology and frees it. */
void consume_mesh(midsurface_mesh* mesh);

/** Aborts where `condition` is false. */
void require(bool condition);

#endif
