/* Projection in lanes: conic_project_one (raster/project/project_splats.c) for a group of splats at once, with the same
 * operations in the same order. What is not usual (near the camera, drawn by ray, not finite) is left to
 * conic_project_one itself. Included by raster_loops_body.h. */
#include <math.h>

#include "core/lanes/lanes_double.h"
#include "raster/project/projected.h"
#include "raster/view/method.h"

/* So many splats are looked at at a time for whether they face away, and what is left of them is packed. */
enum { BATCH = 512 };

/* The columns of a splat set that set-up reads. */
enum { POSITION, TANGENT_U = 3, TANGENT_V = 6, COLOR = 9, OPACITY = 12, N_COLUMNS };

/* A batch begins with what the one before left over, because it was too few for a group. Behind it come this one's
 * splats that may be drawn, and room for the last group's spare lanes. */
enum { BATCH_ROOM = BATCH + 2 * CONIC_LANES };

typedef struct batch {
  float columns[N_COLUMNS][BATCH_ROOM];
  uint32_t index[BATCH_ROOM];
  size_t n;
} batch;

CONIC_INLINE lanes batch_column(const batch *from, int column, size_t at) {
  return lanes_load(from->columns[column] + at);
}

CONIC_INLINE index_lanes batch_index(const batch *from, size_t at) {
  return lanes_load_indices(from->index + at);
}

#include "raster/project/setup_body.h"

/* Appends the rays' records and lets their footprints point to them. */
static __attribute__((noinline)) void write_rays(records *r, unsigned by_ray, conic_projected *projected,
                                                 conic_chunk *chunk) {
  float stored[CONIC_LANES + 1][16];
  lanes fields[16] = {lanes_of(0.0f)};
  size_t at = chunk->first_ray + chunk->n_rays;
  unsigned by_laplace = lanes_bits(lanes_less(lanes_of(0.0f), r->footprint[5])) & by_ray;
  chunk->n_laplaces += (size_t)__builtin_popcount(by_laplace);
  index_lanes i_ray = (index_lanes)r->footprint[4];
  for (int lane = 0; by_ray >> lane; lane++)
    if (by_ray >> lane & 1)
      i_ray[lane] = (uint32_t)(chunk->first_ray + chunk->n_rays++);
  r->footprint[4] = (lanes)i_ray;
  for (int field = 0; field < 12; field++)
    fields[field] = r->ray[field];
  lanes_store_records(fields, 16, (1u << CONIC_LANES) - 1, stored[0]);
  for (; by_ray; by_ray &= by_ray - 1, at++)
    memcpy(&projected->rays[at], stored[__builtin_ctz(by_ray)], sizeof *projected->rays);
}

/* Appends the drawn lanes' records. */
CONIC_INLINE void write_records(const group_screen *s, records *r, unsigned drawn, conic_projected *projected,
                                conic_chunk *chunk) {
  size_t at = chunk->first + chunk->n_drawn;
  if (__builtin_expect(lanes_any(s->by_ray), 0))
    write_rays(r, lanes_bits(s->by_ray) & drawn, projected, chunk);
  lanes_append_pairs((uint32_t *)(void *)&projected->boxes[at], lanes_mask_of(drawn),
                     (index_lanes)(s->begin[0] | s->end[0] << 16), (index_lanes)(s->begin[1] | s->end[1] << 16));
  lanes_store_records(r->footprint, 16, drawn, (float *)(void *)&projected->footprints[at]);
  lanes_store_records(r->surface, 8, drawn, (float *)(void *)&projected->surfaces[at]);
  chunk->n_drawn += (size_t)__builtin_popcount(drawn);
}

/* A group with lanes that are not usual: lane by lane, in order. */
static __attribute__((noinline)) void take_mixed(const conic_view *view, const conic_splats *splats,
                                                 const uint32_t *index, const group_screen *s, records *r,
                                                 unsigned usual, unsigned unusual, conic_projected *projected,
                                                 conic_chunk *chunk) {
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    if (usual >> lane & 1)
      write_records(s, r, 1u << lane, projected, chunk);
    if (unusual >> lane & 1)
      conic_project_one(view, splats, index[lane], projected, chunk);
  }
}

CONIC_INLINE void project_group(const conic_view *view, const conic_splats *splats, const batch *from, size_t at,
                                conic_projected *projected, conic_chunk *chunk) {
  group_screen s;
  records r;
  group_verdict verdict = set_up_group(view, from, at, &s, &r);
  unsigned all = (1u << CONIC_LANES) - 1, valid = from->n - at < CONIC_LANES ? (1u << (from->n - at)) - 1 : all;
  unsigned usual = lanes_bits(verdict.usual) & valid, unusual = lanes_bits(verdict.unusual) & valid;
  unsigned skipped = lanes_bits(verdict.skipped) & valid;
  unsigned by_ray = lanes_bits(s.by_ray) & valid,
           fallback = (conic_method_has_rays(view->method) ? 0 : by_ray) |
                      (conic_method_has_ellipses(view->method) ? 0 : usual & ~by_ray);
  chunk->n_fallback += (size_t)__builtin_popcount(fallback);
  chunk->n_skipped += (size_t)__builtin_popcount(skipped);
  chunk->n_culled += (size_t)__builtin_popcount(valid & ~(usual | unusual | skipped));
  if (__builtin_expect(unusual != 0, 0))
    take_mixed(view, splats, from->index + at, &s, &r, usual, unusual, projected, chunk);
  else
    write_records(&s, &r, usual, projected, chunk);
}

#include "raster/project/pack_body.h"

static void project(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                    conic_projected *projected, conic_chunk *chunk) {
  batch packed;
  begin_batches(&packed);
  for (size_t first = begin; first < end; first += BATCH) {
    size_t n = end - first < BATCH ? end - first : BATCH, n_before = packed.n;
    pack_batch(view, splats, first, n, projected, &packed);
    chunk->n_culled += n - (packed.n - n_before);
    size_t n_due = first + n < end ? packed.n - packed.n % CONIC_LANES : fill_last_group(&packed);
    for (size_t i = 0; i < n_due; i += CONIC_LANES)
      project_group(view, splats, &packed, i, projected, chunk);
    keep_rest(&packed, n_due);
  }
}
