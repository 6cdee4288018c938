/* Passes 1 and 2 in lanes: visibility and accumulation, and what the single pass shares with them. */
#pragma once

#include "raster/loops/crowd_body.h"

/* The pixels of a band: the rows are the same in every part, the columns those of the first part and so on. NaN
 * beside the band and outside the image: what is compared with it is not covered. */
typedef struct sites {
  lanes x[(CONIC_BAND_BLOCKS + 1) * CONIC_PARTS], y;
} sites;

CONIC_INLINE lanes nan_beyond(int_lanes pixels, int size) {
  lanes_mask inside = lanes_less_int(pixels, lanes_of_int(size));
  return lanes_select(inside, __builtin_convertvector(pixels, lanes), lanes_of(__builtin_nanf("")));
}

CONIC_INLINE void find_sites(const conic_band *band, sites *s) {
  s->y = nan_beyond(lanes_rows() + band->y, band->view->height);
  for (int part = 0; part < band->n_blocks * CONIC_PARTS; part++)
    s->x[part] = nan_beyond(lanes_columns() + (band->x + part * (CONIC_LANES / CONIC_BLOCK_EDGE)), band->view->width);
  for (int part = band->n_blocks * CONIC_PARTS; part < (CONIC_NO_BLOCK + 1) * CONIC_PARTS; part++)
    s->x[part] = lanes_of(__builtin_nanf(""));
}

/* What a band's loops read. A copy of their own: what they store might otherwise be these pointers, as far as a
 * compiler can tell. */
typedef struct sources {
  const conic_view *view;
  float support;
  const conic_footprint *footprints;
  const conic_projected_surface *surfaces;
  const conic_ray *rays;
  const conic_clip_record *clips;
  const uint32_t *indices, *words;
  size_t n, n_listed;
} sources;

CONIC_INLINE sources sources_of(const conic_band *band) {
  const conic_projected *projected = band->projected;
  return (sources){band->view,      band->view->support, projected->footprints, projected->surfaces,
                   projected->rays, projected->clips,    band->indices,         band->words,
                   band->n,         band->n_listed};
}

CONIC_INLINE void evaluate(const sources *from, const conic_footprint *footprint, const splat_rows *rows, lanes x,
                           splat_kind kind, fragments *f) {
  fragments_at(from->view, from->support, footprint, from->rays, footprint->i_ray, from->clips,
               (size_t)(footprint - from->footprints), rows, x, kind, f);
}

CONIC_INLINE splat_rows begin_splat(const sources *from, const conic_footprint *footprint, lanes y, splat_kind kind) {
  splat_rows rows = begin_rows(footprint, y);
  if (kind == SPLAT_PROFILED)
    begin_profile(from->view, footprint, from->rays, footprint->i_ray, &rows);
  return rows;
}

/* What the splat after the next few is read from, in this pass and the next. */
CONIC_INLINE void prefetch_splat(const sources *from, size_t i) {
  enum { AHEAD = CONIC_FETCHED_AHEAD };
  uint32_t later = from->indices[i + AHEAD < from->n_listed ? i + AHEAD : i];
  __builtin_prefetch(&from->footprints[later]);
  __builtin_prefetch(&from->surfaces[later]);
}

/* Where there is one ray there are more: that of the splat after the next few, whose footprint is there already. */
CONIC_INLINE void prefetch_ray(const sources *from, uint32_t later) {
  const conic_footprint *footprint = &from->footprints[later];
  if (footprint->s3 == 0.0f) {
    __builtin_prefetch(&from->rays[footprint->i_ray].u0);
    __builtin_prefetch(&from->rays[footprint->i_ray].dy_high);
  }
}

CONIC_INLINE void empty_blocks(conic_band *band) {
  for (int block = 0; block < band->n_blocks; block++) {
    band->n_kept[block] = 0;
    band->not_kept[block] = band->n;
  }
}

#include "raster/loops/smooth_body.h"

/* The state of the first pass along a band, a copy of its own like `sources`. */
typedef struct pass {
  conic_kept *kept;
  size_t room, n_kept[CONIC_BAND_BLOCKS + 1], not_kept[CONIC_BAND_BLOCKS + 1];
  uint64_t n_fragments;
  index_lanes n_covered;
  const conic_tile_rays *rays;
  const float *ray_y;
  lanes ray_length[(CONIC_BAND_BLOCKS + 1) * CONIC_PARTS]; /* of the blocks that has_lengths names by bits */
  uint32_t has_lengths;
} pass;

