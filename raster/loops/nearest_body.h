/* The single pass in lanes, where the nearest splat wins alone: a tile splat by splat, then its colours. Included by
 * raster_loops_body.h. */
#include "core/lanes/lanes_store.h"
#include "raster/loops/pass_body.h"

CONIC_INLINE void keep_nearest(const fragments *f, uint32_t i_footprint, conic_nearest *kept, size_t at,
                               int is_special) {
  lanes iz = lanes_load(kept->iz + at);
  lanes_mask nearer = f->covered & lanes_less(iz, f->iz);
  lanes_replace(kept->iz + at, nearer, f->iz);
  lanes_replace(kept->q + at, nearer, f->q);
  lanes_replace_indices(kept->footprint + at, nearer, lanes_of_index(i_footprint));
  if (is_special)
    lanes_replace(kept->scale + at, nearer, f->scale);
}

/* A tile's pixels as its strips have them, NaN beside the tile and outside the image. */
typedef struct strip_sites {
  float x[CONIC_GREATEST_STRIP * CONIC_STRIP_COLUMNS];
  lanes y[CONIC_GREATEST_TILE / 2 + 1];
} strip_sites;

CONIC_INLINE void find_strip_sites(const conic_band *band, int strip_rows, strip_sites *s) {
  int right = band->x + band->n_blocks * CONIC_BLOCK_EDGE, n_strips = band->n_rows * CONIC_BLOCK_EDGE / strip_rows;
  right = right < band->view->width ? right : band->view->width;
  for (int at = 0; at < strip_rows * CONIC_STRIP_COLUMNS; at++) {
    int x = band->x + at / strip_rows;
    s->x[at] = x < right ? (float)x : __builtin_nanf("");
  }
  for (int i = 0; i < n_strips; i++)
    s->y[i] = nan_beyond(lanes_alternating(strip_rows) + (band->y + i * strip_rows), band->view->height);
  s->y[n_strips] = lanes_of(__builtin_nanf(""));
}

/* An ellipse in all lanes, and what of it does not depend on the row: ellipse_fragments, with its operations in their
 * order, but only what tells how near it is. */
typedef struct ellipse_columns {
  lanes y, dy0, s2, s3, iz0, iz_dy, iz_far, iz_near;
  lanes s1_dx, iz_dx_dx;
} ellipse_columns;

CONIC_INLINE ellipse_columns begin_columns(const conic_footprint *footprint, lanes x) {
  lanes dx = (x - footprint->x) + footprint->dx0;
  return (ellipse_columns){lanes_of(footprint->y),      lanes_of(footprint->dy0),     lanes_of(footprint->s2),
                           lanes_of(footprint->s3),     lanes_of(footprint->iz0),     lanes_of(footprint->iz_dy),
                           lanes_of(footprint->iz_far), lanes_of(footprint->iz_near), footprint->s1 * dx,
                           footprint->iz_dx * dx};
}

CONIC_INLINE void column_fragments(const ellipse_columns *e, lanes y, float support, fragments *f) {
  lanes dy = (y - e->y) + e->dy0, minor = e->s3 * dy, major = e->s1_dx + e->s2 * dy;
  f->q = major * major + minor * minor;
  f->covered = lanes_less(f->q, lanes_of(support));
  f->iz = lanes_min(lanes_max((e->iz0 + e->iz_dy * dy) + e->iz_dx_dx, e->iz_far), e->iz_near);
}

/* A splat in one register of a strip. */
CONIC_INLINE void nearest_in_strip(const ellipse_columns *columns, const sources *from, const strip_sites *s,
                                   uint32_t i, uint32_t i_footprint, conic_nearest *kept, size_t at, size_t stride,
                                   index_lanes *n_covered) {
  fragments f;
  column_fragments(columns, s->y[i], from->support, &f);
  keep_nearest(&f, i_footprint, kept, i * stride + at, 0);
  *n_covered = lanes_increment(f.covered, *n_covered);
}

/* One splat in the pixels that its entry names, and those beside them that lanes have in one go. Of strips of four rows
 * always two: how many it meets cannot be foreseen. */
