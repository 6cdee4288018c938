/* Deferred shading, background and exposure. */
#include "oracle/oracle_pixel.h"

static double white(const conic_render_options *options) {
  return conic_oracle_exp(options->exposure * 0.69314718055994530942);
}

static void normalise(double v[3]) {
  double length = oracle_length(v);
  for (int c = 0; c < 3; c++)
    v[c] /= length;
}

/* From the surface to the viewer, in the world. */
static void view_direction(const conic_camera *camera, double x, double y, double v[3]) {
  double ray[3] = {(x - camera->cx) / camera->fx, (y - camera->cy) / camera->fy, 1.0};
  for (int c = 0; c < 3; c++)
    v[c] = -(camera->cam_from_world[0][c] * ray[0] + camera->cam_from_world[1][c] * ray[1] +
             camera->cam_from_world[2][c] * ray[2]);
  normalise(v);
}

void conic_oracle_shade(const conic_camera *camera, const conic_render_options *options, double x, double y,
                        const oracle_pixel *pixel, double rgba[4]) {
  double v[3], l[3], diffuse = 1.0, highlight = 0.0;
  view_direction(camera, x, y, v);
  for (int c = 0; c < 3; c++)
    l[c] = options->has_light ? options->light[c] : v[c];
  normalise(l);
  const double *m = pixel->mean_normal, *n = pixel->normal;
  if (options->shading != CONIC_SHADE_NONE)
    diffuse = 0.05 + 0.75 * oracle_max(oracle_dot(m, l), 0.0);
  if (options->shading == CONIC_SHADE_PHONG) {
    double along = 2.0 * oracle_max(oracle_dot(n, l), 0.0);
    double mirrored[3] = {along * n[0] - l[0], along * n[1] - l[1], along * n[2] - l[2]};
    double cosine = along > 0.0 ? oracle_max(oracle_dot(mirrored, v), 0.0) : 0.0;
    highlight = 0.15 * oracle_dot(m, m);
    for (int i = 0; i < 32; i++)
      highlight *= cosine;
  }
  for (int c = 0; c < 3; c++)
    rgba[c] = (pixel->albedo[c] * diffuse + highlight) * white(options);
  rgba[3] = 1.0;
}

void conic_oracle_background(const conic_render_options *options, double rgba[4]) {
  for (int c = 0; c < 3; c++)
    rgba[c] = options->has_background ? (double)options->background[c] * white(options) : 0.0;
  rgba[3] = options->has_background ? 1.0 : 0.0;
}