CONIC_INLINE void begin_pass(const conic_band *band, pass *p) {
  p->kept = band->kept;
  p->room = band->keeps_indices ? 0 : CONIC_KEPT_SPLATS;
  p->n_fragments = 0;
  p->n_covered = lanes_of_index(0);
  p->rays = band->rays;
  p->ray_y = conic_band_ray_y(band);
  p->has_lengths = 0;
  memset(p->n_kept, 0, sizeof p->n_kept);
  for (int block = 0; block < band->n_blocks; block++) {
    p->not_kept[block] = band->n;
    memset(p->kept[block].threshold, 0, sizeof p->kept[block].threshold);
  }
}

/* A block's, where the first wide splat meets it. */
CONIC_INLINE void find_lengths(pass *p, uint32_t block) {
  if (p->has_lengths >> block & 1)
    return;
  for (uint32_t part = 0; part < CONIC_PARTS; part++) {
    size_t at = (size_t)part * CONIC_LANES;
    p->ray_length[block * CONIC_PARTS + part] =
        ray_lengths(lanes_load(p->rays->block_x[block] + at), lanes_load(p->ray_y + at));
  }
  p->has_lengths |= 1u << block;
}

/* Lanes count fragments in a register, in place of one population count a block. */
CONIC_INLINE uint64_t sum_of_counts(index_lanes count) {
  uint64_t sum = 0;
  uint32_t stored[CONIC_LANES]; /* picking lanes would keep `count` in memory */
  lanes_store_indices(stored, count);
  for (int lane = 0; lane < CONIC_LANES; lane++)
    sum += stored[lane];
  return sum;
}

static __attribute__((noinline)) void take_counts(pass *p, index_lanes count) {
  p->n_fragments += sum_of_counts(count) + sum_of_counts(p->n_covered);
  p->n_covered = lanes_of_index(0);
}

/* One splat, and what of it is the same in all blocks. */
typedef struct passing {
  const conic_footprint *footprint;
  size_t i; /* in the band's list */
  uint32_t i_footprint;
  lanes nearness;
  splat_rows rows;
} passing;

/* conic_hiding_iz in a part of a block. */
CONIC_INLINE lanes hiding_iz(pass *p, const passing *splat, lanes iz, uint32_t part, splat_kind kind) {
  if (kind == SPLAT_WIDE || (kind >= SPLAT_SPECIAL && conic_is_wide(splat->footprint))) {
    find_lengths(p, part / CONIC_PARTS);
    return wide_hiding(splat->footprint, iz, p->ray_length[part]);
  }
  return splat->nearness * iz;
}

/* Raises a part's thresholds and writes its fragments to the place. */
CONIC_INLINE void pass_part(lanes hides, const fragments *f, conic_kept *kept, size_t place, size_t at,
                            splat_kind kind) {
  lanes_store(kept->threshold + at, lanes_max(lanes_keep(f->covered, hides), lanes_load(kept->threshold + at)));
  lanes_store(kept->fragments[place].q + at, kind == SPLAT_PROFILED ? f->scale : f->q);
  lanes_store(kept->fragments[place].seen_iz + at,
              lanes_select(f->covered, lanes_max(f->plane_iz, f->iz), lanes_of(-1.0f)));
  if (kind >= SPLAT_SPECIAL)
    lanes_store(kept->scale[place] + at, f->scale);
}

CONIC_INLINE void pass_block(pass *p, const sources *from, const sites *s, const passing *splat, uint32_t block,
                             splat_kind kind, index_lanes *count) {
  conic_kept *kept = &p->kept[block];
  size_t place = p->n_kept[block];
  lanes_mask covered = {0};
  fragments f;
  kept->footprint[place] = splat->i_footprint;
  for (uint32_t part = 0; part < CONIC_PARTS; part++) {
    evaluate(from, splat->footprint, &splat->rows, s->x[block * CONIC_PARTS + part], kind, &f);
    lanes hides = hiding_iz(p, splat, lanes_min(f.plane_iz, f.iz), block * CONIC_PARTS + part, kind);
    pass_part(hides, &f, kept, place, (size_t)part * CONIC_LANES, kind);
    *count = lanes_increment(f.covered, *count);
    covered |= f.covered;
  }
  if (place < p->room)
    p->n_kept[block] = place + (size_t)(lanes_any(covered) != 0);
  else if (lanes_any(covered) && p->not_kept[block] > splat->i)
    p->not_kept[block] = splat->i;
}