CONIC_INLINE void nearest_ellipse(const sources *from, const strip_sites *s, const conic_tile_entry *entry,
                                  uint32_t strip_rows, conic_nearest *kept, index_lanes *n_covered) {
  const conic_footprint *footprint = &from->footprints[entry->footprint];
  const size_t n_rows = strip_rows, begin = conic_word_first(entry->word) * n_rows,
               end = (conic_word_last(entry->word) + 1) * n_rows, stride = n_rows * CONIC_STRIP_COLUMNS;
  const uint32_t first = conic_word_first_row(entry->word) / strip_rows,
                 last = conic_word_last_row(entry->word) / strip_rows;
  for (size_t at = begin; at < end; at += CONIC_LANES) {
    const ellipse_columns columns = begin_columns(footprint, lanes_load(s->x + at));
    uint32_t i = first;
    if (strip_rows == 4)
      for (; i < first + 2; i++)
        nearest_in_strip(&columns, from, s, i, entry->footprint, kept, at, stride, n_covered);
    for (; i <= last; i++)
      nearest_in_strip(&columns, from, s, i, entry->footprint, kept, at, stride, n_covered);
  }
}

CONIC_INLINE unsigned nearest_of_kind(const sources *from, const strip_sites *s, const conic_tile_entry *entry,
                                      uint32_t strip_rows, conic_nearest *kept, splat_kind kind) {
  const conic_footprint *footprint = &from->footprints[entry->footprint];
  const size_t n_rows = strip_rows, begin = conic_word_first(entry->word) * n_rows,
               end = (conic_word_last(entry->word) + 1) * n_rows, stride = n_rows * CONIC_STRIP_COLUMNS;
  const uint32_t last = conic_word_last_row(entry->word) / strip_rows;
  unsigned n_covered = 0;
  fragments f;
  for (uint32_t i = conic_word_first_row(entry->word) / strip_rows; i <= last; i++) {
    const splat_rows rows = begin_splat(from, footprint, s->y[i], kind);
    for (size_t at = begin; at < end; at += CONIC_LANES) {
      evaluate(from, footprint, &rows, lanes_load(s->x + at), kind, &f);
      keep_nearest(&f, entry->footprint, kept, i * stride + at, 1);
      n_covered += lanes_count(f.covered);
    }
  }
  return n_covered;
}

CONIC_OUTLINE unsigned nearest_special(const sources *from, const strip_sites *s, const conic_tile_entry *entry,
                                       uint32_t strip_rows, conic_nearest *kept) {
  return nearest_of_kind(from, s, entry, strip_rows, kept, SPLAT_SPECIAL);
}

CONIC_OUTLINE unsigned nearest_profiled(const sources *from, const strip_sites *s, const conic_tile_entry *entry,
                                        uint32_t strip_rows, conic_nearest *kept) {
  return nearest_of_kind(from, s, entry, strip_rows, kept, SPLAT_PROFILED);
}

/* The splats of the entries begin … end - 1, so few that no lane's count overflows. Returns how many pixels they
 * cover. */
CONIC_INLINE uint64_t nearest_of(conic_band *band, const sources *from, const strip_sites *s, uint32_t strip_rows,
                                 size_t begin, size_t end) {
  enum { AHEAD = 32 };
  const conic_tile_entry *const entries = band->entries;
  conic_nearest *const kept = band->nearest;
  const size_t n = band->n_entries;
  const int is_profiled = from->view->profile.table != NULL;
  index_lanes n_covered = lanes_of_index(0);
  uint64_t sum = 0;
  for (size_t i = begin; i < end; i++) {
    uint32_t later = entries[i + AHEAD < n ? i + AHEAD : i].footprint;
    __builtin_prefetch(&from->footprints[later]);
    __builtin_prefetch(&from->surfaces[later], 0, 2);
    if (__builtin_expect(is_profiled, 0)) {
      sum += nearest_profiled(from, s, &entries[i], strip_rows, kept);
      band->has_special = 1;
    } else if (__builtin_expect(from->footprints[entries[i].footprint].s3 > 0.0f, 1))
      nearest_ellipse(from, s, &entries[i], strip_rows, kept, &n_covered);
    else {
      prefetch_ray(from, entries[i + 12 < n ? i + 12 : i].footprint);
      sum += nearest_special(from, s, &entries[i], strip_rows, kept);
      band->has_special = 1;
    }
  }
  return sum + sum_of_counts(n_covered);
}

