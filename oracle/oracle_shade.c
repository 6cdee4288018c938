/* Deferred shading, background and exposure. */
#include "oracle/oracle_bounds.h"

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

static void cap(double range[2], double low, double high) {
  range[0] = oracle_min(oracle_max(range[0], low), high);
  range[1] = oracle_max(oracle_min(range[1], high), low);
}

/* n·d of the direction of the mean normal: of the components' ranges, and of m·d over |m|, what both allow. */
static void direction_along(const oracle_surface_range *range, const double length[2], const double along[2],
                            const double d[3], double result[2]) {
  result[0] = result[1] = 0.0;
  for (int c = 0; c < 3; c++) {
    result[0] += d[c] * range->normal[d[c] < 0.0][c];
    result[1] += d[c] * range->normal[!(d[c] < 0.0)][c];
  }
  cap(result, -1.0, 1.0);
  if (length[0] > 0.0)
    cap(result, along[0] / length[along[0] < 0.0 ? 0 : 1], along[1] / length[along[1] < 0.0 ? 1 : 0]);
}

/* The highlight of a white light, as light_up has it. */
static void highlight_range(const oracle_mixture *mixture, const oracle_surface_range *range, const double l[3],
                            const double v[3], const double diffuse[2], double result[2]) {
  double length[2] = {0.0, 0.0}, seen[2], nl[2], nv[2], cosine[2], least, most;
  for (int c = 0; c < 3; c++) {
    double low = range->mean_normal[0][c], high = range->mean_normal[1][c];
    double size = low > 0.0 ? low : high < 0.0 ? high : 0.0, largest = oracle_max(fabs(low), fabs(high));
    length[0] += size * size;
    length[1] += largest * largest;
  }
  length[0] = sqrt(length[0]);
  length[1] = oracle_min(sqrt(length[1]), 1.0);
  conic_oracle_mean_along(mixture, v, seen);
  direction_along(range, length, diffuse, l, nl);
  direction_along(range, length, seen, v, nv);
  cap(nl, 0.0, 1.0);
  least = oracle_min(nl[0] * nv[0], nl[1] * nv[0]);
  most = oracle_max(nl[0] * nv[1], nl[1] * nv[1]);
  cosine[0] = nl[0] > 0.0 ? 2.0 * least - oracle_dot(l, v) : 0.0;
  cosine[1] = nl[1] > 0.0 ? 2.0 * most - oracle_dot(l, v) : 0.0;
  cap(cosine, 0.0, 1.0);
  for (int side = 0; side < 2; side++) {
    result[side] = 0.15 * length[side] * length[side];
    for (int i = 0; i < 32; i++)
      result[side] *= cosine[side];
  }
}

static void add_scaled(double sum[2], double factor, const double range[2]) {
  sum[0] += factor * range[factor < 0.0];
  sum[1] += factor * range[!(factor < 0.0)];
}

/* What of the light from all around there may be in one channel. */
static void all_around_range(const conic_lighting *lighting, const oracle_mixture *mixture, int c, double range[2]) {
  double up[3] = {lighting->up[0], lighting->up[1], lighting->up[2]}, upwards[2];
  double sky = (double)lighting->sky[c], ground = (double)lighting->ground[c];
  range[0] = range[1] = sky;
  if (sky == ground)
    return;
  normalise(up);
  conic_oracle_mean_along(mixture, up, upwards);
  range[0] = range[1] = 0.5 * (sky + ground);
  /* NOLINTNEXTLINE(readability-suspicious-call-argument): the sum is the range */
  add_scaled(range, 0.5 * (sky - ground), upwards);
}

void conic_oracle_shade_range(const conic_camera *camera, const conic_render_options *options, double x, double y,
                              const oracle_mixture *mixture, const oracle_surface_range *range, double low[4],
                              double high[4]) {
  const conic_lighting lighting = lighting_of(options);
  double v[3], lit[3][2] = {{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}, glossy[3][2] = {{0.0}};
  int is_lit = options->shading != CONIC_SHADE_NONE;
  view_direction(camera, x, y, v);
  for (int c = 0; c < 3 && is_lit; c++)
    all_around_range(&lighting, mixture, c, lit[c]);
  for (int i = 0; i < lighting.n_lights && is_lit; i++) {
    const conic_light *light = &lighting.lights[i];
    double l[3], along[2], diffuse[2], highlight[2] = {0.0, 0.0};
    light_direction(camera, light, v, l);
    conic_oracle_mean_along(mixture, l, along);
    for (int side = 0; side < 2; side++)
      diffuse[side] = 0.75 * oracle_max(along[side], 0.0);
    if (options->shading == CONIC_SHADE_PHONG)
      highlight_range(mixture, range, l, v, along, highlight);
    for (int c = 0; c < 3; c++) {
      add_scaled(lit[c], (double)light->color[c], diffuse);
      add_scaled(glossy[c], (double)light->color[c], highlight);
    }
  }
  for (int c = 0; c < 3; c++) {
    double product[2] = {INFINITY, -INFINITY};
    for (int k = 0; k < 4; k++) {
      double p = range->albedo[k & 1][c] * lit[c][k >> 1];
      product[0] = oracle_min(product[0], p);
      product[1] = oracle_max(product[1], p);
    }
    low[c] = (product[0] + glossy[c][0]) * white(options);
    high[c] = (product[1] + glossy[c][1]) * white(options);
  }
  low[3] = high[3] = 1.0;
}

void conic_oracle_background(const conic_render_options *options, double rgba[4]) {
  for (int c = 0; c < 3; c++)
    rgba[c] = options->has_background ? (double)options->background[c] * white(options) : 0.0;
  rgba[3] = options->has_background ? 1.0 : 0.0;
}
