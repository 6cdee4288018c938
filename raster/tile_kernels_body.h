/* The body of a table of tile kernels, in lanes; included by one file an instruction set, which defines TABLE and NAME.
 */
#include "raster/coverage.h"
#include "raster/lanes.h"
#include "raster/tile_kernels.h"

/* One splat's pixels in one block, covered or not. */
typedef struct fragments {
  lanes_mask covered;
  lanes q;
  lanes iz, plane_iz; /* as in conic_fragment */
  lanes scale;
} fragments;

/* Does something with the fragments of a block whose first pixel is at `at` in the tile's planes. */
typedef void visit_block(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                         const fragments *block);

/* The part of a footprint's box that lies in the tile. */
typedef struct window {
  int x_begin, x_end, y_begin, y_end;
} window;

CONIC_INLINE window window_of(const conic_tile *tile, const conic_box *box) {
  window w;
  w.x_begin = box->x_begin > tile->x_begin ? box->x_begin : tile->x_begin;
  w.x_end = box->x_end < tile->x_end ? box->x_end : tile->x_end;
  w.y_begin = box->y_begin > tile->y_begin ? box->y_begin : tile->y_begin;
  w.y_end = box->y_end < tile->y_end ? box->y_end : tile->y_end;
  return w;
}

/* Four rows of a footprint: what of its evaluation does not depend on x. */
typedef struct band {
  lanes_mask inside; /* rows within the window */
  lanes dy;
  lanes q_offset, q_rest, iz_offset, plane_offset;
} band;

CONIC_INLINE band begin_band(const conic_footprint *footprint, window w, int y) {
  band b;
  int_lanes rows = lanes_rows() + y;
  b.inside = lanes_less_int(rows, lanes_of_int(w.y_end)) & lanes_less_int(lanes_of_int(w.y_begin - 1), rows);
  b.dy = __builtin_convertvector(rows - footprint->y, lanes) + footprint->dy0;
  lanes minor = footprint->s3 * b.dy;
  b.q_offset = footprint->s2 * b.dy;
  b.q_rest = minor * minor;
  b.iz_offset = footprint->iz0 + footprint->iz_dy * b.dy;
  b.plane_offset = footprint->iz0 + footprint->plane_dy * b.dy;
  return b;
}

/* Narrows the window to the columns where one of the band's rows may have q < support; a hair more, since every pixel
 * is tested. Worth its cost for wide footprints only. */
CONIC_INLINE void narrow(const conic_footprint *footprint, const band *b, float support, window w, int *begin,
                         int *end) {
  float inverse = 1.0f / footprint->s1, low = 1e30f, high = -1e30f;
  lanes half = lanes_sqrt(lanes_max(support - b->q_rest, lanes_of(0.0f))) * inverse, middle = -b->q_offset * inverse;
  for (int row = 0; row < CONIC_BLOCK_ROWS; row++) {
    if (!(b->q_rest[row] < support))
      continue;
    low = middle[row] - half[row] < low ? middle[row] - half[row] : low;
    high = middle[row] + half[row] > high ? middle[row] + half[row] : high;
  }
  float slack = 0.05f + 2e-5f * (fabsf(low) + fabsf(high));
  float from = (float)(w.x_begin - footprint->x), to = (float)(w.x_end - 1 - footprint->x);
  low = low - slack - footprint->dx0;
  high = high + slack - footprint->dx0;
  low = low > from ? low : from;
  high = high < to ? high : to;
  *begin = *end = w.x_begin;
  if (low <= high) {
    int first = footprint->x + (int)low, last = footprint->x + (int)high;
    *begin = first > w.x_begin ? first : w.x_begin; /* far from the reference, a float skips integers */
    *end = last < w.x_end - 1 ? last + 1 : w.x_end;
  }
}

CONIC_INLINE size_t place_of(const conic_tile *tile, int x, int y) {
  return ((size_t)((y - tile->y_begin) / CONIC_BLOCK_ROWS) * (size_t)tile->stride + (size_t)(x - tile->x_begin)) *
         CONIC_BLOCK_ROWS;
}

/* The same operations, lane by lane, as conic_row_q, conic_row_iz and the plane's depth of coverage.h. */
CONIC_INLINE void walk_ellipse(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, window w,
                               visit_block *visit) {
  enum { WIDE = 16 };
  float support = tile->view->support;
  lanes far_iz = lanes_of(footprint->iz_far), near_iz = lanes_of(footprint->iz_near);
  int first_row = w.y_begin - (w.y_begin - tile->y_begin) % CONIC_BLOCK_ROWS;
  fragments f = {.scale = lanes_of(1.0f)};
  for (int y = first_row; y < w.y_end; y += CONIC_BLOCK_ROWS) {
    int begin = w.x_begin, end = w.x_end;
    band b = begin_band(footprint, w, y);
    if (end - begin > WIDE)
      narrow(footprint, &b, support, w, &begin, &end);
    size_t at = place_of(tile, begin, y);
    int_lanes columns = lanes_columns() + begin;
    for (int x = begin; x < end; x += CONIC_BLOCK_COLUMNS) {
      lanes dx = __builtin_convertvector(columns - footprint->x, lanes) + footprint->dx0;
      lanes major = footprint->s1 * dx + b.q_offset;
      f.q = major * major + b.q_rest;
      f.covered = lanes_less(f.q, lanes_of(support)) & lanes_less_int(columns, lanes_of_int(w.x_end)) & b.inside;
      lanes iz = lanes_max(b.iz_offset + footprint->iz_dx * dx, far_iz);
      f.iz = lanes_min(iz, near_iz);
      f.plane_iz = b.plane_offset + footprint->plane_dx * dx;
      visit(tile, i_footprint, footprint, at, &f);
      columns += CONIC_BLOCK_COLUMNS;
      at += CONIC_LANES;
    }
  }
}

