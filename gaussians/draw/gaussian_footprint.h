/* A Gaussian set up for one picture: what its pixels need of it. */
#ifndef CONIC_GAUSSIAN_FOOTPRINT_H
#define CONIC_GAUSSIAN_FOOTPRINT_H

#include "conic/gaussians.h"
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

typedef struct conic_gaussian_view {
  const conic_gaussian_rules *rules;
  const conic_camera *camera;
  double eye[3], center_px[2];
} conic_gaussian_view;

typedef enum conic_gaussian_fate {
  CONIC_GAUSSIAN_DRAWN = 0,
  CONIC_GAUSSIAN_CULLED = 1, /* off the picture, too near or too faint everywhere */
  CONIC_GAUSSIAN_SKIPPED = 2 /* a number is not finite, or a scale is negative */
} conic_gaussian_fate;

/* Sets up Gaussian i. `key` is what Gaussians are ordered by. `ray` is filled for the shapes that have one; `normal`
 * may be null. */
conic_gaussian_fate conic_gaussian_set_up(const conic_gaussian_view *view, const conic_gaussians *gaussians, size_t i,
                                          conic_gaussian_footprint *footprint, float *key, conic_gaussian_ray *ray,
                                          float normal[3]);

#endif
