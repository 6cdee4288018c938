/* The projection of a disc that may reach behind the camera, clipped at the near plane. */
#pragma once

#include "raster/project/projected.h"

/* A point of the clipped disc's outline on the screen. */
typedef struct conic_screen_point {
  double x_px, y_px, z;
} conic_screen_point;

/* The two points of the clipped outline that lie farthest along -direction and +direction on the screen. Returns 0
 * where nothing of the disc is before near. */
int conic_clip_disc(const conic_view *view, const conic_disc *disc, const double direction_px[2],
                    conic_screen_point *least, conic_screen_point *most);

/* The two (cos θ, sin θ) of solutions where a cos θ + b sin θ + c = 0; 0 where there are none. */
int conic_clip_solve(double a, double b, double c, double solutions[2][2]);

/* The box, in pixels, of the part of the disc before near that `n_lines` lines keep, all of them, or one where `is_or`.
 * Returns 0 where they keep nothing. */
int conic_clip_box(const conic_view *view, const conic_disc *disc, const float lines[2][3], int n_lines, int is_or,
                   double low_px[2], double high_px[2]);
