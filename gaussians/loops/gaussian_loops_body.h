/* Compositing in lanes: block by block, in each the Gaussians of the list that may cover it, its pixels in registers.
 * Includes what fills the table. C and OpenCL C share this text, and what it includes. */
#include "gaussians/loops/gaussian_rays_lanes.h"

typedef struct gaussian_batch {
  gaussian_record records[BATCH];
  uint32_t blocks[BATCH]; /* that each may cover, as bits */
  uint32_t footprints[BATCH];
  size_t n;
  uint32_t listed[BATCH + CONIC_LANES];                       /* those of one block */
  unsigned goes_on[CONIC_GAUSSIAN_TILE_PIXELS / CONIC_LANES]; /* which pixels of each vector */
} gaussian_batch;

static void take_batch(const conic_gaussian_list *list, const conic_gaussian_tile *tile, size_t first,
                       gaussian_batch *b) {
  b->n = 0;
  for (size_t i = first; i < list->n && i < first + BATCH; i++) {
    const CONIC_STORED conic_gaussian_footprint *f = footprint_of_entry(list, i);
    gaussian_record *r = &b->records[b->n];
    *r = record_of(tile, f);
    b->blocks[b->n] = blocks_of_box(tile, f) & blocks_of_ellipse(r, f->half_reach);
    b->footprints[b->n] = list->entries[i];
    b->n += b->blocks[b->n] != 0;
  }
  memset(b->blocks + b->n, 0, (BATCH - b->n) * sizeof *b->blocks);
}

CONIC_INLINE lanes half_q_of_ellipse(const gaussian_record *r, places at) {
  lanes dx = (at.column + r->x) + r->dx, dy = (at.row + r->y) + r->dy;
  return 0.5f * (r->form[0] * dx * dx + r->form[2] * dy * dy) + r->form[1] * dx * dy;
}

/* The lesser of the plane's and the dot's; a solid has none. */
CONIC_INLINE meeting_lanes meet_disc(const gaussian_record *r, const CONIC_STORED conic_gaussian_ray *ray, places at,
                                     int is_solid) {
  lanes x = at.column + r->x, y = at.row + r->y, dx = x + r->dx, dy = y + r->dy;
  meeting_lanes m = meet_lanes(ray, x, y);
  if (!is_solid)
    m.half_q = lanes_min(m.half_q, dx * dx + dy * dy);
  return m;
}

CONIC_INLINE response response_of(const gaussian_record *r) {
  return (response){.z = lanes_of(r->z),
                    .color = {lanes_of(r->color[0]), lanes_of(r->color[1]), lanes_of(r->color[2])}};
}

CONIC_INLINE lanes_mask cover(const scene *s, const gaussian_record *r, places at, lanes half_q, lanes alpha) {
  return within_box(r, at) & lanes_at_least(half_q, lanes_of(0.0f)) & lanes_at_least(alpha, s->least);
}

CONIC_INLINE response respond_as_disc(const scene *s, const gaussian_record *r, uint32_t footprint, places at) {
  const float near_z = s->list->rules->disc_near;
  const int is_solid = s->list->rules->shape == CONIC_SHAPE_SOLID;
  const meeting_lanes m = meet_disc(r, &s->list->rays[footprint], at, is_solid);
  response to = response_of(r);
  to.alpha = lanes_alpha(s, r, m.half_q);
  to.covered = cover(s, r, at, m.half_q, to.alpha);
  if (is_solid)
    to.covered = to.covered & lanes_less(lanes_of(0.0f), m.z);
  if (near_z > 0.0f) {
    to.covered = to.covered & lanes_at_least(m.z, lanes_of(near_z));
    to.z = m.z;
  }
  return to;
}

/* Of n ≤ 2 ellipses in step. */
CONIC_INLINE void respond_as_ellipses(const scene *s, int n, const gaussian_record *const *r, places at, response *to) {
  lanes half_q[2], below[2], falls[2];
  for (int i = 0; i < n; i++) {
    half_q[i] = half_q_of_ellipse(r[i], at);
    below[i] = -half_q[i];
  }
  lanes_exp_negatives(n, below, falls);
  for (int i = 0; i < n; i++) {
    to[i] = response_of(r[i]);
    to[i].alpha = lanes_alpha_of_fall(s, r[i], falls[i]);
    to[i].covered = cover(s, r[i], at, half_q[i], to[i].alpha) & lanes_at_least(s->greatest, half_q[i]);
  }
}

/* The first n listed, two by two; where nothing is wanted but what each has in its record, and all is before surfaces.
 * Returns how many it went through. */