/* One splat in the blocks that its word names. Two are done in any case, the second perhaps one where it covers
 * nothing: most small splats have one or two, and which, no branch can foresee. */
CONIC_INLINE void pass_splat(pass *p, const sources *from, const sites *s, size_t i, splat_kind kind,
                             index_lanes *count) {
  const uint32_t i_footprint = from->indices[i], word = from->words[i];
  const uint32_t first = conic_word_first(word), last = conic_word_last(word);
  const conic_footprint *footprint = &from->footprints[i_footprint];
  passing splat = {footprint, i, i_footprint, lanes_of(footprint->nearness), begin_splat(from, footprint, s->y, kind)};
  pass_block(p, from, s, &splat, first, kind, count);
  pass_block(p, from, s, &splat, kind < SPLAT_SPECIAL || last > first ? first + 1 : CONIC_NO_BLOCK, kind, count);
  for (uint32_t block = first + 2; block <= last; block++)
    pass_block(p, from, s, &splat, block, kind, count);
}

/* A ray's pixels in a block, by their inverse depth alone. Returns 0, and does nothing, where they must be evaluated:
 * where it does not tell whether they are covered, or where there is room to keep them. */
CONIC_INLINE int glance_at_block(pass *p, const sources *from, const sites *s, const passing *splat, float sure,
                                 uint32_t block) {
  const splat_rows *rows = &splat->rows;
  float *thresholds = p->kept[block].threshold;
  lanes raised[CONIC_PARTS];
  unsigned n_covered = 0;
  for (uint32_t part = 0; part < CONIC_PARTS; part++) {
    lanes iz, dx = (s->x[block * CONIC_PARTS + part] - rows->x) + rows->dx0;
    lanes_mask covered = ray_reaches(splat->footprint, &from->rays[splat->footprint->i_ray], dx, rows->dy, &iz);
    if (lanes_any(covered & lanes_less(iz, lanes_of(sure))))
      return 0;
    lanes clamped = lanes_min(lanes_max(iz, rows->iz_far), rows->iz_near);
    lanes hides = hiding_iz(p, splat, lanes_min(iz, clamped), block * CONIC_PARTS + part, SPLAT_SPECIAL);
    raised[part] = lanes_max(lanes_keep(covered, hides), lanes_load(thresholds + (size_t)part * CONIC_LANES));
    n_covered += lanes_count(covered);
  }
  if (n_covered > 0 && p->n_kept[block] < p->room)
    return 0;
  for (uint32_t part = 0; part < CONIC_PARTS; part++)
    lanes_store(thresholds + (size_t)part * CONIC_LANES, raised[part]);
  if (n_covered > 0 && p->not_kept[block] > splat->i)
    p->not_kept[block] = splat->i;
  p->n_fragments += n_covered;
  return 1;
}

/* What is known of a crowded band. */
typedef struct crowd {
  uint32_t n_pixels;
  float threshold;  /* no pixel's is below it */
  int is_full;      /* every block leaves out some that cover it */
  float ray_length; /* no pixel's is above it */
} crowd;

/* Of a band's rays: that of one of its corners. */
static float greatest_length(const conic_band *band) {
  const float *x = band->rays->x, *y = conic_band_ray_y(band);
  float x_first = fabsf(x[0]), x_last = fabsf(x[band->n_blocks * CONIC_BLOCK_EDGE - 1]), y_first = fabsf(y[0]),
        y_last = fabsf(y[CONIC_BLOCK_EDGE - 1]);
  float x_most = x_first > x_last ? x_first : x_last, y_most = y_first > y_last ? y_first : y_last;
  return sqrtf((x_most * x_most + y_most * y_most) + 1.0f);
}

