/* A Gaussian set up for one picture: what its pixels need of it. C and OpenCL C share the records. */
#pragma once

#include "gaussians/draw/gaussian_rules.h"

typedef struct conic_gaussian_footprint {
  int32_t x, y;     /* the pixel that offsets are counted from */
  float dx, dy;     /* from the place on the screen to that pixel's centre */
  float form[3];    /* of an ellipse: q = form₀·Δx² + 2·form₁·Δx·Δy + form₂·Δy²; of other shapes 0 */
  float half_reach; /* nothing is composited where half of that q is more */
  float opacity, z; /* z of the mean; of a ray, what no z along it is below */
  float color[3];
  uint32_t index;     /* in the scene */
  uint16_t box[2][2]; /* the pixels that it may cover, first and last in x and y */
} conic_gaussian_footprint;

/* Along the rays of pixels. With g and c of the pixel, affine on the screen, q = |c|²/|g|² and z = e/|g|². */
typedef struct conic_gaussian_ray {
  float g[3][3], c[3][3], e[3]; /* at the reference pixel's centre, and by how much they grow in x and in y */
} conic_gaussian_ray;

#ifndef CONIC_ON_DEVICE
/* What a filter adds to a ray. With X = x − both·Δy, Y = y + both·Δx, t = z²/|g|², of an orthographic camera 1/|g|²,
 * |S| = 1 + t·(|X|² + |Y|²) + (t·area)²·|g|², and |S|·q gains t·((turn₀ − turn₂·Δy)² + (turn₁ + turn₂·Δx)²). */
typedef struct conic_gaussian_filter {
  float x[3], y[3], both[3], turn[3], area;
} conic_gaussian_filter;

/* Along rays that are not affine on the screen. With the pixel's direction less `high` and `low`, g, c and e of it are
 * at₀ + at₁·Δx + at₂·Δy + at₃·Δz. */
typedef struct conic_gaussian_sight {
  float high[3], low[3]; /* a direction of the camera's rays, near the mean's: their sum */
  float g[3][4], c[3][4], e[4];
  float origin_high[3], origin_low[3],
      unit; /* with a rolling shutter, where that ray begins, and what g was divided by:
               o off it, c gains −g × unit·(g₁, g₂, g₃)·o, e −g·(g₁, g₂, g₃)·o; or 0 */
} conic_gaussian_sight;

typedef struct conic_view_rays conic_view_rays;

typedef struct conic_gaussian_view {
  const conic_profile_row *rules;
  const conic_camera *camera;
  double eye[3], center_px[2];
  double prefilter;            /* px²; of CONIC_SHAPE_RAY */
  int is_parallel;             /* orthographic */
  const conic_view_rays *rays; /* of the pixels, where they are not affine on the screen; else null */
} conic_gaussian_view;

typedef enum conic_gaussian_fate {
  CONIC_GAUSSIAN_DRAWN = 0,
  CONIC_GAUSSIAN_CULLED = 1, /* off the picture, too near or too faint everywhere */
  CONIC_GAUSSIAN_SKIPPED = 2 /* a number is not finite, or a scale is negative */
} conic_gaussian_fate;

/* Sets up Gaussian i. `key` is what Gaussians are ordered by. `ray` is filled for the shapes that have one, `filter`
 * where the view has one, `sight` in place of both where the view has rays; `normal` may be null. */
conic_gaussian_fate conic_gaussian_set_up(const conic_gaussian_view *view, const conic_gaussians *gaussians, size_t i,
                                          conic_gaussian_footprint *footprint, float *key, conic_gaussian_ray *ray,
                                          conic_gaussian_filter *filter, conic_gaussian_sight *sight, float normal[3]);

/* Gaussians side by side, as lanes set up ellipses: what is left to do is done one by one. */
enum { CONIC_ELLIPSES = 64, CONIC_MOST_FUNCTIONS = (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1) };
typedef struct conic_gaussian_ellipses {
  double place[2][CONIC_ELLIPSES], half[2][CONIC_ELLIPSES]; /* of the box */
  double spread[CONIC_ELLIPSES];                            /* of CONIC_COVERAGE_TILES: three standard deviations */
  double form[3][CONIC_ELLIPSES], reach[CONIC_ELLIPSES], opacity[CONIC_ELLIPSES], z[CONIC_ELLIPSES],
      key[CONIC_ELLIPSES];
  float harmonics[CONIC_MOST_FUNCTIONS][CONIC_ELLIPSES];
  uint64_t is_good, is_drawn; /* bits: whether all numbers are finite, else it has to be set up anew; it may be drawn */
} conic_gaussian_ellipses;

/* Whether lanes may set up the view's Gaussians. */
int conic_gaussian_has_ellipses(const conic_gaussian_view *view);
/* The same as conic_gaussian_set_up of Gaussian first + at, which is good. */
conic_gaussian_fate conic_gaussian_take_ellipse(const conic_gaussian_view *view, const conic_gaussians *gaussians,
                                                const conic_gaussian_ellipses *ellipses, size_t first, size_t at,
                                                conic_gaussian_footprint *footprint, float *key);

/* A Gaussian's colour in floats (docs/reference/gaussians.md, Colour): max(0, ½ + Σ sh·Y) seen along `from_eye`, of any
 * length, or by degree 0 alone. Returns 0 where it is not finite. */
int conic_harmonic_color(const conic_gaussians *set, size_t i, int is_plain, const double from_eye[3], float color[3]);
/* The same of what the harmonics are there, `stride` numbers apart. */
int conic_harmonic_sum(const conic_gaussians *set, size_t i, int is_plain, const float *harmonics, size_t stride,
                       float color[3]);
#endif
