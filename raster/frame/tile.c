#include "raster/frame/tile.h"

#include "core/lanes/stream.h"
#include "raster/triangles/triangle_tile.h"
#include "raster/view/ticks.h"

_Static_assert(CONIC_GATHER_SLACK <= CONIC_SELECT_SLACK, "room behind the entries");

static size_t padded(size_t n) {
  return (n + CONIC_SELECT_SLACK + 15) / 16 * 16;
}

size_t conic_tile_bytes(size_t n_references) {
  return CONIC_BAND_BLOCKS * sizeof(conic_block_sums) + sizeof(conic_nearest) +
         (CONIC_BAND_BLOCKS + 1) * sizeof(conic_kept) +
         padded(n_references) * (2 * sizeof(conic_tile_entry) + 4 * sizeof(uint32_t));
}

void conic_tile_place_scratch(conic_tile *tile, void *memory) {
  conic_tile_scratch *scratch = &tile->scratch;
  size_t n = padded(tile->n_references);
  scratch->nearest = memory;
  scratch->sums = (conic_block_sums *)(scratch->nearest + 1);
  scratch->kept = (conic_kept *)(scratch->sums + CONIC_BAND_BLOCKS);
  scratch->entries = (conic_tile_entry *)(scratch->kept + CONIC_BAND_BLOCKS + 1);
  scratch->samples = scratch->entries + n;
  scratch->indices = (uint32_t *)(scratch->samples + n);
  scratch->words = scratch->indices + 2 * n;
}

static size_t select_row(const conic_tile *tile, const conic_raster_loops *loops, int i_row, size_t at) {
  const conic_tile_scratch *scratch = &tile->scratch;
  return loops->bins.select(scratch->entries, tile->n_references, UINT32_C(0x10000) << i_row, scratch->indices + at,
                            scratch->words + at);
}

/* The splats that meet row i_row of the tile's blocks, the next after the last. Those of the row after it are listed
 * behind them, so that the end of a row fetches what the next one begins with. */
static void select_band(const conic_tile *tile, const conic_raster_loops *loops, int i_row, conic_band *band) {
  const conic_tile_scratch *scratch = &tile->scratch;
  size_t n_before = i_row > 0 ? band->n : 0;
  band->n = i_row > 0 ? band->n_listed - n_before : select_row(tile, loops, 0, 0);
  memmove(scratch->indices, scratch->indices + n_before, band->n * sizeof *scratch->indices);
  memmove(scratch->words, scratch->words + n_before, band->n * sizeof *scratch->words);
  for (size_t i = 0; i_row == 0 && i < band->n && i < CONIC_FETCHED_AHEAD; i++) {
    __builtin_prefetch(&tile->projected->footprints[scratch->indices[i]]);
    __builtin_prefetch(&tile->projected->surfaces[scratch->indices[i]]);
  }
  band->n_listed = band->n + (i_row + 1 < band->n_rows ? select_row(tile, loops, i_row + 1, band->n) : 0);
  band->y = tile->y_begin + i_row * CONIC_BLOCK_EDGE;
}

/* Takes the band's thresholds over. */
static void raise_hiding(const conic_tile *tile, const conic_band *band) {
  size_t width = (size_t)tile->view->width;
  for (int block = 0; block < band->n_blocks; block++)
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
      int x = band->x + block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE, y = band->y + l % CONIC_BLOCK_EDGE;
      if (x >= tile->x_end || y >= tile->y_end)
        continue;
      float *hides = &tile->hiding[(size_t)y * width + (size_t)x], threshold = band->kept[block].threshold[l];
      *hides = *hides < threshold ? threshold : *hides;
    }
}

static void hide(conic_tile *tile, const conic_raster_loops *loops, conic_band *band) {
  uint64_t start = conic_ticks();
  for (int i_row = 0; i_row < band->n_rows; i_row++) {
    select_band(tile, loops, i_row, band);
    loops->passes.visibility(band);
    raise_hiding(tile, band);
  }
  tile->ticks.visibility += conic_ticks() - start;
}

/* The triangles of a row, if there are any. */
static void begin_triangles(const conic_tile *tile, int i_row, conic_band *band) {
  band->triangles = NULL;
  if (tile->triangles)
    conic_triangle_tile_row(tile->triangles, tile->triangle_tile, i_row, band);
}

/* A row's depths, of whichever hides first. */
static unsigned write_hiding_row(const conic_tile *tile, const conic_band *band, int row, float *z) {
  unsigned n_covered = 0;
  int x = band->x - band->first_column, width = tile->x_end - tile->x_begin;
  for (int i = 0; i < width; i++) {
    int block = i / CONIC_BLOCK_EDGE, l = i % CONIC_BLOCK_EDGE * CONIC_BLOCK_EDGE + row;
    float iz = band->kept[block].threshold[l];
    if (band->triangles && band->triangles->covered[block] >> l & 1)
      iz = iz > band->triangles->blocks[block].iz[l] ? iz : band->triangles->blocks[block].iz[l];
    z[x + i] = iz > 0.0f ? 1.0f / iz : 0.0f;
    n_covered += iz > 0.0f;
  }
  return n_covered;
}

/* Visibility alone: Z is where hiding begins. Nothing is kept for blending. */
static void draw_hiding(conic_tile *tile, const conic_raster_loops *loops, conic_band *band, conic_image *image) {
  uint64_t start = conic_ticks();
  band->keeps_indices = 1;
  for (int i_row = 0; i_row < band->n_rows; i_row++) {
    select_band(tile, loops, i_row, band);
    loops->passes.visibility(band);
    begin_triangles(tile, i_row, band);
    for (int i = 0; i < CONIC_BLOCK_EDGE && band->y + i < tile->y_end; i++) {
      size_t row = (size_t)(band->y + i - band->first_row);
      float *z = (float *)image->planes[CONIC_PLANE_Z] + row * (size_t)image->width;
      band->n_covered += write_hiding_row(tile, band, i, z);
    }
  }
  tile->ticks.visibility += conic_ticks() - start;
}

