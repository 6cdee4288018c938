/* Rays where many splats meet a band: of most, the plane's inverse depth alone tells whether they cover its pixels, and
 * that they are hidden, so that they need not be evaluated. No bit of what is drawn or counted changes, and plain C
 * does without. Included by pass_body.h. */
#pragma once

#include <float.h>
#include <math.h>

#include "raster/loops/coverage_lanes.h"

/* Drawn by `ray`, and not by `laplace` nor with clip lines. */
CONIC_INLINE int is_plain_ray(const conic_footprint *footprint) {
  return footprint->s3 == 0.0f && footprint->s2 == 0.0f && !conic_is_clipped(footprint);
}

CONIC_INLINE int lesser_end(int a, int b) {
  return a < b ? a : b;
}

/* A band's pixels in the image, as offsets from a splat's reference: the first and the last, and the farthest from 0.
 */
typedef struct crowd_span {
  float x_first, x_last, y_first, y_last, x_most, y_most;
} crowd_span;

CONIC_INLINE crowd_span span_of(const conic_band *band, const conic_footprint *f) {
  int x_last = lesser_end(band->x + band->n_blocks * CONIC_BLOCK_EDGE, band->view->width) - 1;
  int y_last = lesser_end(band->y + CONIC_BLOCK_EDGE, band->view->height) - 1;
  crowd_span s = {((float)band->x - f->x) + f->dx0,
                  ((float)x_last - f->x) + f->dx0,
                  ((float)band->y - f->y) + f->dy0,
                  ((float)y_last - f->y) + f->dy0,
                  0.0f,
                  0.0f};
  s.x_most = fabsf(s.x_first) > fabsf(s.x_last) ? fabsf(s.x_first) : fabsf(s.x_last);
  s.y_most = fabsf(s.y_first) > fabsf(s.y_last) ? fabsf(s.y_first) : fabsf(s.y_last);
  return s;
}

CONIC_INLINE float most_of_affine(float at_zero, float by_x, float by_y, float x, float y) {
  return fabsf(at_zero) + fabsf(by_x) * x + fabsf(by_y) * y;
}

/* From this inverse depth on, |u| is at most most_u and √h·|J| at most most_change, wherever in the span. */
CONIC_INLINE float iz_for(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                          const crowd_span *s, float most_u, float most_change) {
  float u = most_of_affine(ray->u0, ray->u_dx, ray->u_dy, s->x_most, s->y_most) +
            most_of_affine(ray->v0, ray->v_dx, ray->v_dy, s->x_most, s->y_most);
  float change = fabsf(ray->u_dx) + fabsf(ray->u_dy) + fabsf(ray->v_dx) + fabsf(ray->v_dy);
  float slope = fabsf(footprint->iz_dx) + fabsf(footprint->iz_dy), filter = 2.0f * sqrtf(view->prefilter) / most_change;
  return u / most_u + filter * change + sqrtf(filter * (u * slope));
}

/* What may be covered is, from this inverse depth on: q ≤ |u|² is below the support by more than rounding adds, since S
 * is near I. */
CONIC_INLINE float sure_iz(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                           const crowd_span *s) {
  return iz_for(view, footprint, ray, s, 0.9f * sqrtf(view->support), 0.25f);
}

/* And from this one on S is I in float, and q below 2⁻²⁶: Gaussians do not tell it from 0. */
CONIC_INLINE float flat_iz(const conic_view *view, const conic_footprint *footprint, const conic_ray *ray,
                           const crowd_span *s) {
  return iz_for(view, footprint, ray, s, 0x1p-14f, 0x1p-14f);
}

/* What the inverse depths of the span's pixels lie between, with what rounding adds. */
typedef struct crowd_depths {
  float low, high;
} crowd_depths;

CONIC_INLINE crowd_depths depths_of(const conic_footprint *f, const crowd_span *s) {
  float middle_x = 0.5f * (s->x_first + s->x_last), middle_y = 0.5f * (s->y_first + s->y_last);
  float middle = (f->iz0 + f->iz_dy * middle_y) + f->iz_dx * middle_x;
  float reach = 0.5f * (fabsf(f->iz_dx) * (s->x_last - s->x_first) + fabsf(f->iz_dy) * (s->y_last - s->y_first)) +
                0x1p-18f * most_of_affine(f->iz0, f->iz_dx, f->iz_dy, s->x_most, s->y_most);
  return (crowd_depths){middle - reach, middle + reach};
}

/* No pixel of the span sees the ray by more than this. */
CONIC_INLINE float most_seen(const conic_footprint *footprint, const crowd_depths *depths) {
  return depths->high < footprint->iz_far ? footprint->iz_far : depths->high;
}

/* Whether a ray with these depths covers every pixel of the span. */
CONIC_INLINE int covers_span(const conic_ray *ray, const crowd_span *s, const crowd_depths *depths, float sure) {
  return depths->low >= sure && depths->low > 0.0f && depths->low >= ray->iz_low && depths->high <= ray->iz_high &&
         s->x_first >= ray->dx_low && s->x_last <= ray->dx_high && s->y_first >= ray->dy_low &&
         s->y_last <= ray->dy_high;
}