static __attribute__((noinline)) void look_at_crowd(const conic_band *band, const size_t *not_kept, crowd *c) {
  const int n_columns = lesser_end(band->n_blocks * CONIC_BLOCK_EDGE, band->view->width - band->x);
  const int n_rows = lesser_end(CONIC_BLOCK_EDGE, band->view->height - band->y);
  *c = (crowd){(uint32_t)(n_columns * n_rows), HUGE_VALF, 1, greatest_length(band)};
  for (int block = 0; block < band->n_blocks; block++)
    c->is_full &= not_kept[block] < band->n;
  for (int x = 0; x < n_columns; x++)
    for (int y = 0; y < n_rows; y++) {
      const conic_kept *kept = &band->kept[x / CONIC_BLOCK_EDGE];
      float threshold = kept->threshold[x % CONIC_BLOCK_EDGE * CONIC_BLOCK_EDGE + y];
      c->threshold = threshold < c->threshold ? threshold : c->threshold;
    }
}

/* Whether a ray that covers all of the band does nothing else there: no place is left for it, and it raises no
 * threshold. */
CONIC_INLINE int only_counts(const crowd *c, const conic_footprint *f, const crowd_depths *depths) {
  float most = most_seen(f, depths), length = c->ray_length;
  float hides = f->nearness * most;
  if (conic_is_wide(f)) /* and what rounding adds: it grows with the length in exact arithmetic */
    hides = (1.0f + 0x1p-20f) * (most * (length / (length - hides)));
  return c->is_full && hides <= c->threshold;
}

static __attribute__((noinline)) void pass_ray_in_crowd(pass *p, const sources *from, const sites *s,
                                                        const conic_band *band, const crowd *c, size_t i) {
  const uint32_t i_footprint = from->indices[i], word = from->words[i];
  const conic_footprint *f = &from->footprints[i_footprint];
  const conic_ray *ray = &from->rays[f->i_ray];
  const crowd_span span = span_of(band, f);
  const crowd_depths depths = depths_of(f, &span);
  const float sure = sure_iz(from->view, f, ray, &span);
  if (covers_span(ray, &span, &depths, sure) && only_counts(c, f, &depths)) {
    p->n_fragments += c->n_pixels;
    return;
  }
  const passing splat = {f, i, i_footprint, lanes_of(f->nearness), begin_rows(f, s->y)};
  for (uint32_t block = conic_word_first(word); block <= conic_word_last(word); block++)
    if (!(sure < HUGE_VALF) || !glance_at_block(p, from, s, &splat, sure, block))
      pass_block(p, from, s, &splat, block, SPLAT_SPECIAL, &p->n_covered);
}

CONIC_INLINE void end_pass(const pass *p, int has_special, conic_band *band) {
  memcpy(band->n_kept, p->n_kept, sizeof band->n_kept);
  memcpy(band->not_kept, p->not_kept, sizeof band->not_kept);
  band->has_special = has_special;
  band->n_fragments += p->n_fragments;
}

/* Rays and what has clip lines, of kernels that have a profile. Ellipses get theirs once it is known what is seen. */
static __attribute__((noinline)) void pass_profiled(pass *p, const sources *from, const sites *s, size_t i) {
  pass_splat(p, from, s, i, SPLAT_PROFILED, &p->n_covered);
}

static void visibility(conic_band *band) {
  enum { LOOK_EVERY = 32, COUNTABLE = 1 << 20 }; /* so few splats that no lane's count overflows */
  const sources from = sources_of(band);
  const int is_profiled = band->view->profile.table != NULL, is_crowd = from.n > CONIC_KEPT_SPLATS && !is_profiled;
  crowd c = {0, 0.0f, 0, 0.0f};
  pass p;
  int has_special = 0;
  sites s;
  find_sites(band, &s);
  begin_pass(band, &p);
  for (size_t begin = 0; begin < from.n; begin += COUNTABLE) {
    const size_t end = from.n - begin < COUNTABLE ? from.n : begin + COUNTABLE;
    index_lanes count = lanes_of_index(0);
    for (size_t i = begin; i < end; i++) {
      prefetch_splat(&from, i);
      const conic_footprint *footprint = &from.footprints[from.indices[i]];
      const int is_ellipse = footprint->s3 > 0.0f; /* without clip lines */
      if (is_crowd && has_special && i % LOOK_EVERY == 0)
        look_at_crowd(band, p.not_kept, &c);
      /* Neither is 0 or below: in one comparison. */
      const float lesser = footprint->s3 < footprint->nearness ? footprint->s3 : footprint->nearness;
      if (__builtin_expect(lesser > 0.0f, 1)) {
        pass_splat(&p, &from, &s, i, SPLAT_USUAL, &count);
        continue;
      }
      if (is_ellipse)
        pass_splat(&p, &from, &s, i, SPLAT_WIDE, &count);
      else {
        prefetch_ray(&from, from.indices[i + 12 < from.n ? i + 12 : i]);
        if (is_profiled)
          pass_profiled(&p, &from, &s, i);
        else if (is_crowd && is_plain_ray(footprint))
          pass_ray_in_crowd(&p, &from, &s, band, &c, i);
        else
          pass_splat(&p, &from, &s, i, SPLAT_SPECIAL, &count);
        has_special = 1;
      }
    }
    take_counts(&p, count);
  }
  end_pass(&p, has_special, band);
  if (is_profiled)
    weigh_ellipses(band, &from, &s);
}

