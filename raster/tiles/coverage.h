/* The one place that says whether a splat covers a pixel, with what weight, and how deep: shared by both passes and by
 * resolving, so that they agree in every bit. */
#pragma once

#include "raster/project/clip_lines.h"
#include "raster/project/laplace.h"
#include "raster/tiles/band.h"

/* A splat on one row of pixels. */
typedef struct conic_row {
  float q_offset;     /* s2·dy */
  float q_rest;       /* (s3·dy)² */
  float iz_offset;    /* iz0 + iz_dy·dy */
  float plane_offset; /* iz0 + plane_dy·dy */
} conic_row;

typedef struct conic_fragment {
  float q, iz;
  float plane_iz; /* of the splat's plane at the pixel, neither shrunk nor clamped */
  float scale; /* what multiplies amplitude and kernel: |I + h·JJᵀ|^-½ for rays, else 1; with a profile, times that */
} conic_fragment;

static inline float conic_row_dy(const conic_footprint *footprint, int y) {
  return ((float)y - footprint->y) + footprint->dy0;
}

static inline float conic_row_dx(const conic_footprint *footprint, int x) {
  return ((float)x - footprint->x) + footprint->dx0;
}

static inline conic_row conic_row_begin(const conic_footprint *footprint, float dy) {
  conic_row row;
  float minor = footprint->s3 * dy;
  row.q_offset = footprint->s2 * dy;
  row.q_rest = minor * minor;
  row.iz_offset = footprint->iz0 + footprint->iz_dy * dy;
  row.plane_offset = footprint->iz0 + footprint->plane_dy * dy;
  return row;
}

static inline float conic_clamp_iz(const conic_footprint *footprint, float iz) {
  iz = iz > footprint->iz_far ? iz : footprint->iz_far;
  return iz < footprint->iz_near ? iz : footprint->iz_near;
}

static inline float conic_row_q(const conic_footprint *footprint, const conic_row *row, float dx) {
  float major = footprint->s1 * dx + row->q_offset;
  return major * major + row->q_rest;
}

static inline float conic_row_iz(const conic_footprint *footprint, const conic_row *row, float dx) {
  return conic_clamp_iz(footprint, row->iz_offset + footprint->iz_dx * dx);
}

/* Camera-space z of the splat's plane at the pixel, within the splat's range. */
static inline float conic_plane_z(const conic_footprint *footprint, int x, int y) {
  float dx = conic_row_dx(footprint, x), dy = conic_row_dy(footprint, y);
  float iz = (footprint->iz0 + footprint->plane_dy * dy) + footprint->plane_dx * dx;
  return 1.0f / conic_clamp_iz(footprint, iz);
}

/* By what a fragment hides others on the ray (ray_x, ray_y, 1), and by what it is seen: docs/reference/picture.md,
 * "Visible". */
static inline float conic_hiding_iz(const conic_footprint *footprint, const conic_fragment *fragment, float ray_x,
                                    float ray_y) {
  float iz = fragment->plane_iz < fragment->iz ? fragment->plane_iz : fragment->iz;
  if (!conic_is_wide(footprint))
    return footprint->nearness * iz;
  float ray_length = sqrtf((ray_x * ray_x + ray_y * ray_y) + 1.0f), before = iz > 0.0f ? iz : 0.0f;
  return before * (ray_length / (ray_length - footprint->nearness * before));
}

static inline float conic_seen_iz(const conic_fragment *fragment) {
  return fragment->plane_iz > fragment->iz ? fragment->plane_iz : fragment->iz;
}

/* The footprint's part in the profile, by the axes of V⁻¹. */
static inline conic_aim conic_variance_aim(const conic_view *view, const conic_footprint *footprint) {
  float h = view->prefilter, s1 = footprint->s1, s2 = footprint->s2, s3 = footprint->s3, area = h * (s1 * s3);
  return conic_aim_of(&view->profile, h * (s1 * s1 + s2 * s2), h * (s2 * s3), h * (s3 * s3), area * area, 0);
}

/* The same of a ray, by its Jacobian at the reference. Where that is not before the eye, the kernel is as without a
 * filter. */
static inline conic_aim conic_ray_aim(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray) {
  float r = footprint->iz0 > 0.0f ? 1.0f / footprint->iz0 : 0.0f, h = view->prefilter;
  float u = conic_is_laplace(footprint) ? 0.0f : ray->u0 * r, v = conic_is_laplace(footprint) ? 0.0f : ray->v0 * r;
  float u_x = (ray->u_dx - u * footprint->iz_dx) * r, u_y = (ray->u_dy - u * footprint->iz_dy) * r;
  float v_x = (ray->v_dx - v * footprint->iz_dx) * r, v_y = (ray->v_dy - v * footprint->iz_dy) * r;
  float area = h * (u_x * v_y - u_y * v_x);
  return conic_aim_of(&view->profile, h * (u_x * u_x + u_y * u_y), h * (u_x * v_x + u_y * v_y),
                      h * (v_x * v_x + v_y * v_y), area * area, 1);
}

/* Whether perspective changes the filter's shares within the disc by so much that every pixel has its own. */
#define CONIC_DEEP 1.125f

static inline int conic_is_deep(const conic_footprint *footprint) {
  return footprint->iz_near > CONIC_DEEP * footprint->iz_far;
}

