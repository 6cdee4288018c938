/* The plain C reference of the loops: a pixel at a time, by the definitions of coverage.h. */

#include "core/lanes/stream.h"
#include "raster/loops/raster_loops.h"
#include "raster/loops/resolve.h"
#include "raster/tiles/coverage.h"
#include "raster/triangles/triangle_tile.h"

/* The fragment of a footprint at a pixel: 1 where it is covered. */
static int fragment_at(const conic_band *band, uint32_t i_footprint, int x, int y, conic_fragment *fragment) {
  const conic_footprint *footprint = &band->projected->footprints[i_footprint];
  return x < band->view->width && y < band->view->height &&
         conic_fragment_at(band->view, band->projected, footprint, x, y, fragment);
}

/* At pixel l of a block. */
static int fragment_of(const conic_band *band, uint32_t i_footprint, int block, int l, conic_fragment *fragment) {
  return fragment_at(band, i_footprint, band->x + block * CONIC_BLOCK_EDGE + l / CONIC_BLOCK_EDGE,
                     band->y + l % CONIC_BLOCK_EDGE, fragment);
}

static void keys(const conic_box *boxes, size_t n, int tile_bits, int n_tiles_x, int by_pixels, uint32_t *tiles,
                 uint32_t *words, uint32_t *beyond) {
  for (size_t i = 0; i < n; i++) {
    conic_key key = conic_key_of(&boxes[i], tile_bits, n_tiles_x, by_pixels);
    tiles[i] = key.tile;
    words[i] = key.word;
    beyond[i] = key.beyond;
  }
}

static inline void stream_record(void *to, const void *from, size_t bytes) {
  conic_stream_copy(to, from, bytes);
}

#include "raster/loops/reach_body.h"
#include "raster/loops/sort_body.h"

static size_t select_references(const conic_tile_entry *references, size_t n, uint32_t mask, uint32_t *footprints,
                                uint32_t *words) {
  size_t n_selected = 0;
  for (size_t i = 0; i < n; i++) {
    if (!(references[i].word & mask))
      continue;
    words[n_selected] = references[i].word;
    footprints[n_selected++] = references[i].footprint;
  }
  return n_selected;
}

/* Raises the thresholds of one block and writes the splat's fragments to the next place; returns how many there are. */
static unsigned pass_block(const conic_band *band, uint32_t i_footprint, int block) {
  conic_kept *kept = &band->kept[block];
  const float *ray_x = band->rays->block_x[block], *ray_y = conic_band_ray_y(band);
  size_t place = band->n_kept[block];
  unsigned n_covered = 0;
  kept->footprint[place] = i_footprint;
  for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
    conic_fragment fragment = {0, 0, 0, 0};
    int is_covered = fragment_of(band, i_footprint, block, l, &fragment);
    kept->fragments[place].q[l] = band->view->profile.table ? fragment.scale : fragment.q;
    kept->fragments[place].seen_iz[l] = is_covered ? conic_seen_iz(&fragment) : -1.0f;
    kept->scale[place][l] = fragment.scale;
    if (!is_covered)
      continue;
    float offset_iz = conic_hiding_iz(&band->projected->footprints[i_footprint], &fragment, ray_x[l], ray_y[l]);
    kept->threshold[l] = offset_iz > kept->threshold[l] ? offset_iz : kept->threshold[l];
    n_covered++;
  }
  return n_covered;
}

static void visibility(conic_band *band) {
  size_t room = band->keeps_indices ? 0 : CONIC_KEPT_SPLATS;
  band->has_special = 0;
  for (size_t i = 0; i < band->n; i++)
    band->has_special |= !(band->projected->footprints[band->indices[i]].s3 > 0.0f);
  for (int block = 0; block < band->n_blocks; block++) {
    memset(band->kept[block].threshold, 0, sizeof band->kept[block].threshold);
    band->n_kept[block] = 0;
    band->not_kept[block] = band->n;
  }
  for (size_t i = 0; i < band->n; i++)
    for (int block = 0; block < band->n_blocks; block++) {
      unsigned n_covered =
          conic_word_has(band->words[i], (uint32_t)block) ? pass_block(band, band->indices[i], block) : 0;
      band->n_fragments += n_covered;
      if (n_covered == 0)
        continue;
      if (band->n_kept[block] < room)
        band->n_kept[block]++;
      else if (band->not_kept[block] == band->n)
        band->not_kept[block] = i;
    }
}

static void blend(const conic_band *band, uint32_t i_footprint, int block, int l, const conic_fragment *fragment,
                  float *heaviest_weight) {
  conic_block_sums *sums = &band->sums[block];
  const conic_projected_surface *surface = &band->projected->surfaces[i_footprint];
  const conic_footprint *footprint = &band->projected->footprints[i_footprint];
  float weight = conic_final_weight(band->view, footprint, fragment->q, fragment->scale);
  sums->weight[l] += weight;
  for (int axis = 0; axis < 3; axis++) {
    sums->color[axis][l] += weight * surface->color[axis];
    sums->normal[axis][l] += weight * surface->normal[axis];
  }
  if (*heaviest_weight < weight) {
    *heaviest_weight = weight;
    sums->heaviest[l] = i_footprint;
  }
}