/* The sums of one part, in registers. */
typedef struct part_sums {
  lanes weight, color[3], normal[3], heaviest_weight, nearest_iz;
  index_lanes heaviest, nearest, count;
} part_sums;

CONIC_INLINE void clear_sums(part_sums *sums) {
  sums->weight = sums->heaviest_weight = sums->nearest_iz = lanes_of(0.0f);
  for (int axis = 0; axis < 3; axis++)
    sums->color[axis] = sums->normal[axis] = lanes_of(0.0f);
  sums->heaviest = sums->nearest = sums->count = lanes_of_index(0);
}

/* Where `better` holds, `value` and `i_footprint` take the place of what is kept. */
CONIC_INLINE void keep_better(lanes *kept, index_lanes *whose, lanes_mask better, lanes value, uint32_t i_footprint) {
  *kept = lanes_select(better, value, *kept);
  *whose = lanes_select_indices(better, lanes_of_index(i_footprint), *whose);
}

/* Adds visible fragments: an invisible one adds 0, which changes no bit. Splats come in file order: sums keep it, and
 * the first of equals stays. */
CONIC_INLINE void blend(const conic_projected_surface *surface, uint32_t i_footprint, lanes weight, part_sums *to) {
  to->weight += weight;
  for (int axis = 0; axis < 3; axis++) {
    to->color[axis] += weight * surface->color[axis];
    to->normal[axis] += weight * surface->normal[axis];
  }
  lanes_mask heavier = lanes_less(to->heaviest_weight, weight);
  to->heaviest_weight = lanes_max(weight, to->heaviest_weight);
  to->heaviest = lanes_select_indices(heavier, lanes_of_index(i_footprint), to->heaviest);
}

/* Weights first, of some splats, and then their sums: where sums wait for weights, they fill the machine's window, and
 * it does not see the next weights. */
CONIC_INLINE void blend_kept(const sources *from, const conic_kept *kept, size_t n_kept, size_t at, int has_special,
                             kernel_kind kind, part_sums *to) {
  enum { AHEAD = 8, GROUP = 64 };
  lanes threshold = lanes_load(kept->threshold + at), weights[GROUP];
  uint32_t whose[GROUP];
  for (size_t first = 0; first < n_kept; first += GROUP) {
    size_t end = first + GROUP < n_kept ? first + GROUP : n_kept, n = 0;
    for (size_t i = first; i < end; i++) {
      uint32_t i_footprint = kept->footprint[i];
      __builtin_prefetch(&from->surfaces[kept->footprint[i + AHEAD < n_kept ? i + AHEAD : i]]);
      lanes_mask visible = lanes_at_least(lanes_load(kept->fragments[i].seen_iz + at), threshold);
      if (!lanes_any(visible))
        continue;
      lanes scale = lanes_of(1.0f), q = lanes_load(kept->fragments[i].q + at);
      if (kind == KERNEL_PROFILE)
        scale = q;
      else if (__builtin_expect(has_special, 0) && !(from->footprints[i_footprint].s3 > 0.0f))
        scale = lanes_load(kept->scale[i] + at);
      weights[n] = weigh(from->view, from->surfaces[i_footprint].amplitude, q, scale, visible, kind);
      whose[n++] = i_footprint;
    }
    for (size_t i = 0; i < n; i++)
      blend(&from->surfaces[whose[i]], whose[i], weights[i], to);
  }
}

