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

/* Towards a light, in the world. */
static void light_direction(const conic_camera *camera, const conic_light *light, const double v[3], double l[3]) {
  for (int c = 0; c < 3; c++)
    l[c] = light->frame == CONIC_LIGHT_HEAD ? v[c] : light->direction[c];
  if (light->frame == CONIC_LIGHT_CAMERA)
    for (int c = 0; c < 3; c++)
      l[c] = camera->cam_from_world[0][c] * light->direction[0] - camera->cam_from_world[1][c] * light->direction[1] -
             camera->cam_from_world[2][c] * light->direction[2];
  normalise(l);
}

/* What a light adds to the diffuse light and to the highlight, where it is white. */
static void light_up(const oracle_pixel *pixel, const double l[3], const double v[3], double *diffuse,
                     double *highlight) {
  const double *m = pixel->mean_normal, *n = pixel->normal;
  double along = 2.0 * oracle_max(oracle_dot(n, l), 0.0);
  double mirrored[3] = {along * n[0] - l[0], along * n[1] - l[1], along * n[2] - l[2]};
  double cosine = along > 0.0 ? oracle_max(oracle_dot(mirrored, v), 0.0) : 0.0;
  *diffuse = 0.75 * oracle_max(oracle_dot(m, l), 0.0);
  *highlight = 0.15 * oracle_dot(m, m);
  for (int i = 0; i < 32; i++)
    *highlight *= cosine;
}

/* Half way from the ground's colour to the sky's for a normal that is level, or for no normal at all. */
static double all_around(const conic_lighting *lighting, const double m[3], int c) {
  double up[3] = {lighting->up[0], lighting->up[1], lighting->up[2]};
  double sky = (double)lighting->sky[c], ground = (double)lighting->ground[c];
  if (sky == ground)
    return sky;
  normalise(up);
  double share = 0.5 + 0.5 * oracle_dot(m, up);
  return ground + (sky - ground) * share;
}

/* The one white light that the older options name. */
static conic_lighting lighting_of(const conic_render_options *options) {
  if (options->lighting.is_given)
    return options->lighting;
  conic_lighting one = {.n_lights = 1,
                        .lights = {{.frame = options->has_light ? CONIC_LIGHT_WORLD : CONIC_LIGHT_HEAD,
                                    .color = {1.0f, 1.0f, 1.0f},
                                    .direction = {options->light[0], options->light[1], options->light[2]}}},
                        .sky = {0.05f, 0.05f, 0.05f},
                        .ground = {0.05f, 0.05f, 0.05f}};
  return one;
}

void conic_oracle_shade(const conic_camera *camera, const conic_render_options *options, double x, double y,
                        const oracle_pixel *pixel, double rgba[4]) {
  const conic_lighting lighting = lighting_of(options);
  double v[3], lit[3] = {1.0, 1.0, 1.0}, glossy[3] = {0.0, 0.0, 0.0};
  view_direction(camera, x, y, v);
  for (int c = 0; c < 3 && options->shading != CONIC_SHADE_NONE; c++)
    lit[c] = all_around(&lighting, pixel->mean_normal, c);
  for (int i = 0; i < lighting.n_lights && options->shading != CONIC_SHADE_NONE; i++) {
    const conic_light *light = &lighting.lights[i];
    double l[3], diffuse, highlight;
    light_direction(camera, light, v, l);
    light_up(pixel, l, v, &diffuse, &highlight);
    for (int c = 0; c < 3; c++) {
      lit[c] += diffuse * (double)light->color[c];
      glossy[c] += options->shading == CONIC_SHADE_PHONG ? highlight * (double)light->color[c] : 0.0;
    }
  }
  for (int c = 0; c < 3; c++)
    rgba[c] = (pixel->albedo[c] * lit[c] + glossy[c]) * white(options);
  rgba[3] = 1.0;
}

void conic_oracle_background(const conic_render_options *options, double rgba[4]) {
  for (int c = 0; c < 3; c++)
    rgba[c] = options->has_background ? (double)options->background[c] * white(options) : 0.0;
  rgba[3] = options->has_background ? 1.0 : 0.0;
}