/* Splats come in file order: sums keep it, and the first of equals stays. */
static void accumulate_pixel(const conic_band *band, int block, int l) {
  const conic_kept *kept = &band->kept[block];
  float heaviest_weight = 0.0f, nearest_iz = 0.0f;
  conic_fragment fragment = {0, 0, 0, 0};
  for (size_t i = 0; i < band->n_kept[block]; i++) {
    fragment.q = kept->fragments[i].q[l];
    fragment.scale = kept->scale[i][l];
    if (kept->fragments[i].seen_iz[l] >= kept->threshold[l])
      blend(band, kept->footprint[i], block, l, &fragment, &heaviest_weight);
  }
  for (size_t i = band->not_kept[block]; i < band->n; i++) {
    if (!(conic_word_has(band->words[i], (uint32_t)block)) ||
        !fragment_of(band, band->indices[i], block, l, &fragment) || !(conic_seen_iz(&fragment) >= kept->threshold[l]))
      continue;
    blend(band, band->indices[i], block, l, &fragment, &heaviest_weight);
    if (!band->keeps_indices)
      continue;
    band->sums[block].count[l]++;
    if (nearest_iz < fragment.iz) {
      nearest_iz = fragment.iz;
      band->sums[block].nearest[l] = band->indices[i];
    }
  }
}

static void accumulate(conic_band *band) {
  for (int block = 0; block < band->n_blocks; block++) {
    if (conic_block_is_empty(band, block))
      continue;
    memset(&band->sums[block], 0, sizeof band->sums[block]);
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++)
      accumulate_pixel(band, block, l);
  }
}

/* Returns whether the splat covers the pixel in the given column and row of the tile. */
static unsigned keep_nearest(const conic_band *band, uint32_t i_footprint, int column, int row) {
  conic_nearest *kept = band->nearest;
  size_t at = conic_strip_place(band->strip_rows, column, row);
  conic_fragment fragment;
  if (!fragment_at(band, i_footprint, band->x + column, band->y + row, &fragment))
    return 0;
  if (!(kept->iz[at] < fragment.iz))
    return 1;
  kept->iz[at] = fragment.iz;
  kept->q[at] = fragment.q;
  kept->scale[at] = fragment.scale;
  kept->footprint[at] = i_footprint;
  return 1;
}

static void nearest(conic_band *band) {
  band->has_special = 0;
  conic_nearest_begin(band);
  for (size_t i = 0; i < band->n_entries; i++) {
    const conic_tile_entry *entry = &band->entries[i];
    band->has_special |= !(band->projected->footprints[entry->footprint].s3 > 0.0f);
    for (int row = (int)conic_word_first_row(entry->word); row <= (int)conic_word_last_row(entry->word); row++)
      for (int column = (int)conic_word_first(entry->word); column <= (int)conic_word_last(entry->word); column++)
        band->n_fragments += keep_nearest(band, entry->footprint, column, row);
  }
}

/* The nearest splats' colour, normal and weight. */
static void take_block(const conic_band *band, int block) {
  conic_block_sums *sums = &band->sums[block];
  memset(sums, 0, sizeof *sums);
  for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
    const conic_nearest *kept = band->nearest;
    size_t at = conic_nearest_place(band, block, l);
    float heaviest_weight = 0.0f;
    conic_fragment fragment = {.q = kept->q[at], .scale = kept->scale[at]};
    if (!(kept->iz[at] > 0.0f))
      continue;
    blend(band, kept->footprint[at], block, l, &fragment, &heaviest_weight);
    sums->nearest[l] = kept->footprint[at];
    sums->count[l] = 1;
  }
}

static void take_nearest(conic_band *band) {
  for (int block = 0; block < band->n_blocks; block++) {
    band->n_kept[block] = 0;
    band->not_kept[block] = band->n;
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++)
      band->n_kept[block] |= band->nearest->iz[conic_nearest_place(band, block, l)] > 0.0f;
    if (!conic_block_is_empty(band, block))
      take_block(band, block);
  }
}

static void texture_at_places(const conic_texture *texture, const conic_texture_places *places, uint32_t pixels,
                              float color[3][CONIC_BLOCK_PIXELS]) {
  for (uint32_t left = pixels; left; left &= left - 1) {
    int l = __builtin_ctz(left);
    const float uv[2] = {places->uv[0][l], places->uv[1][l]}, along[2] = {places->along[0][l], places->along[1][l]};
    const float across[2] = {places->across[0][l], places->across[1][l]};
    float texel[3];
    conic_texture_sample(texture, uv, along, across, texel);
    for (int channel = 0; channel < 3; channel++)
      color[channel][l] = texel[channel];
  }
}

CONIC_DEFINE_LOOPS(conic_raster_loops)

void conic_raster_loops_scalar(conic_raster_loops *loops) {
  *loops = (conic_raster_loops){
      .project = {.project = conic_project_range},
      .bins = {.keys = keys, .sort = sort, .select = select_references},
      .passes = {1, visibility, accumulate, nearest, take_nearest},
      .resolve = {.resolve = conic_band_resolve},
      .triangles = {conic_triangle_vertices, conic_triangles_draw, conic_triangles_hide, conic_triangles_add},
      .texture = {.at_places = texture_at_places},
      .reach = {bound_reach},
  };
}