CONIC_INLINE void nearest_in_strips(conic_band *band, uint32_t strip_rows) {
  enum { COUNTABLE = 1 << 20 };
  const sources from = sources_of(band);
  strip_sites s;
  find_strip_sites(band, (int)strip_rows, &s);
  conic_nearest_begin(band);
  band->has_special = 0;
  for (size_t begin = 0, n = band->n_entries; begin < n; begin += COUNTABLE)
    band->n_fragments += nearest_of(band, &from, &s, strip_rows, begin, begin + COUNTABLE < n ? begin + COUNTABLE : n);
}

static void nearest(conic_band *band) {
  if (band->strip_rows == 4)
    nearest_in_strips(band, 4);
  else
    nearest_in_strips(band, 2);
}

/* Where the part of a block is whose first pixel is `at`. */
CONIC_INLINE size_t place_of_part(const conic_band *band, int strip_rows, int block, size_t at) {
  return conic_strip_place(strip_rows, block * CONIC_BLOCK_EDGE + (int)at / CONIC_BLOCK_EDGE, band->nearest_row);
}

/* It: one piece of a strip of four rows, or what lies at `upper` and as far on in the strip below. */
CONIC_INLINE lanes load_part(const float *upper, int strip_rows) {
  return strip_rows == 4 ? lanes_load(upper) : lanes_of_pairs(upper, upper + (size_t)2 * CONIC_STRIP_COLUMNS);
}

/* The nearest splats' colour, normal and weight, in one part of a block. */
CONIC_INLINE void take_part(const conic_band *band, const sources *from, int strip_rows, int block, size_t at,
                            lanes_mask covered) {
  const conic_nearest *kept = band->nearest;
  const size_t of_strip = place_of_part(band, strip_rows, block, at);
  uint32_t footprint[CONIC_LANES];
  lanes surface[8], scale = lanes_of(1.0f); /* the fields of conic_projected_surface */
  part_sums to;
  clear_sums(&to);
  to.nearest = (index_lanes)load_part((const float *)(const void *)(kept->footprint + of_strip), strip_rows);
  to.heaviest = to.nearest = lanes_select_indices(covered, to.nearest, lanes_of_index(0)); /* else it is anything */
  lanes_store_indices(footprint, to.nearest);
  lanes_gather_records(from->surfaces->color, footprint, surface);
  const kernel_kind kind = kind_of_view(from->view);
  if (band->has_special || kind == KERNEL_PROFILE) {
    lanes scales = load_part(kept->scale + of_strip, strip_rows);
    for (int lane = 0; lane < CONIC_LANES; lane++)
      if (kind == KERNEL_PROFILE || !(from->footprints[footprint[lane]].s3 > 0.0f))
        scale[lane] = scales[lane];
  }
  to.weight = weigh(from->view, 1.0f, load_part(kept->q + of_strip, strip_rows), surface[7] * scale, covered, kind);
  for (int axis = 0; axis < 3; axis++) { /* to 0, which a product may be below: -0 */
    to.color[axis] += to.weight * surface[axis];
    to.normal[axis] += to.weight * surface[3 + axis];
  }
  to.count = lanes_increment(covered, lanes_of_index(0));
  store_sums(&to, at, &band->sums[block]);
}

CONIC_INLINE void take_from_strips(conic_band *band, int strip_rows) {
  const sources from = sources_of(band);
  empty_blocks(band);
  for (int block = 0; block < band->n_blocks; block++) {
    lanes_mask covered[CONIC_PARTS];
    int is_any = 0;
    for (int part = 0; part < CONIC_PARTS; part++) {
      const float *iz = band->nearest->iz + place_of_part(band, strip_rows, block, (size_t)part * CONIC_LANES);
      covered[part] = lanes_less(lanes_of(0.0f), load_part(iz, strip_rows));
      is_any |= lanes_any(covered[part]);
    }
    band->n_kept[block] = (size_t)is_any;
    for (int part = 0; part < CONIC_PARTS && is_any; part++)
      take_part(band, &from, strip_rows, block, (size_t)part * CONIC_LANES, covered[part]);
  }
}

static void take_nearest(conic_band *band) {
  if (band->strip_rows == 4)
    take_from_strips(band, 4);
  else
    take_from_strips(band, 2);
}
