#include "raster/frame/tile.h"

#include "raster/view/ticks.h"

/* What is known of a tile's blocks from some of its splats: no pixel's threshold will be below these. */
typedef struct hiders {
  float thresholds[CONIC_BAND_BLOCKS][CONIC_BAND_BLOCKS]; /* [row][column] */
  float least;                                            /* of all blocks */
} hiders;

/* The k-th of so many entries from all over the tile's. */
enum { LOOKED_AT = 128 };
static const conic_tile_entry *entry_looked_at(const conic_tile *tile, size_t k) {
  return &tile->scratch.entries[k * tile->n_references / LOOKED_AT];
}

/* Whether the blocks are met so often that most of what meets them must be hidden. A single surface of small splats
 * meets each some thirty times. */
static int has_many_layers(const conic_tile *tile, size_t n_blocks) {
  enum { MEETINGS = 128 };
  size_t n_met = 0;
  if (tile->n_references < 4 * n_blocks)
    return 0;
  for (size_t k = 0; k < LOOKED_AT; k++) {
    uint32_t word = entry_looked_at(tile, k)->word;
    n_met += (conic_word_last(word) - conic_word_first(word) + 1) * (size_t)__builtin_popcount(word >> 16);
  }
  return tile->n_references * n_met >= (size_t)MEETINGS * LOOKED_AT * n_blocks;
}

/* The least threshold of a block's pixels in the picture. */
static float least_threshold(const conic_band *band, int block) {
  const conic_view *view = band->view;
  const float *thresholds = band->kept[block].threshold;
  float least = thresholds[0];
  for (int l = 1; l < CONIC_BLOCK_PIXELS; l++)
    if (band->x + block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE < view->width &&
        band->y + l % CONIC_BLOCK_EDGE < view->height && thresholds[l] < least)
      least = thresholds[l];
  return least;
}

/* An inverse depth that some sixteenth of the splats reach. */
static float find_front(const conic_tile *tile) {
  enum { N_NEAREST = LOOKED_AT / 16 };
  float nearest[N_NEAREST + 1] = {0.0f}; /* from the nearest on */
  for (size_t k = 0; k < LOOKED_AT; k++) {
    float iz = tile->projected->footprints[entry_looked_at(tile, k)->footprint].iz_near;
    int at = N_NEAREST;
    for (; at > 0 && nearest[at - 1] < iz; at--)
      nearest[at] = nearest[at - 1];
    nearest[at] = iz;
  }
  return nearest[N_NEAREST - 1];
}

/* The nearest splats, and a few of all depths: the nearest may all lie in one corner. */
static size_t choose_near_samples(const conic_tile *tile) {
  enum { EVERY = 32, AHEAD = 16 };
  const conic_footprint *footprints = tile->projected->footprints;
  const conic_tile_entry *entries = tile->scratch.entries;
  const float front = find_front(tile);
  size_t n_samples = 0, n = tile->n_references;
  for (size_t i = 0; i < n; i++) {
    __builtin_prefetch(&footprints[entries[i + AHEAD < n ? i + AHEAD : i].footprint].iz_near);
    tile->scratch.samples[n_samples] = entries[i];
    n_samples += footprints[entries[i].footprint].iz_near >= front || i % EVERY == 0;
  }
  return n_samples;
}

/* Of a row of blocks. */
static void find_thresholds(const conic_tile *tile, const conic_raster_loops *loops, size_t n_samples, int i_row,
                            conic_band *band, hiders *h) {
  band->n = loops->bins.select(tile->scratch.samples, n_samples, UINT32_C(0x10000) << i_row, tile->scratch.indices,
                               tile->scratch.words);
  band->y = tile->y_begin + i_row * CONIC_BLOCK_EDGE;
  loops->passes.visibility(band);
  for (int block = 0; block < band->n_blocks; block++) {
    h->thresholds[i_row][block] = least_threshold(band, block);
    h->least = h->thresholds[i_row][block] < h->least ? h->thresholds[i_row][block] : h->least;
  }
}

/* No pixel of the blocks sees the splat by more than this. A pixel sees it by its plane or by its own inverse depth,
 * whichever is nearer, and the latter is at most iz_near. The plane's grows with dx and with dy or falls, whatever is
 * rounded, so that the greatest is that of one of the corners. */
