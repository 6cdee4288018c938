/* Whether a splat covers pixels, with what weight, and how deep: raster/tiles/coverage.h and core/splats/kernel.h lane
 * by lane, with the same operations in the same order. C and OpenCL C share this text; records are in private memory.
 */
#pragma once

#include "core/lanes/lanes.h"
#include "raster/loops/laplace_body.h"
#include "raster/loops/profile_lanes.h"
#include "raster/tiles/coverage.h"

/* One splat's pixels in one part of a block, covered or not. */
typedef struct fragments {
  lanes_mask covered;
  lanes q;
  lanes iz, plane_iz; /* as in conic_fragment */
  lanes scale;
} fragments;

/* How a splat is evaluated. */
typedef enum splat_kind {
  SPLAT_USUAL = 0,   /* by its ellipse alone */
  SPLAT_WIDE = 1,    /* likewise, but it hides in another way */
  SPLAT_SMOOTH = 2,  /* likewise, but a polynomial takes the kernel's place */
  SPLAT_SPECIAL = 3, /* whatever it is, without the kernel */
  SPLAT_PROFILED = 4 /* whatever it is; the scale has its profile */
} splat_kind;

/* The part of a splat's evaluation that does not depend on the column. Each number stands in all lanes of a register:
 * most of what the loops read would else be these numbers, anew for every block. */
typedef struct splat_rows {
  lanes dy, q_offset, q_rest, iz_offset, plane_offset;
  lanes x, dx0, s1, iz_dx, plane_dx, iz_far, iz_near;
  lanes minor;               /* s3·dy */
  profile_slice slice;       /* of what is profiled */
  const smooth_part *smooth; /* of what is smooth */
} splat_rows;

CONIC_INLINE splat_rows begin_rows(const conic_footprint *footprint, lanes y) {
  splat_rows rows;
  rows.dy = (y - footprint->y) + footprint->dy0;
  lanes minor = footprint->s3 * rows.dy;
  rows.q_offset = footprint->s2 * rows.dy;
  rows.minor = minor;
  rows.q_rest = minor * minor;
  rows.iz_offset = footprint->iz0 + footprint->iz_dy * rows.dy;
  rows.plane_offset = footprint->iz0 + footprint->plane_dy * rows.dy;
  rows.x = lanes_of(footprint->x);
  rows.dx0 = lanes_of(footprint->dx0);
  rows.s1 = lanes_of(footprint->s1);
  rows.iz_dx = lanes_of(footprint->iz_dx);
  rows.plane_dx = lanes_of(footprint->plane_dx);
  rows.iz_far = lanes_of(footprint->iz_far);
  rows.iz_near = lanes_of(footprint->iz_near);
  return rows;
}

/* The splat's part of the profile, where there is one. */
CONIC_INLINE void begin_profile(const conic_view *view, const conic_footprint *footprint, const conic_ray *rays,
                                uint32_t i_ray, splat_rows *rows) {
  if (footprint->s3 == 0.0f && conic_is_deep(footprint))
    return;
  rows->slice.aim =
      footprint->s3 == 0.0f ? conic_ray_aim(view, footprint, &rays[i_ray]) : conic_variance_aim(view, footprint);
  cut_slice(&view->profile, &rows->slice);
}

/* The same operations, lane by lane, as conic_row_q, conic_row_iz and the plane's depth of coverage.h. */
CONIC_INLINE void ellipse_fragments(const conic_view *view, const splat_rows *rows, float support, splat_kind kind,
                                    lanes dx, fragments *f) {
  lanes major = rows->s1 * dx + rows->q_offset;
  f->q = major * major + rows->q_rest;
  f->covered = lanes_less(f->q, lanes_of(support));
  f->iz = lanes_min(lanes_max(rows->iz_offset + rows->iz_dx * dx, rows->iz_far), rows->iz_near);
  f->plane_iz = rows->plane_offset + rows->plane_dx * dx;
  f->scale = lanes_of(1.0f);
  if (kind == SPLAT_SMOOTH)
    f->scale = smooth_lanes(rows->smooth, f->q, major, rows->minor);
  else if (kind == SPLAT_PROFILED && lanes_any(f->covered))
    f->scale = profile_lanes(&view->profile, &rows->slice, f->q, major, rows->minor);
}