/* A ray's fragments, evaluated only where they are seen and its inverse depth is below `flat`. Returns whether one may
 * be visible. */
CONIC_INLINE int glance_at_ray(const sources *from, const conic_footprint *footprint, const splat_rows *rows, lanes x,
                               lanes threshold, float flat, fragments *f) {
  lanes dx = (x - rows->x) + rows->dx0;
  f->covered = ray_reaches(footprint, &from->rays[footprint->i_ray], dx, rows->dy, &f->plane_iz);
  f->iz = lanes_min(lanes_max(f->plane_iz, rows->iz_far), rows->iz_near);
  f->covered &= lanes_at_least(lanes_max(f->plane_iz, f->iz), threshold);
  if (!lanes_any(f->covered))
    return 0;
  f->q = lanes_of(0.0f);
  f->scale = lanes_of(1.0f);
  if (lanes_any(f->covered & lanes_less(f->plane_iz, lanes_of(flat))))
    ray_fragments(from->view, footprint, &from->rays[footprint->i_ray], NULL, dx, rows->dy, f);
  return 1;
}

CONIC_INLINE splat_kind kind_of_splat(const conic_footprint *footprint, kernel_kind kind) {
  return kind == KERNEL_PROFILE ? SPLAT_PROFILED : footprint->s3 > 0.0f ? SPLAT_USUAL : SPLAT_SPECIAL;
}

/* A fragment that was not kept is evaluated again. */
CONIC_INLINE void blend_again(const conic_band *band, const sources *from, const splat_rows *rows, lanes x,
                              lanes threshold, float flat, size_t i, kernel_kind kind, part_sums *to) {
  const uint32_t i_footprint = from->indices[i];
  const conic_footprint *footprint = &from->footprints[i_footprint];
  fragments f;
  if (flat < HUGE_VALF) {
    if (!glance_at_ray(from, footprint, rows, x, threshold, flat, &f))
      return;
  } else
    evaluate(from, footprint, rows, x, kind_of_splat(footprint, kind), &f);
  lanes_mask visible = f.covered & lanes_at_least(lanes_max(f.plane_iz, f.iz), threshold);
  if (!lanes_any(visible))
    return;
  blend(&from->surfaces[i_footprint], i_footprint, weigh(from->view, footprint->amplitude, f.q, f.scale, visible, kind),
        to);
  if (!band->keeps_indices)
    return;
  to->count = lanes_increment(visible, to->count);
  keep_better(&to->nearest_iz, &to->nearest, visible & lanes_less(to->nearest_iz, f.iz), f.iz, i_footprint);
}

/* The inverse depth from which on a plain ray's q and scale are known: infinite for what is no plain ray, and finite
 * but never reached by one whose are never. */
CONIC_INLINE float flat_in(const sources *from, const conic_footprint *footprint, const crowd_span *span,
                           kernel_kind kind) {
  if (!is_plain_ray(footprint) || kind == KERNEL_PROFILE)
    return HUGE_VALF;
  float flat = flat_iz(from->view, footprint, &from->rays[footprint->i_ray], span);
  return kind != KERNEL_OTHER && flat < FLT_MAX ? flat : FLT_MAX;
}

/* Whether all of the band hides the plain ray. */
CONIC_INLINE int band_hides(const crowd *c, const conic_footprint *footprint, const crowd_span *span) {
  const crowd_depths depths = depths_of(footprint, span);
  return is_plain_ray(footprint) && most_seen(footprint, &depths) < c->threshold;
}

/* The sums of a band's parts, in memory: what was not kept goes splat by splat, which fetches each once. */
typedef part_sums band_sums[CONIC_BAND_BLOCKS * CONIC_PARTS];