/* conic_ray_fragment of coverage.h, lane by lane. Lanes that it leaves early may hold anything: they are masked. */
CONIC_INLINE void ray_block(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray, lanes dx,
                            lanes dy, fragments *f) {
  lanes iz = (footprint->iz0 + footprint->iz_dy * dy) + footprint->iz_dx * dx;
  f->covered = lanes_less(lanes_of(0.0f), iz) & lanes_at_least(iz, lanes_of(ray->iz_low)) &
               lanes_at_least(lanes_of(ray->iz_high), iz);
  lanes r = 1.0f / iz;
  lanes u = ((ray->u0 + ray->u_dy * dy) + ray->u_dx * dx) * r;
  lanes v = ((ray->v0 + ray->v_dy * dy) + ray->v_dx * dx) * r;
  lanes u_x = (ray->u_dx - u * footprint->iz_dx) * r, u_y = (ray->u_dy - u * footprint->iz_dy) * r;
  lanes v_x = (ray->v_dx - v * footprint->iz_dx) * r, v_y = (ray->v_dy - v * footprint->iz_dy) * r;
  float h = view->prefilter;
  lanes s_uu = 1.0f + h * (u_x * u_x + u_y * u_y);
  lanes s_vv = 1.0f + h * (v_x * v_x + v_y * v_y);
  lanes s_uv = h * (u_x * v_x + u_y * v_y);
  lanes area = u_x * v_y - u_y * v_x;
  lanes determinant = (s_uu + s_vv - 1.0f) + (h * area) * (h * area);
  lanes along = u * s_uv - v * s_uu;
  f->q = u * u / s_uu + along * along / (s_uu * determinant);
  f->covered &= lanes_less(f->q, lanes_of(view->support));
  f->iz = lanes_min(lanes_max(iz, lanes_of(footprint->iz_far)), lanes_of(footprint->iz_near));
  f->plane_iz = iz;
  f->scale = 1.0f / lanes_sqrt(determinant);
}

CONIC_INLINE void walk_ray(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, window w,
                           visit_block *visit) {
  const conic_ray *ray = &tile->projected->rays[footprint->i_ray];
  int first_row = w.y_begin - (w.y_begin - tile->y_begin) % CONIC_BLOCK_ROWS;
  for (int y = first_row; y < w.y_end; y += CONIC_BLOCK_ROWS) {
    fragments f;
    band b = begin_band(footprint, w, y);
    size_t at = place_of(tile, w.x_begin, y);
    int_lanes columns = lanes_columns() + w.x_begin;
    for (int x = w.x_begin; x < w.x_end; x += CONIC_BLOCK_COLUMNS) {
      lanes dx = __builtin_convertvector(columns - footprint->x, lanes) + footprint->dx0;
      ray_block(tile->view, footprint, ray, dx, b.dy, &f);
      f.covered &= lanes_less_int(columns, lanes_of_int(w.x_end)) & b.inside;
      if (lanes_any(f.covered))
        visit(tile, i_footprint, footprint, at, &f);
      columns += CONIC_BLOCK_COLUMNS;
      at += CONIC_LANES;
    }
  }
}

CONIC_INLINE void walk_tile(conic_tile *tile, visit_block *visit) {
  enum { AHEAD = 16 };
  const conic_footprint *footprints = tile->projected->footprints;
  for (size_t i = 0; i < tile->n_references; i++) {
    uint32_t i_footprint = tile->references[i];
    const conic_footprint *footprint = &footprints[i_footprint];
    if (i + AHEAD < tile->n_references) {
      uint32_t i_later = tile->references[i + AHEAD];
      __builtin_prefetch(&footprints[i_later]);
      __builtin_prefetch(&tile->projected->boxes[i_later]);
      __builtin_prefetch(&tile->projected->surfaces[i_later]);
    }
    window w = window_of(tile, &tile->projected->boxes[i_footprint]);
    if (footprint->s3 != 0.0f)
      walk_ellipse(tile, i_footprint, footprint, w, visit);
    else
      walk_ray(tile, i_footprint, footprint, w, visit);
  }
}

CONIC_INLINE void raise_threshold(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                                  const fragments *f) {
  float *to = &tile->planes.threshold[at];
  (void)i_footprint;
  tile->n_fragments += lanes_count(f->covered);
  lanes offset_iz = footprint->nearness * lanes_min(f->plane_iz, f->iz), threshold = lanes_load(to);
  lanes_store(to, lanes_select(f->covered & lanes_less(threshold, offset_iz), offset_iz, threshold));
}