static float most_seen_in(const conic_tile *tile, const conic_footprint *f, uint32_t word) {
  const int is_ray = f->s3 == 0.0f, rows = (int)(word >> 16);
  const float by_x = is_ray ? f->iz_dx : f->plane_dx, by_y = is_ray ? f->iz_dy : f->plane_dy;
  const int left = tile->x_begin + CONIC_BLOCK_EDGE * (int)conic_word_first(word);
  const int right = tile->x_begin + CONIC_BLOCK_EDGE * (int)conic_word_last(word) + CONIC_BLOCK_EDGE - 1;
  const int top = tile->y_begin + CONIC_BLOCK_EDGE * __builtin_ctz((unsigned)rows);
  const int bottom = tile->y_begin + CONIC_BLOCK_EDGE * (31 - __builtin_clz((unsigned)rows)) + CONIC_BLOCK_EDGE - 1;
  const float dx = ((float)(by_x > 0.0f ? right : left) - f->x) + f->dx0;
  const float dy = ((float)(by_y > 0.0f ? bottom : top) - f->y) + f->dy0;
  const float plane = (f->iz0 + by_y * dy) + by_x * dx;
  return plane > f->iz_near ? plane : f->iz_near;
}

/* Whether every block that the word names has a threshold above this. */
static int are_above(const hiders *h, uint32_t word, float seen) {
  const uint32_t first = conic_word_first(word), last = conic_word_last(word);
  if (seen < h->least)
    return 1;
  for (uint32_t rows = word >> 16; rows; rows &= rows - 1) {
    const float *row = h->thresholds[__builtin_ctz(rows)];
    for (uint32_t column = first; column <= last; column++)
      if (!(seen < row[column]))
        return 0;
  }
  return 1;
}

/* Whether a row of blocks, whose thresholds are known, hides a quarter of what meets it. A surface seen from the side
 * has many splats in a pixel, too, and nothing behind them. */
static int hides_enough(const conic_tile *tile, int i_row, const hiders *h) {
  const uint32_t outside = ~(UINT32_C(0x10000) << i_row) & 0xffff0000;
  size_t n_met = 0, n_hidden = 0;
  for (size_t k = 0; k < LOOKED_AT; k++) {
    const conic_tile_entry *entry = entry_looked_at(tile, k);
    const uint32_t word = entry->word & ~outside;
    if (!(word >> 16))
      continue;
    n_met++;
    n_hidden += (size_t)are_above(h, word, most_seen_in(tile, &tile->projected->footprints[entry->footprint], word));
  }
  return 4 * n_hidden >= n_met;
}

/* Tried on the row in the middle, with every eighth splat. */
static int are_worth_while(const conic_tile *tile, const conic_raster_loops *loops, conic_band *band) {
  enum { EVERY = 8 };
  const int middle = band->n_rows / 2;
  hiders h = {.least = HUGE_VALF};
  size_t n_samples = 0;
  for (size_t i = 0; i < tile->n_references; i += EVERY)
    tile->scratch.samples[n_samples++] = tile->scratch.entries[i];
  find_thresholds(tile, loops, n_samples, middle, band, &h);
  return hides_enough(tile, middle, &h);
}

static void find_hiders(const conic_tile *tile, const conic_raster_loops *loops, conic_band *band, hiders *h) {
  const size_t n_samples = choose_near_samples(tile);
  for (int i_row = 0; i_row < band->n_rows; i_row++)
    find_thresholds(tile, loops, n_samples, i_row, band, h);
}

static void leave_hidden_out(conic_tile *tile, const hiders *h) {
  enum { AHEAD = 16 };
  const conic_footprint *footprints = tile->projected->footprints;
  conic_tile_entry *entries = tile->scratch.entries;
  size_t n_left = 0, n = tile->n_references;
  for (size_t i = 0; i < n; i++) {
    const conic_tile_entry entry = entries[i];
    __builtin_prefetch(&footprints[entries[i + AHEAD < n ? i + AHEAD : i].footprint]);
    entries[n_left] = entry;
    n_left += !are_above(h, entry.word, most_seen_in(tile, &footprints[entry.footprint], entry.word));
  }
  tile->n_references = n_left;
}

void conic_tile_leave_hidden_out(conic_tile *tile, const conic_raster_loops *loops, const conic_band *band) {
  conic_band trial = *band;
  hiders h = {.least = HUGE_VALF};
  if (!has_many_layers(tile, (size_t)band->n_rows * (size_t)band->n_blocks))
    return;
  uint64_t start = conic_ticks();
  if (are_worth_while(tile, loops, &trial)) {
    find_hiders(tile, loops, &trial, &h);
    leave_hidden_out(tile, &h);
  }
  tile->ticks.visibility += conic_ticks() - start;
}