CONIC_INLINE void blend_rest(const conic_band *band, const sources *from, const sites *s, kernel_kind kind,
                             size_t first, band_sums to) {
  crowd c;
  look_at_crowd(band, band->not_kept, &c);
  for (size_t i = first; i < from->n; i++) {
    const uint32_t last = conic_word_last(from->words[i]);
    uint32_t block = conic_word_first(from->words[i]);
    while (block <= last && i < band->not_kept[block])
      block++;
    if (block > last)
      continue;
    const conic_footprint *footprint = &from->footprints[from->indices[i]];
    prefetch_splat(from, i);
    float flat = HUGE_VALF;
    if (__builtin_expect(is_plain_ray(footprint), 0)) {
      const crowd_span span = span_of(band, footprint);
      if (band_hides(&c, footprint, &span))
        continue;
      flat = flat_in(from, footprint, &span, kind);
    }
    const splat_rows rows = begin_splat(from, footprint, s->y, kind_of_splat(footprint, kind));
    for (; block <= last; block++)
      for (size_t part = 0; part < CONIC_PARTS && i >= band->not_kept[block]; part++) {
        size_t at = block * CONIC_PARTS + part;
        lanes threshold = lanes_load(band->kept[block].threshold + part * CONIC_LANES);
        blend_again(band, from, &rows, s->x[at], threshold, flat, i, kind, &to[at]);
      }
  }
}

CONIC_INLINE void store_sums(const part_sums *from, size_t at, conic_block_sums *to) {
  lanes_store(to->weight + at, from->weight);
  for (int axis = 0; axis < 3; axis++) {
    lanes_store(to->color[axis] + at, from->color[axis]);
    lanes_store(to->normal[axis] + at, from->normal[axis]);
  }
  lanes_store_indices(to->heaviest + at, from->heaviest);
  lanes_store_indices(to->nearest + at, from->nearest);
  lanes_store_indices(to->count + at, from->count);
}

CONIC_INLINE void finish_rest(conic_band *band, const sources *from, kernel_kind kind, size_t first, band_sums rest) {
  sites s;
  find_sites(band, &s);
  blend_rest(band, from, &s, kind, first, rest);
  for (int block = 0; block < band->n_blocks; block++)
    for (int part = 0; part < CONIC_PARTS && band->not_kept[block] < band->n; part++)
      store_sums(&rest[block * CONIC_PARTS + part], (size_t)part * CONIC_LANES, &band->sums[block]);
}

/* Where every block keeps all that covers it: the sums stay in registers. */
CONIC_INLINE void accumulate_kept(conic_band *band, const sources *from, kernel_kind kind) {
  for (int block = 0; block < band->n_blocks; block++)
    for (int part = 0; part < CONIC_PARTS && !conic_block_is_empty(band, block); part++) {
      size_t at = (size_t)part * CONIC_LANES;
      part_sums of_part;
      clear_sums(&of_part);
      blend_kept(from, &band->kept[block], band->n_kept[block], at, band->has_special, kind, &of_part);
      store_sums(&of_part, at, &band->sums[block]);
    }
}

CONIC_INLINE void accumulate_more(conic_band *band, const sources *from, size_t first, kernel_kind kind) {
  band_sums rest;
  for (int block = 0; block < band->n_blocks; block++)
    for (int part = 0; part < CONIC_PARTS && !conic_block_is_empty(band, block); part++) {
      size_t at = (size_t)part * CONIC_LANES;
      part_sums *of_part = &rest[block * CONIC_PARTS + part];
      clear_sums(of_part);
      blend_kept(from, &band->kept[block], band->n_kept[block], at, band->has_special, kind, of_part);
      if (band->not_kept[block] == band->n)
        store_sums(of_part, at, &band->sums[block]);
    }
  finish_rest(band, from, kind, first, rest);
}

CONIC_INLINE void accumulate_with(conic_band *band, kernel_kind kind) {
  const sources from = sources_of(band);
  size_t first = band->n;
  for (int block = 0; block < band->n_blocks; block++)
    first = band->not_kept[block] < first ? band->not_kept[block] : first;
  if (__builtin_expect(first < band->n, 0))
    accumulate_more(band, &from, first, kind);
  else
    accumulate_kept(band, &from, kind);
}

static void accumulate(conic_band *band) {
  switch (kind_of_view(band->view)) {
  case KERNEL_NARROW_GAUSS:
    accumulate_with(band, KERNEL_NARROW_GAUSS);
    break;
  case KERNEL_GAUSS:
    accumulate_with(band, KERNEL_GAUSS);
    break;
  case KERNEL_PROFILE:
    accumulate_with(band, KERNEL_PROFILE);
    break;
  case KERNEL_OTHER:
    accumulate_with(band, KERNEL_OTHER);
    break;
  }
}