CONIC_INLINE size_t composite_pairs(const scene *s, const gaussian_batch *b, size_t n, places at, pixels *p,
                                    int wants) {
  size_t i = 0;
  for (; i + 1 < n && lanes_any(p->goes_on); i += 2) {
    const gaussian_record *const r[2] = {&b->records[b->listed[i]], &b->records[b->listed[i + 1]]};
    response to[2];
    respond_as_ellipses(s, 2, r, at, to);
    composite_response(s, &to[0], p, wants);
    composite_response(s, &to[1], p, wants);
  }
  return i;
}

CONIC_INLINE void composite_vector(const scene *s, gaussian_batch *b, size_t n_listed, size_t pixel,
                                   conic_gaussian_shape shape, int wants) {
  const conic_gaussian_list *list = s->list;
  const places at = places_at(pixel);
  const int has_pairs =
      shape == CONIC_SHAPE_ELLIPSE && wants != CONIC_GAUSSIAN_ALL && !conic_gaussian_list_surface(list, 0);
  pixels p = take_pixels(s, b->goes_on[pixel / CONIC_LANES], pixel, wants);
  for (size_t i = has_pairs ? composite_pairs(s, b, n_listed, at, &p, wants) : 0; i < n_listed && lanes_any(p.goes_on);
       i++) {
    const gaussian_record *r = &b->records[b->listed[i]];
    const uint32_t footprint = b->footprints[b->listed[i]];
    response to;
    if (shape == CONIC_SHAPE_DISC)
      to = respond_as_disc(s, r, footprint, at);
    else
      respond_as_ellipses(s, 1, &r, at, &to);
    if (!lanes_any(to.covered))
      continue;
    if (wants == CONIC_GAUSSIAN_ALL)
      add_planes_of_footprint(list, footprint, &to);
    composite_lanes(s, &to, &p, wants);
  }
  put_pixels(s->tile, &p, pixel, wants);
  b->goes_on[pixel / CONIC_LANES] = lanes_bits(p.goes_on);
}

/* Returns 0 where compositing has ended at all pixels. */
CONIC_INLINE int composite_batch(const scene *s, gaussian_batch *b, conic_gaussian_shape shape, int wants) {
  unsigned going = 0;
  for (int block = 0; block < CONIC_GAUSSIAN_BLOCKS; block++) {
    size_t n_listed = list_block(b->blocks, b->n, block, b->listed);
    for (size_t pixel = (size_t)block * CONIC_GAUSSIAN_BLOCK_PIXELS;
         pixel < (size_t)(block + 1) * CONIC_GAUSSIAN_BLOCK_PIXELS; pixel += CONIC_LANES) {
      if (b->goes_on[pixel / CONIC_LANES])
        composite_vector(s, b, n_listed, pixel, shape, wants);
      going |= b->goes_on[pixel / CONIC_LANES];
    }
  }
  return going != 0;
}

CONIC_INLINE void composite_in_order(const conic_gaussian_list *list, conic_gaussian_tile *tile,
                                     conic_gaussian_shape shape, int wants) {
  const scene s = scene_of(list, tile);
  gaussian_batch b;
  for (size_t i = 0; i < CONIC_GAUSSIAN_TILE_PIXELS / CONIC_LANES; i++)
    b.goes_on[i] = (1u << CONIC_LANES) - 1;
  for (size_t first = 0; first < list->n; first += BATCH) {
    take_batch(list, tile, first, &b);
    if (!composite_batch(&s, &b, shape, wants))
      return;
  }
}

static void composite_ellipses_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  CONIC_BY_WANTS(composite_in_order, list, tile, CONIC_SHAPE_ELLIPSE);
}

static void composite_discs_in_lanes(const conic_gaussian_list *list, conic_gaussian_tile *tile) {
  CONIC_BY_WANTS(composite_in_order, list, tile, CONIC_SHAPE_DISC);
}

#ifndef CONIC_ON_DEVICE
#include "gaussians/loops/gaussian_ellipses_lanes.h"

CONIC_FILL_LOOPS(conic_gaussian_loops) {
  loops->set_up = set_up_ellipses_in_lanes;
  loops->composite[CONIC_SHAPE_ELLIPSE] = composite_ellipses_in_lanes;
  loops->composite[CONIC_SHAPE_RAY] = composite_rays_in_lanes;
  loops->composite[CONIC_SHAPE_DISC] = loops->composite[CONIC_SHAPE_SOLID] = composite_discs_in_lanes;
  loops->composite[CONIC_SHAPE_FILTERED] = composite_filtered_in_lanes;
  loops->composite[CONIC_SHAPE_SIGHT] = composite_sights_in_lanes;
}
#endif