/* Where `better` holds, `value` and `i_footprint` take the place of what is kept. */
CONIC_INLINE void keep_better(float *kept, uint32_t *whose, lanes_mask better, lanes value, lanes old,
                              uint32_t i_footprint) {
  lanes_store(kept, lanes_select(better, value, old));
  lanes_store_indices(whose, lanes_select_indices(better, lanes_of_index(i_footprint), lanes_load_indices(whose)));
}

/* Splats come in file order, so that the first of equals stays. */
CONIC_INLINE void keep_nearest(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                               const fragments *f) {
  lanes nearest_iz = lanes_load(&tile->planes.nearest_iz[at]);
  (void)footprint;
  tile->n_fragments += lanes_count(f->covered);
  keep_better(&tile->planes.nearest_iz[at], &tile->planes.nearest[at], f->covered & lanes_less(nearest_iz, f->iz),
              f->iz, nearest_iz, i_footprint);
}

/* conic_final_weight in every lane; 0 in those that are not visible. */
CONIC_INLINE lanes weigh(const conic_tile *tile, const conic_footprint *footprint, const fragments *f,
                         lanes_mask visible, int is_gauss) {
  lanes kernel;
  if (is_gauss)
    kernel = lanes_exp_negative(-0.5f * f->q);
  else
    for (int lane = 0; lane < CONIC_LANES; lane++) { /* beyond the support, a kernel need not have a value */
      float q = f->q[lane] < tile->view->support ? f->q[lane] : 0.0f;
      kernel[lane] = conic_kernel_value(&tile->view->kernel, q);
    }
  lanes weight = (footprint->amplitude * f->scale) * kernel;
  return lanes_keep(visible, lanes_max(weight, lanes_of(CONIC_LEAST_WEIGHT)));
}

CONIC_INLINE void add_to(float *sum, lanes term) {
  lanes_store(sum, lanes_load(sum) + term);
}

/* Which kernel, and whether the planes are kept that only the image's count and id need. */
typedef struct blending {
  int is_gauss, keeps_indices;
} blending;

/* Adds the visible fragments to the pixels' sums: an invisible one adds 0, which changes no bit. Splats come in file
 * order: sums keep it, and the first of equals stays. */
CONIC_INLINE void blend(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at,
                        const fragments *f, blending how) {
  conic_tile_planes *planes = &tile->planes;
  lanes seen_iz = lanes_max(f->plane_iz, f->iz);
  lanes_mask visible = f->covered & lanes_at_least(seen_iz, lanes_load(&planes->threshold[at]));
  if (!lanes_any(visible))
    return;
  const conic_surface *surface = &tile->projected->surfaces[i_footprint];
  lanes weight = weigh(tile, footprint, f, visible, how.is_gauss);
  add_to(&planes->weight[at], weight);
  for (int axis = 0; axis < 3; axis++) {
    add_to(&planes->color[axis][at], weight * surface->color[axis]);
    add_to(&planes->normal[axis][at], weight * surface->normal[axis]);
  }
  lanes heaviest = lanes_load(&planes->heaviest_weight[at]);
  keep_better(&planes->heaviest_weight[at], &planes->heaviest[at], lanes_less(heaviest, weight), weight, heaviest,
              i_footprint);
  if (!how.keeps_indices)
    return;
  lanes nearest = lanes_load(&planes->nearest_iz[at]);
  lanes_store_indices(&planes->count[at], lanes_increment(visible, lanes_load_indices(&planes->count[at])));
  keep_better(&planes->nearest_iz[at], &planes->nearest[at], visible & lanes_less(nearest, f->iz), f->iz, nearest,
              i_footprint);
}

#define DEFINE_BLEND(NAME_OF_BLEND, ...)                                                                               \
  CONIC_INLINE void NAME_OF_BLEND(conic_tile *tile, uint32_t i_footprint, const conic_footprint *footprint, size_t at, \
                                  const fragments *f) {                                                                \
    blend(tile, i_footprint, footprint, at, f, (blending){__VA_ARGS__});                                               \
  }

DEFINE_BLEND(blend_gauss, .is_gauss = 1)
DEFINE_BLEND(blend_gauss_indices, .is_gauss = 1, .keeps_indices = 1)
DEFINE_BLEND(blend_other_indices, .keeps_indices = 1)

static void visibility(conic_tile *tile) {
  walk_tile(tile, raise_threshold);
}

static void nearest(conic_tile *tile) {
  walk_tile(tile, keep_nearest);
}

static void accumulate(conic_tile *tile) {
  if (tile->view->kernel.type != CONIC_KERNEL_GAUSS)
    walk_tile(tile, blend_other_indices);
  else if (tile->keeps_indices)
    walk_tile(tile, blend_gauss_indices);
  else
    walk_tile(tile, blend_gauss);
}

#include "raster/project_body.h"
#include "raster/resolve_body.h"

const conic_tile_kernels TABLE = {NAME, project, visibility, nearest, accumulate, resolve};
