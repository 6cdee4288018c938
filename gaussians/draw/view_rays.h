/* The rays of all pixels of a picture, for cameras whose rays are not affine on the screen. */
#pragma once

#include "core/image/camera_shutter.h"
#include "gaussians/draw/gaussian_tile.h"
#include "gaussians/draw/view_lens.h"

/* Directions within an angle of the axis; none where is_empty. */
typedef struct conic_view_cone {
  double axis[3], cosine, sine;
  int is_empty;
} conic_view_cone;

struct conic_view_rays {
  const conic_camera *camera;
  conic_view_lens lens;         /* of CONIC_SHAPE_SOLID, */
  conic_camera_shutter shutter; /* as is this */
  int n_tiles[2], n_blocks[2];
  conic_sight_rays *tiles;         /* by tile */
  conic_view_cone *cones, *blocks; /* of tiles, and of CONIC_RAY_BLOCK × CONIC_RAY_BLOCK of them */
};

enum { CONIC_RAY_BLOCK = 8 };

/* On failure *rays is to be released, too. Errors: MEMORY. */
conic_status conic_view_rays_make(conic_context *context, const conic_camera *camera, const conic_profile_row *rules,
                                  conic_view_rays *rays);
void conic_view_rays_release(conic_context *context, conic_view_rays *rays);

/* The box of the tiles in which a ray may meet the ball, as pixels, first and last in x and y. Returns 0: none may. */
int conic_view_rays_box(const conic_view_rays *rays, const double center[3], double radius, uint16_t box[2][2]);

/* Where a place in camera space shows, of CONIC_SHAPE_SOLID, and at which share of the exposure. Returns whether it is
 * seen, in the picture or not farther beside it than a share of its sides. */
int conic_view_rays_show(const conic_view_rays *rays, const double at[3], double margin, double place[2],
                         double *share);

/* Of a share of the exposure, turns a direction into the middle's camera space, where it tells the eye's place. */
void conic_view_rays_turn(const conic_view_rays *rays, double share, double direction[3], double origin[3]);

/* The direction of the ray towards a place in camera space, or of another ray where there is none. */
void conic_view_rays_towards(const conic_camera *camera, const double place[3], double direction[3]);
