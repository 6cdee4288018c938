/* raster/project/laplace.h lane by lane, with the same operations in the same order. Included by raster_loops_body.h.
 */
#include "raster/project/laplace.h"

typedef struct spots {
  lanes iz, r, u, v;
} spots;

CONIC_INLINE spots spots_at(const conic_footprint *footprint, const conic_ray *ray, lanes dx, lanes dy) {
  spots s;
  s.iz = (footprint->iz0 + footprint->iz_dy * dy) + footprint->iz_dx * dx;
  s.r = 1.0f / s.iz;
  s.u = (ray->u_dx * dx + ray->u_dy * dy) * s.r;
  s.v = (ray->v_dx * dx + ray->v_dy * dy) * s.r;
  return s;
}

CONIC_INLINE lanes_mask spots_are_within(const spots *s, float limit) {
  return lanes_less(lanes_of(0.0f), s->iz) & lanes_at_least(lanes_of(limit), s->u * s->u + s->v * s->v);
}

CONIC_INLINE spots select_spots(lanes_mask mask, const spots *yes, const spots *no) {
  return (spots){lanes_select(mask, yes->iz, no->iz), lanes_select(mask, yes->r, no->r),
                 lanes_select(mask, yes->u, no->u), lanes_select(mask, yes->v, no->v)};
}

typedef struct spreads {
  lanes u_x, u_y, v_x, v_y, area;
  lanes xx, yy;
  lanes uu, uv, vv, determinant;
} spreads;

CONIC_INLINE spreads spreads_at(const conic_footprint *footprint, const conic_ray *ray, const spots *at, float h) {
  spreads s;
  s.u_x = (ray->u_dx - at->u * footprint->iz_dx) * at->r;
  s.u_y = (ray->u_dy - at->u * footprint->iz_dy) * at->r;
  s.v_x = (ray->v_dx - at->v * footprint->iz_dx) * at->r;
  s.v_y = (ray->v_dy - at->v * footprint->iz_dy) * at->r;
  s.area = s.u_x * s.v_y - s.u_y * s.v_x;
  s.xx = h * (s.u_x * s.u_x + s.u_y * s.u_y);
  s.yy = h * (s.v_x * s.v_x + s.v_y * s.v_y);
  s.uu = 1.0f + s.xx;
  s.vv = 1.0f + s.yy;
  s.uv = h * (s.u_x * s.v_x + s.u_y * s.v_y);
  s.determinant = (s.uu + s.vv - 1.0f) + (h * s.area) * (h * s.area);
  return s;
}

CONIC_INLINE lanes curved_determinants(const conic_footprint *footprint, const spots *at, const spreads *s, float h) {
  lanes g_x = footprint->iz_dx * at->r, g_y = footprint->iz_dy * at->r;
  lanes a_x = at->u * s->u_x + at->v * s->v_x, a_y = at->u * s->u_y + at->v * s->v_y, across = a_x * g_y - a_y * g_x;
  lanes turned = g_x * (s->v_y * at->u - s->u_y * at->v) + g_y * (s->u_x * at->v - s->v_x * at->u);
  lanes curved =
      (s->determinant - (2.0f * h) * (a_x * g_x + a_y * g_y)) - (h * h) * (2.0f * (s->area * turned) + across * across);
  return lanes_max(curved, CONIC_LAPLACE_LEAST * s->determinant);
}

/* Lanes that are not covered may hold anything. */
typedef struct laplaces {
  lanes_mask covered;
  lanes q, scale, iz, plane_iz, u, v;
  spreads spread;
} laplaces;

CONIC_INLINE laplaces laplaces_at(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                                  lanes dx, lanes dy) {
  float limit = CONIC_LAPLACE_REACH * (view->cutoff * view->cutoff), h = view->prefilter;
  lanes pull_x = ray->pull_xx * dx + ray->pull_xy * dy, pull_y = ray->pull_xy * dx + ray->pull_yy * dy;
  lanes support = lanes_of(view->support);
  laplaces result;
  spots here = spots_at(footprint, ray, dx, dy), pulled = spots_at(footprint, ray, dx - pull_x, dy - pull_y);
  lanes_mask is_pulled = spots_are_within(&pulled, limit);
  spots at = select_spots(is_pulled, &pulled, &here);
  pull_x = lanes_keep(is_pulled, pull_x);
  pull_y = lanes_keep(is_pulled, pull_y);
  result.covered = spots_are_within(&at, limit);
  result.covered &= lanes_at_least(dx, lanes_of(ray->dx_low)) & lanes_at_least(lanes_of(ray->dx_high), dx) &
                    lanes_at_least(dy, lanes_of(ray->dy_low)) & lanes_at_least(lanes_of(ray->dy_high), dy);
  spreads s = spreads_at(footprint, ray, &at, h);
  lanes u = at.u + (s.u_x * pull_x + s.u_y * pull_y), v = at.v + (s.v_x * pull_x + s.v_y * pull_y);
  lanes along = u * s.uv - v * s.uu;
  lanes q = u * u / s.uu + along * along / (s.uu * s.determinant);
  lanes within = lanes_select(lanes_less(lanes_of(0.0f), here.iz), here.u * here.u + here.v * here.v, support);
  result.q = lanes_select(lanes_less(q, support), q, within);
  result.covered &= lanes_less(result.q, support);
  result.scale = 1.0f / lanes_sqrt(curved_determinants(footprint, &at, &s, h));
  result.u = u;
  result.v = v;
  result.spread = s;
  result.iz = at.iz;
  result.plane_iz = here.iz;
  return result;
}