/* conic_ray_profile, lane by lane: from the slice, or where every pixel has shares of its own as plain C does it. */
CONIC_INLINE lanes ray_profiles(const conic_view *view, const conic_footprint *footprint, const profile_slice *slice,
                                const fragments *f, lanes xx, lanes xy, lanes yy, lanes area, lanes u, lanes v) {
  if (!conic_is_deep(footprint))
    return profile_lanes(&view->profile, slice, f->q, u, v);
  float from[7][CONIC_LANES], values[CONIC_LANES] = {0.0f};
  const lanes stored[7] = {xx, xy, yy, area * area, f->q, u, v};
  unsigned covered = lanes_bits(f->covered);
  for (int i = 0; i < 7; i++)
    lanes_store(from[i], stored[i]);
  for (int lane = 0; lane < CONIC_LANES; lane++) {
    if (!(covered >> lane & 1))
      continue;
    conic_aim aim = conic_aim_of(&view->profile, from[0][lane], from[1][lane], from[2][lane], from[3][lane], 1);
    values[lane] = conic_profile_at(&view->profile, &aim, from[4][lane], from[5][lane], from[6][lane]);
  }
  return lanes_load(values);
}

/* The plane's inverse depth, and where that and the box let a ray cover pixels. */
CONIC_INLINE lanes_mask ray_reaches(const conic_footprint *footprint, const conic_ray *ray, lanes dx, lanes dy,
                                    lanes *inverse_depth) {
  lanes iz = (footprint->iz0 + footprint->iz_dy * dy) + footprint->iz_dx * dx;
  *inverse_depth = iz;
  return lanes_less(lanes_of(0.0f), iz) & lanes_at_least(iz, lanes_of(ray->iz_low)) &
         lanes_at_least(lanes_of(ray->iz_high), iz) & lanes_at_least(dx, lanes_of(ray->dx_low)) &
         lanes_at_least(lanes_of(ray->dx_high), dx) & lanes_at_least(dy, lanes_of(ray->dy_low)) &
         lanes_at_least(lanes_of(ray->dy_high), dy);
}

/* conic_ray_fragment of coverage.h, lane by lane. Lanes that it leaves early may hold anything: they are masked. */
CONIC_INLINE void ray_fragments(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                                const profile_slice *slice, lanes dx, lanes dy, fragments *f) {
  lanes iz;
  f->covered = ray_reaches(footprint, ray, dx, dy, &iz);
  lanes r = 1.0f / iz;
  lanes u = ((ray->u0 + ray->u_dy * dy) + ray->u_dx * dx) * r;
  lanes v = ((ray->v0 + ray->v_dy * dy) + ray->v_dx * dx) * r;
  lanes u_x = (ray->u_dx - u * footprint->iz_dx) * r, u_y = (ray->u_dy - u * footprint->iz_dy) * r;
  lanes v_x = (ray->v_dx - v * footprint->iz_dx) * r, v_y = (ray->v_dy - v * footprint->iz_dy) * r;
  float h = view->prefilter;
  lanes xx = h * (u_x * u_x + u_y * u_y), yy = h * (v_x * v_x + v_y * v_y);
  lanes s_uu = 1.0f + xx, s_vv = 1.0f + yy;
  lanes s_uv = h * (u_x * v_x + u_y * v_y);
  lanes area = u_x * v_y - u_y * v_x;
  lanes determinant = (s_uu + s_vv - 1.0f) + (h * area) * (h * area);
  lanes along = u * s_uv - v * s_uu, inverse = 1.0f / (s_uu * determinant);
  f->q = ((u * u) * determinant + along * along) * inverse;
  f->covered &= lanes_less(f->q, lanes_of(view->support));
  f->iz = lanes_min(lanes_max(iz, lanes_of(footprint->iz_far)), lanes_of(footprint->iz_near));
  f->plane_iz = iz;
  f->scale = lanes_sqrt(s_uu * inverse);
  if (slice && lanes_any(f->covered))
    f->scale *= ray_profiles(view, footprint, slice, f, xx, s_uv, yy, h * area, u, v);
}

/* conic_laplace_fragment of coverage.h, lane by lane. */
CONIC_INLINE void laplace_fragments(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                                    const profile_slice *slice, lanes dx, lanes dy, fragments *f) {
  laplaces at = laplaces_at(view, footprint, ray, dx, dy);
  f->covered = at.covered;
  f->q = at.q;
  f->iz = lanes_min(lanes_max(at.iz, lanes_of(footprint->iz_far)), lanes_of(footprint->iz_near));
  f->plane_iz = at.plane_iz;
  f->scale = at.scale;
  if (slice && lanes_any(f->covered))
    f->scale *= ray_profiles(view, footprint, slice, f, at.spread.xx, at.spread.uv, at.spread.yy,
                             view->prefilter * at.spread.area, at.u, at.v);
}

CONIC_INLINE lanes ray_lengths(lanes ray_x, lanes ray_y) {
  return lanes_sqrt((ray_x * ray_x + ray_y * ray_y) + 1.0f);
}

