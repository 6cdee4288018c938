/* The tables of what is done with tiles: sorting, passes, resolving, textures (raster/loops/raster_loops.h). */
#pragma once

#include "conic/texture.h"
#include "raster/tiles/bins.h"
#include "raster/tiles/finish.h"

/* select may write so many entries past those that it counts. */
#define CONIC_SELECT_SLACK 16

/* The loops of sorting. */
typedef struct conic_bin_loops {
  /* conic_key_of every box. */
  void (*keys)(const conic_box *boxes, size_t n, int tile_bits, int n_tiles_x, int by_pixels, uint32_t *tiles,
               uint32_t *words, uint32_t *beyond);
  /* After conic_sorter_count: copies the sorter's records in the order of the tiles, to places from `first` of all on,
   * and makes the entries. Clip lines are left to the caller, who finds the order in the sorter. */
  void (*sort)(const conic_bins *bins, conic_sorter *sorter, size_t first, conic_tile_entry *entries,
               conic_footprint *footprints, conic_projected_surface *surfaces);
  /* The references whose word has a bit of the mask, in order: footprints and words apart. Returns how many. */
  size_t (*select)(const conic_tile_entry *references, size_t n, uint32_t mask, uint32_t *footprints, uint32_t *words);
} conic_bin_loops;

/* The loops of the passes. */
typedef struct conic_pass_loops {
  int n_lanes; /* pixels that they take at a time */
  /* Pass 1: the band's kept fragments and thresholds, n_kept, not_kept, n_fragments. */
  void (*visibility)(conic_band *band);
  /* Pass 2: the sums over the visible splats of each block that is not empty. */
  void (*accumulate)(conic_band *band);
  /* In place of both where the nearest splat wins alone, the first of equals: its fragments, of the tile from the band
   * on, and n_fragments; */
  void (*nearest)(conic_band *band);
  /* and from them the band's sums, n_kept, not_kept. */
  void (*take_nearest)(conic_band *band);
} conic_pass_loops;

/* The loops of pass 3: the image's pixels, and n_covered. */
typedef struct conic_resolve_loops {
  void (*resolve)(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, conic_image *image);
} conic_resolve_loops;

/* Where a block's pixels see a texture, as conic_texture_sample takes it, by their order. */
typedef struct conic_texture_places {
  float uv[2][CONIC_BLOCK_PIXELS], along[2][CONIC_BLOCK_PIXELS], across[2][CONIC_BLOCK_PIXELS];
} conic_texture_places;

/* The loops of textures: the texture's colours at those of a block's pixels; the
 * others' stay as they are. */
typedef struct conic_texture_loops {
  void (*at_places)(const conic_texture *texture, const conic_texture_places *places, uint32_t pixels,
                    float color[3][CONIC_BLOCK_PIXELS]);
} conic_texture_loops;
