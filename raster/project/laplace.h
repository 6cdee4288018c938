/* The ray formula at the place that a pixel mostly sees: Laplace's method for the integral of kernel and filter
 * (docs/reference/picture.md, Laplace). Rays of method `auto` whose perspective changes within a pixel's filter are
 * drawn so; s2, which rays have no other use for, is 1 for them. */
#pragma once

#include <math.h>

#include "raster/project/projected.h"

/* A place counts as the disc's while u² is at most so many times F_g². */
#define CONIC_LAPLACE_REACH 2.0f
/* The determinant with second derivatives is held above this part of the one without. */
#define CONIC_LAPLACE_LEAST 0.25f

/* A place of the screen and what is there of the splat's plane. */
typedef struct conic_spot {
  float iz, r; /* r = 1/iz */
  float u, v;
} conic_spot;

static inline conic_spot conic_spot_at(const conic_footprint *footprint, const conic_ray *ray, float dx, float dy) {
  conic_spot spot;
  spot.iz = (footprint->iz0 + footprint->iz_dy * dy) + footprint->iz_dx * dx;
  spot.r = 1.0f / spot.iz;
  spot.u = (ray->u_dx * dx + ray->u_dy * dy) * spot.r;
  spot.v = (ray->v_dx * dx + ray->v_dy * dy) * spot.r;
  return spot;
}

static inline int conic_spot_is_within(const conic_spot *spot, float limit) {
  return spot->iz > 0.0f && spot->u * spot->u + spot->v * spot->v <= limit;
}

/* The change of u and v by a pixel, and what the filter makes of it: h·JJᵀ, S = I + h·JJᵀ and its determinant. No term
 * of these sums is negative. */
typedef struct conic_spread {
  float u_x, u_y, v_x, v_y, area;
  float xx, yy;
  float uu, uv, vv, determinant;
} conic_spread;

static inline conic_spread conic_spread_at(const conic_footprint *footprint, const conic_ray *ray, const conic_spot *at,
                                           float h) {
  conic_spread s;
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

/* |I + h·N|, N = JᵀJ - a·gᵀ - g·aᵀ, where a = Jᵀu and g is the gradient of iz over iz: u's second derivatives are -J·gᵀ
 * and its mirror. */
static inline float conic_curved_determinant(const conic_footprint *footprint, const conic_spot *at,
                                             const conic_spread *s, float h) {
  float g_x = footprint->iz_dx * at->r, g_y = footprint->iz_dy * at->r;
  float a_x = at->u * s->u_x + at->v * s->v_x, a_y = at->u * s->u_y + at->v * s->v_y, across = a_x * g_y - a_y * g_x;
  float turned = g_x * (s->v_y * at->u - s->u_y * at->v) + g_y * (s->u_x * at->v - s->v_x * at->u);
  float curved =
      (s->determinant - (2.0f * h) * (a_x * g_x + a_y * g_y)) - (h * h) * (2.0f * (s->area * turned) + across * across);
  float least = CONIC_LAPLACE_LEAST * s->determinant;
  return curved > least ? curved : least;
}

/* A laplace splat at a pixel. */
typedef struct conic_laplace {
  float q, scale, u, v;
  float iz, plane_iz; /* iz where the pixel mostly looks, not clamped; the plane's at the pixel */
  conic_spread spread;
} conic_laplace;

/* 1 where the pixel is covered. */
static inline int conic_laplace_at(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                                   float dx, float dy, conic_laplace *result) {
  float limit = CONIC_LAPLACE_REACH * (view->cutoff * view->cutoff), h = view->prefilter;
  float pull_x = ray->pull_xx * dx + ray->pull_xy * dy, pull_y = ray->pull_xy * dx + ray->pull_yy * dy;
  conic_spot here = conic_spot_at(footprint, ray, dx, dy);
  conic_spot at = conic_spot_at(footprint, ray, dx - pull_x, dy - pull_y);
  if (!conic_spot_is_within(&at, limit)) {
    at = here;
    pull_x = pull_y = 0.0f;
  }
  if (!conic_spot_is_within(&at, limit))
    return 0;
  if (!(dx >= ray->dx_low && dx <= ray->dx_high && dy >= ray->dy_low && dy <= ray->dy_high))
    return 0;
  conic_spread s = conic_spread_at(footprint, ray, &at, h);
  float u = at.u + (s.u_x * pull_x + s.u_y * pull_y), v = at.v + (s.v_x * pull_x + s.v_y * pull_y);
  float along = u * s.uv - v * s.uu;
  result->q = u * u / s.uu + along * along / (s.uu * s.determinant);
  /* What lies within the outline is covered, whatever the formula makes of it: no holes. */
  if (!(result->q < view->support))
    result->q = here.iz > 0.0f ? here.u * here.u + here.v * here.v : view->support;
  if (!(result->q < view->support))
    return 0;
  result->scale = 1.0f / sqrtf(conic_curved_determinant(footprint, &at, &s, h));
  result->u = u;
  result->v = v;
  result->spread = s;
  result->iz = at.iz;
  result->plane_iz = here.iz;
  return 1;
}
