/* The single pass in lanes, where the nearest splat wins alone: a tile splat by splat, then its colours. Included by
 * tile_kernels_body.h. */
CONIC_INLINE unsigned keep_nearest(const fragments *f, uint32_t i_footprint, conic_nearest_fragments *kept, size_t at,
                                   int is_special) {
  lanes iz = lanes_load(kept->iz + at);
  lanes_mask nearer = f->covered & lanes_less(iz, f->iz);
  lanes_store(kept->iz + at, lanes_select(nearer, f->iz, iz));
  lanes_replace(kept->q + at, nearer, f->q);
  lanes_replace_indices(kept->footprint + at, nearer, lanes_of_index(i_footprint));
  if (is_special)
    lanes_replace(kept->scale + at, nearer, f->scale);
  return lanes_count(f->covered);
}

/* A tile's pixels: the columns of its bands, and the rows of each. */
typedef struct tile_sites {
  sites of_band;
  lanes y[CONIC_BAND_BLOCKS];
} tile_sites;

CONIC_INLINE void find_tile_sites(const conic_band *band, tile_sites *s) {
  find_sites(band, &s->of_band);
  for (int i_row = 0; i_row < band->n_rows; i_row++)
    s->y[i_row] = nan_beyond(lanes_rows() + (band->y + i_row * CONIC_BLOCK_EDGE), band->view->height);
}

CONIC_INLINE unsigned nearest_in_block(const sources *from, const tile_sites *s, const conic_footprint *footprint,
                                       uint32_t i_footprint, const splat_rows *rows, uint32_t block,
                                       conic_nearest_fragments *row, int is_special) {
  unsigned n_covered = 0;
  fragments f;
  for (uint32_t part = 0; part < CONIC_PARTS; part++) {
    evaluate(from, footprint, rows, s->of_band.x[block * CONIC_PARTS + part], is_special, &f);
    n_covered += keep_nearest(&f, i_footprint, &row[block], part * CONIC_LANES, is_special);
  }
  return n_covered;
}

/* One splat in the blocks that its entry names; two columns in any case, like pass_splat. */
CONIC_INLINE unsigned nearest_splat(const sources *from, const tile_sites *s, const conic_tile_entry *entry,
                                    conic_nearest_fragments *nearest, int is_special) {
  const conic_footprint *footprint = &from->footprints[entry->footprint];
  const uint32_t first = conic_word_first(entry->word), last = conic_word_last(entry->word), met = entry->word >> 16;
  const uint32_t second = last > first ? first + 1 : CONIC_NO_BLOCK;
  unsigned n_covered = 0;
  for (int i_row = __builtin_ctz(met), last_row = 31 - __builtin_clz(met); i_row <= last_row; i_row++) {
    conic_nearest_fragments *row = nearest + i_row * (CONIC_BAND_BLOCKS + 1);
    const splat_rows rows = begin_rows(footprint, s->y[i_row]);
    n_covered += nearest_in_block(from, s, footprint, entry->footprint, &rows, first, row, is_special);
    n_covered += nearest_in_block(from, s, footprint, entry->footprint, &rows, second, row, is_special);
    for (uint32_t block = first + 2; block <= last; block++)
      n_covered += nearest_in_block(from, s, footprint, entry->footprint, &rows, block, row, is_special);
  }
  return n_covered;
}

static void nearest(conic_band *band) {
  enum { AHEAD = 32 };
  const sources from = sources_of(band);
  const conic_tile_entry *const entries = band->entries;
  const size_t n = band->n_entries;
  conic_nearest_fragments *const kept = band->nearest;
  uint64_t n_fragments = 0;
  int has_special = 0;
  tile_sites s;
  find_tile_sites(band, &s);
  memset(kept, 0, (size_t)band->n_rows * (CONIC_BAND_BLOCKS + 1) * sizeof *kept);
  for (size_t i = 0; i < n; i++) {
    uint32_t later = entries[i + AHEAD < n ? i + AHEAD : i].footprint;
    __builtin_prefetch(&from.footprints[later]);
    __builtin_prefetch(&from.surfaces[later], 0, 2);
    if (__builtin_expect(from.footprints[entries[i].footprint].s3 > 0.0f, 1))
      n_fragments += nearest_splat(&from, &s, &entries[i], kept, 0);
    else {
      prefetch_ray(&from, entries[i + 12 < n ? i + 12 : i].footprint);
      n_fragments += nearest_splat(&from, &s, &entries[i], kept, 1);
      has_special = 1;
    }
  }
  band->has_special = has_special;
  band->n_fragments += n_fragments;
}

/* The nearest splats' colour, normal and weight. */
CONIC_INLINE void take_part(const conic_band *band, const sources *from, int block, size_t at) {
  const conic_nearest_fragments *kept = &band->nearest[block];
  lanes surface[8], scale = lanes_of(1.0f); /* the fields of conic_surface */
  lanes_mask covered = lanes_less(lanes_of(0.0f), lanes_load(kept->iz + at));
  part_sums to;
  clear_sums(&to);
  to.heaviest = to.nearest = lanes_load_indices(kept->footprint + at);
  lanes_gather_records(from->surfaces->color, kept->footprint + at, surface);
  for (int lane = 0; lane < CONIC_LANES && band->has_special; lane++)
    if (!(from->footprints[kept->footprint[at + (size_t)lane]].s3 > 0.0f))
      scale[lane] = kept->scale[at + (size_t)lane];
  to.weight =
      weigh(from->view, 1.0f, lanes_load(kept->q + at), surface[7] * scale, covered, kind_of(&from->view->kernel));
  for (int axis = 0; axis < 3; axis++) { /* to 0, which a product may be below: -0 */
    to.color[axis] += to.weight * surface[axis];
    to.normal[axis] += to.weight * surface[3 + axis];
  }
  to.count = lanes_increment(covered, lanes_of_index(0));
  store_sums(&to, at, &band->sums[block]);
}

static void take_nearest(conic_band *band) {
  const sources from = sources_of(band);
  empty_blocks(band);
  for (int block = 0; block < band->n_blocks; block++) {
    lanes nearest_iz = lanes_of(0.0f);
    for (size_t at = 0; at < CONIC_BLOCK_PIXELS; at += CONIC_LANES)
      nearest_iz = lanes_max(nearest_iz, lanes_load(band->nearest[block].iz + at));
    if (!lanes_any(lanes_less(lanes_of(0.0f), nearest_iz)))
      continue;
    band->n_kept[block] = 1;
    for (size_t at = 0; at < CONIC_BLOCK_PIXELS; at += CONIC_LANES)
      take_part(band, &from, block, at);
  }
}
