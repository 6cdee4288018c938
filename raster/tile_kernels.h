/* The hot loops over a tile's fragments, one table an instruction set. All tables give the same bits as the plain C
 * one.
 *
 * Contract of every slot: the tile's planes are cleared (conic_tile_clear) and hold what the slots before left; nothing
 * else is written. Records are finite, so no lane, masked ones included, multiplies zero by infinity except where a
 * comparison then drops it. Sums are in the order of the tile's list. */
#ifndef RASTER_TILE_KERNELS_H
#define RASTER_TILE_KERNELS_H

#include "raster/resolve.h"

typedef struct conic_tile_kernels {
  const char *name; /* "scalar", "sse2" … */
  /* Set-up: the splats of a chunk, compacted, in order. */
  void (*project)(const conic_view *view, const conic_splats *splats, size_t i_chunk, conic_projected *projected);
  /* Pass 1: threshold, and n_fragments. */
  void (*visibility)(conic_tile *tile);
  /* Pass 1 where the nearest splat wins alone: nearest_iz and nearest; the first of equals. */
  void (*nearest)(conic_tile *tile);
  /* Pass 2: sums over the visible splats, the heaviest and the nearest of them. */
  void (*accumulate)(conic_tile *tile);
  /* Pass 3: the image's pixels, and n_covered. */
  void (*resolve)(conic_tile *tile, const conic_finish *finish, conic_image *image);
} conic_tile_kernels;

extern const conic_tile_kernels conic_tile_kernels_scalar;
#if defined(__x86_64__)
extern const conic_tile_kernels conic_tile_kernels_sse2, conic_tile_kernels_avx2, conic_tile_kernels_avx512;
#elif defined(__aarch64__)
extern const conic_tile_kernels conic_tile_kernels_neon;
#endif

/* The table of the instruction set; null where this build or this machine has not got it. */
const conic_tile_kernels *conic_tile_kernels_of(conic_isa isa);

#endif
