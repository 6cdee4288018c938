/* The hot loops, one table an instruction set. All tables give the same bits as the plain C one.
 *
 * Contract of every slot: it writes what is named here and nothing else. Records are finite; a lane that is not covered
 * may hold anything, and is dropped by a comparison, never by a multiplication with zero. Sums are in the order of the
 * band's list. */
#ifndef CONIC_TILE_KERNELS_H
#define CONIC_TILE_KERNELS_H

#include "raster/tiles/bins.h"
#include "raster/tiles/resolve.h"
#include "raster/tiles/texture_places.h"
#include "raster/triangles/triangle_frame.h"

/* select may write so many entries past those that it counts. */
#define CONIC_SELECT_SLACK 16

typedef struct conic_tile_kernels {
  const char *name; /* "scalar", "sse2" … */
  int n_lanes;      /* pixels or splats that it takes at a time */
  /* Set-up: appends the splats begin … end - 1 to the chunk, compacted, in order. */
  void (*project)(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                  conic_projected *projected, conic_chunk *chunk);
  /* conic_key_of every box. */
  void (*keys)(const conic_box *boxes, size_t n, int tile_bits, int n_tiles_x, int by_pixels, uint32_t *tiles,
               uint32_t *words, uint32_t *beyond);
  /* After conic_sorter_count: copies the sorter's records in the order of the tiles, to places from `first` of all on,
   * and makes the entries. Clip lines are left to the caller, who finds the order in the sorter. */
  void (*sort)(const conic_bins *bins, conic_sorter *sorter, size_t first, conic_tile_entry *entries,
               conic_footprint *footprints, conic_projected_surface *surfaces);
  /* The references whose word has a bit of the mask, in order: footprints and words apart. Returns how many. */
  size_t (*select)(const conic_tile_entry *references, size_t n, uint32_t mask, uint32_t *footprints, uint32_t *words);
  /* Pass 1: the band's kept fragments and thresholds, n_kept, not_kept, n_fragments. */
  void (*visibility)(conic_band *band);
  /* Pass 2: the sums over the visible splats of each block that is not empty. */
  void (*accumulate)(conic_band *band);
  /* In place of both where the nearest splat wins alone, the first of equals: its fragments, of the tile from the band
   * on, and n_fragments; */
  void (*nearest)(conic_band *band);
  /* and from them the band's sums, n_kept, not_kept. */
  void (*take_nearest)(conic_band *band);
  /* Pass 3: the image's pixels, and n_covered. */
  void (*resolve)(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays, conic_image *image);
  /* Triangles: the vertices begin … end - 1 on the screen. */
  void (*triangle_vertices)(const conic_triangle_frame *frame, size_t begin, size_t end, conic_screen_vertex *vertices);
  /* The nearest at each pixel of the tile whose first is (x, y): blocks, covered, n_fragments. */
  void (*triangles_draw)(const conic_triangle_frame *frame, size_t i_tile, int x, int y, conic_triangle_tile *tile);
  /* After pass 1: which of a band's triangles are seen, and what they hide, in its thresholds. */
  void (*triangles_hide)(conic_band *band, const conic_tile_rays *rays);
  /* After pass 2: adds those that are seen to the sums; heaviest, nearest. */
  void (*triangles_add)(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays);
  /* The texture's colours at those of a block's pixels; the others' stay as they are. */
  void (*texture)(const conic_texture *texture, const conic_texture_places *places, uint32_t pixels,
                  float color[3][CONIC_BLOCK_PIXELS]);
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