static void draw_triangles(conic_tile *tile, const conic_raster_loops *loops) {
  uint64_t start = conic_ticks();
  loops->triangles.draw(tile->triangles, tile->i_tile, tile->x_begin, tile->y_begin, tile->triangle_tile);
  tile->ticks.visibility += conic_ticks() - start;
}

/* Visibility and accumulation of all rows, each resolved at once. */
static void draw_blended(conic_tile *tile, const conic_raster_loops *loops, const conic_finish *finish,
                         const conic_tile_rays *rays, conic_band *band, conic_image *image) {
  for (int i_row = 0; i_row < band->n_rows; i_row++) {
    uint64_t start = conic_ticks();
    select_band(tile, loops, i_row, band);
    uint64_t listed = conic_ticks();
    loops->passes.visibility(band);
    begin_triangles(tile, i_row, band);
    if (band->triangles)
      loops->triangles.hide(band, rays);
    uint64_t seen = conic_ticks();
    loops->passes.accumulate(band);
    if (band->triangles)
      loops->triangles.add(band, finish, rays);
    uint64_t summed = conic_ticks();
    loops->resolve.resolve(band, finish, rays, image);
    tile->ticks.lists += listed - start;
    tile->ticks.visibility += seen - listed;
    tile->ticks.accumulate += summed - seen;
    tile->ticks.resolve += conic_ticks() - summed;
  }
}

/* A register of 16 pixels holds four rows of four columns, or two rows of eight. Four rows are cheaper for splats of up
 * to four columns, most of which meet two such registers; two rows are the better the wider splats are. The tile's
 * first splats tell which. Narrower registers are never better off with four rows. */
static int choose_strip(const conic_band *band, int n_lanes) {
  enum { LOOKED_AT = 64 };
  size_t n = band->n_entries < LOOKED_AT ? band->n_entries : LOOKED_AT, n_narrow = 0;
  for (size_t i = 0; i < n; i++) {
    uint32_t word = band->entries[i].word;
    n_narrow += conic_word_last(word) - conic_word_first(word) < 4;
  }
  return n_lanes == 16 && 4 * n_narrow >= 3 * n ? 4 : 2;
}

/* The nearest splat alone: all rows in one go, since little is kept of it. */
static void draw_nearest(conic_tile *tile, const conic_raster_loops *loops, const conic_finish *finish,
                         const conic_tile_rays *rays, conic_band *band, conic_image *image) {
  uint64_t start = conic_ticks();
  band->strip_rows = choose_strip(band, loops->passes.n_lanes);
  loops->passes.nearest(band);
  uint64_t seen = conic_ticks();
  tile->ticks.visibility += seen - start;
  for (int i_row = 0; i_row < band->n_rows; i_row++) {
    band->y = tile->y_begin + i_row * CONIC_BLOCK_EDGE;
    band->nearest_row = i_row * CONIC_BLOCK_EDGE;
    loops->passes.take_nearest(band);
    begin_triangles(tile, i_row, band);
    if (band->triangles) {
      conic_triangles_win(band);
      loops->triangles.add(band, finish, rays);
    }
    loops->resolve.resolve(band, finish, rays, image);
  }
  tile->ticks.resolve += conic_ticks() - seen;
}

void conic_tile_draw(conic_tile *tile, const conic_raster_loops *loops, const conic_finish *finish, conic_image *image,
                     conic_tile_report *report) {
  conic_tile_rays rays;
  conic_band band = {.view = tile->view,
                     .projected = tile->projected,
                     .rays = &rays,
                     .keeps_indices = tile->keeps_indices,
                     .x = tile->x_begin,
                     .y = tile->y_begin,
                     .first_column = tile->first_column,
                     .first_row = tile->first_row,
                     .n_rows = (tile->y_end - tile->y_begin + CONIC_BLOCK_EDGE - 1) / CONIC_BLOCK_EDGE,
                     .entries = tile->scratch.entries,
                     .n_entries = tile->n_references,
                     .n_blocks = (tile->x_end - tile->x_begin + CONIC_BLOCK_EDGE - 1) / CONIC_BLOCK_EDGE,
                     .indices = tile->scratch.indices,
                     .words = tile->scratch.words,
                     .kept = tile->scratch.kept,
                     .nearest = tile->scratch.nearest,
                     .sums = tile->scratch.sums};
  conic_tile_rays_init(tile->view, tile->x_begin, tile->y_begin, &rays);
  if (tile->triangles)
    draw_triangles(tile, loops);
  if (tile->skips_hidden && (tile->hiding || finish->options->passes != 1))
    conic_tile_leave_hidden_out(tile, loops, &band);
  if (tile->hiding)
    hide(tile, loops, &band);
  else if (finish->options->passes == CONIC_PASS_OF_HIDING)
    draw_hiding(tile, loops, &band, image);
  else if (finish->options->passes == 1)
    draw_nearest(tile, loops, finish, &rays, &band, image);
  else
    draw_blended(tile, loops, finish, &rays, &band, image);
  conic_stream_fence();
  report->n_fragments = band.n_fragments;
  report->n_covered = band.n_covered;
  report->n_triangle_fragments = tile->triangles ? tile->triangle_tile->n_fragments : 0;
}