/* conic_hiding_iz of a wide splat, lane by lane. */
CONIC_INLINE lanes wide_hiding(const conic_footprint *footprint, lanes iz, lanes ray_length) {
  lanes before = lanes_max(iz, lanes_of(0.0f));
  return before * (ray_length / (ray_length - footprint->nearness * before));
}

/* conic_clip_keeps, lane by lane. */
CONIC_INLINE lanes_mask clip_keeps(const conic_clip_record *clip, lanes dx, lanes dy) {
  lanes zero = lanes_of(0.0f);
  lanes_mask first = lanes_at_least((clip->d0[0] + clip->by_y[0] * dy) + clip->by_x[0] * dx, zero);
  lanes_mask second = lanes_at_least((clip->d0[1] + clip->by_y[1] * dy) + clip->by_x[1] * dx, zero);
  lanes_mask within = lanes_at_least(dx, lanes_of(clip->dx_low)) & lanes_at_least(lanes_of(clip->dx_high), dx) &
                      lanes_at_least(dy, lanes_of(clip->dy_low)) & lanes_at_least(lanes_of(clip->dy_high), dy);
  return (clip->is_or ? first | second : first & second) & within;
}

/* A splat's fragments at the pixels x. Special are rays and what has clip lines: where s3 is not above 0. Ray i_ray and
 * record i_clip are only looked at where the splat has one. */
CONIC_INLINE void fragments_at(const conic_view *view, float support, const conic_footprint *footprint,
                               const conic_ray *rays, uint32_t i_ray, const conic_clip_record *clips, size_t i_clip,
                               const splat_rows *rows, lanes x, splat_kind kind, fragments *f) {
  lanes dx = (x - rows->x) + rows->dx0;
  const profile_slice *slice = kind == SPLAT_PROFILED ? &rows->slice : NULL;
  if (kind >= SPLAT_SPECIAL && conic_is_laplace(footprint))
    laplace_fragments(view, footprint, &rays[i_ray], slice, dx, rows->dy, f);
  else if (kind >= SPLAT_SPECIAL && footprint->s3 == 0.0f)
    ray_fragments(view, footprint, &rays[i_ray], slice, dx, rows->dy, f);
  else
    ellipse_fragments(view, rows, support, kind, dx, f);
  if (kind >= SPLAT_SPECIAL && conic_is_clipped(footprint))
    f->covered &= clip_keeps(&clips[i_clip], dx, rows->dy);
}

/* Which kernel a loop is made for. A profile's is in the scale already. */
typedef enum kernel_kind { KERNEL_NARROW_GAUSS, KERNEL_GAUSS, KERNEL_OTHER, KERNEL_PROFILE } kernel_kind;

static kernel_kind kind_of(const conic_kernel *kernel) {
  if (conic_kernel_is_narrow(kernel))
    return KERNEL_NARROW_GAUSS;
  return conic_kernel_traits(kernel) & CONIC_IS_GAUSSIAN ? KERNEL_GAUSS : KERNEL_OTHER;
}

static kernel_kind kind_of_view(const conic_view *view) {
  return view->profile.table ? KERNEL_PROFILE : kind_of(&view->kernel);
}

#define KERNEL_VALUE other_kernel
#define KERNEL_INLINE CONIC_INLINE
#define KERNEL_NUMBER float
#define KERNEL_REAL lanes
#define KERNEL_OF(x) lanes_of(x)
#define KERNEL_SQRT(x) lanes_sqrt(x)
#define KERNEL_EXP(x) lanes_exp_negative(x)
#define KERNEL_ABOVE_0(x, y) lanes_keep(lanes_less(lanes_of(0.0f), x), y)
#define KERNEL_GAUSS_OF(kernel, q) lanes_exp_negative(-0.5f * (q)) /* which kernel_value sees to */
#include "core/splats/kernel_body.h"

/* conic_kernel_value in every lane below the support; beyond it, a kernel need not have a value. */
CONIC_INLINE lanes kernel_value(const conic_view *view, lanes q, kernel_kind kind) {
  if (kind == KERNEL_NARROW_GAUSS)
    return lanes_gauss_narrow(q);
  if (kind == KERNEL_GAUSS)
    return lanes_exp_negative(-0.5f * q);
  return other_kernel(&view->kernel, lanes_keep(lanes_less(q, lanes_of(view->support)), q));
}

/* conic_final_weight in every lane; 0 in those that are not visible. */
CONIC_INLINE lanes weigh(const conic_view *view, float amplitude, lanes q, lanes scale, lanes_mask visible,
                         kernel_kind kind) {
  lanes weight = amplitude * scale;
  if (kind != KERNEL_PROFILE)
    weight *= kernel_value(view, q, kind);
  return lanes_keep(visible, lanes_max(weight, lanes_of(CONIC_LEAST_WEIGHT)));
}