/* The profile of a ray's pixel at (u, v), where h·JJᵀ is so. */
static inline float conic_ray_profile(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                                      float xx, float xy, float yy, float area, float q, float u, float v) {
  conic_aim aim = conic_is_deep(footprint) ? conic_aim_of(&view->profile, xx, xy, yy, area * area, 1)
                                           : conic_ray_aim(view, footprint, ray);
  return conic_profile_at(&view->profile, &aim, q, u, v);
}

/* The exact ray–splat parameter with the pixel's filter mapped into the splat (docs/reference/picture.md): 1 where the
 * pixel is covered. */
static inline int conic_ray_fragment(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                                     float dx, float dy, conic_fragment *fragment) {
  float iz = (footprint->iz0 + footprint->iz_dy * dy) + footprint->iz_dx * dx;
  if (!(iz > 0.0f && iz >= ray->iz_low && iz <= ray->iz_high))
    return 0;
  if (!(dx >= ray->dx_low && dx <= ray->dx_high && dy >= ray->dy_low && dy <= ray->dy_high))
    return 0;
  float r = 1.0f / iz;
  float u = ((ray->u0 + ray->u_dy * dy) + ray->u_dx * dx) * r;
  float v = ((ray->v0 + ray->v_dy * dy) + ray->v_dx * dx) * r;
  float u_x = (ray->u_dx - u * footprint->iz_dx) * r, u_y = (ray->u_dy - u * footprint->iz_dy) * r;
  float v_x = (ray->v_dx - v * footprint->iz_dx) * r, v_y = (ray->v_dy - v * footprint->iz_dy) * r;
  float h = view->prefilter;
  float xx = h * (u_x * u_x + u_y * u_y), yy = h * (v_x * v_x + v_y * v_y);
  float s_uu = 1.0f + xx, s_vv = 1.0f + yy;
  float s_uv = h * (u_x * v_x + u_y * v_y);
  /* |I + h·JJᵀ| = 1 + h·tr(JJᵀ) + h²·|J|²: sums of what is not negative. */
  float area = u_x * v_y - u_y * v_x;
  float determinant = (s_uu + s_vv - 1.0f) + (h * area) * (h * area);
  /* uS⁻¹uᵀ as a sum of two squares, by Cholesky; one division serves it and 1/√|S|. */
  float along = u * s_uv - v * s_uu, inverse = 1.0f / (s_uu * determinant);
  float q = ((u * u) * determinant + along * along) * inverse;
  if (!(q < view->support))
    return 0;
  fragment->q = q;
  fragment->iz = conic_clamp_iz(footprint, iz);
  fragment->plane_iz = iz;
  fragment->scale = sqrtf(s_uu * inverse);
  if (view->profile.table)
    fragment->scale *= conic_ray_profile(view, footprint, ray, xx, s_uv, yy, h * area, q, u, v);
  return 1;
}

static inline float conic_final_weight(const conic_view *view, const conic_footprint *footprint, float q, float scale) {
  float weight = footprint->amplitude * scale;
  if (!view->profile.table)
    weight *= conic_kernel_value(&view->kernel, q);
  return weight > CONIC_LEAST_WEIGHT ? weight : CONIC_LEAST_WEIGHT;
}

/* The same at the place that the pixel mostly sees. */
static inline int conic_laplace_fragment(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                                         float dx, float dy, conic_fragment *fragment) {
  conic_laplace at;
  if (!conic_laplace_at(view, footprint, ray, dx, dy, &at))
    return 0;
  fragment->q = at.q;
  fragment->iz = conic_clamp_iz(footprint, at.iz);
  fragment->plane_iz = at.plane_iz;
  fragment->scale = at.scale;
  if (view->profile.table)
    fragment->scale *= conic_ray_profile(view, footprint, ray, at.spread.xx, at.spread.uv, at.spread.yy,
                                         view->prefilter * at.spread.area, at.q, at.u, at.v);
  return 1;
}

/* By the variance on the screen: s3 is not 0. */
static inline int conic_variance_fragment(const conic_view *view, const conic_footprint *footprint, float dx, float dy,
                                          conic_fragment *fragment) {
  conic_row row = conic_row_begin(footprint, dy);
  fragment->q = conic_row_q(footprint, &row, dx);
  fragment->iz = conic_row_iz(footprint, &row, dx);
  fragment->plane_iz = row.plane_offset + footprint->plane_dx * dx;
  fragment->scale = 1.0f;
  if (!(fragment->q < view->support))
    return 0;
  if (view->profile.table) {
    conic_aim aim = conic_variance_aim(view, footprint);
    float x = footprint->s1 * dx + row.q_offset, y = footprint->s3 * dy;
    fragment->scale = conic_profile_at(&view->profile, &aim, fragment->q, x, y);
  }
  return 1;
}

/* The splat at a pixel: 1 where it covers it. */
static inline int conic_fragment_at(const conic_view *view, const conic_projected *projected,
                                    const conic_footprint *footprint, int x, int y, conic_fragment *fragment) {
  float dx = conic_row_dx(footprint, x), dy = conic_row_dy(footprint, y);
  if (conic_is_clipped(footprint) && !conic_clip_keeps(&projected->clips[footprint - projected->footprints], dx, dy))
    return 0;
  if (conic_is_laplace(footprint))
    return conic_laplace_fragment(view, footprint, &projected->rays[footprint->i_ray], dx, dy, fragment);
  if (footprint->s3 == 0.0f)
    return conic_ray_fragment(view, footprint, &projected->rays[footprint->i_ray], dx, dy, fragment);
  return conic_variance_fragment(view, footprint, dx, dy, fragment);
}
