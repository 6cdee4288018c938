#include "raster/tiles/finish.h"

#include <math.h>

#include "core/splats/float_vectors.h"

static float at_least_zero(float x) {
  return x > 0.0f ? x : 0.0f;
}

/* x³² */
static float gloss(float x) {
  for (int i = 0; i < 5; i++)
    x *= x;
  return x;
}

/* What one light adds to the light that falls on a surface, and to what is reflected like a gloss. */
static void add_light(const conic_finish_light *light, conic_shading shading, const float normal[3],
                      const float mean_normal[3], const float viewer[3], float lit[3], float glossy[3]) {
  const float *towards = light->is_head ? viewer : light->towards;
  float facing = at_least_zero(conic_float_dot(mean_normal, towards)), along = conic_float_dot(normal, towards);
  for (int i = 0; i < 3; i++)
    lit[i] += light->diffuse[i] * facing;
  if (shading != CONIC_SHADE_PHONG || !(along > 0.0f))
    return;
  float reflected[3], agreement = conic_float_dot(mean_normal, mean_normal);
  for (int i = 0; i < 3; i++)
    reflected[i] = 2.0f * along * normal[i] - towards[i];
  float shine = gloss(at_least_zero(conic_float_dot(reflected, viewer)));
  for (int i = 0; i < 3; i++)
    glossy[i] += light->specular[i] * shine * agreement;
}

/* Where normals disagree, their mean is short. The light is averaged by the mean itself, not by its direction: at a
 * silhouette, splats of the front and of the back blend, both seen almost edge-on and both flipped to the viewer; what
 * is left of their sum points straight at the viewer, and normalised would draw a bright rim. */
void conic_shade(const conic_finish *finish, const float albedo[3], const float normal[3], const float mean_normal[3],
                 const float viewer[3], float shaded[3]) {
  const conic_render_options *options = finish->options;
  if (options->shading == CONIC_SHADE_NONE) {
    for (int i = 0; i < 3; i++)
      shaded[i] = albedo[i];
    return;
  }
  const conic_finish_lights *lights = finish->lights;
  float lit[3] = {lights->ambient[0], lights->ambient[1], lights->ambient[2]}, glossy[3] = {0.0f, 0.0f, 0.0f};
  if (lights->has_sky) {
    float upward = conic_float_dot(mean_normal, lights->up);
    for (int i = 0; i < 3; i++)
      lit[i] += lights->slope[i] * upward;
  }
  for (int i = 0; i < lights->n_lights; i++)
    add_light(&lights->lights[i], options->shading, normal, mean_normal, viewer, lit, glossy);
  for (int i = 0; i < 3; i++)
    shaded[i] = albedo[i] * lit[i] + glossy[i];
}

/* The unit direction from what is seen at the pixel to the viewer, in world coordinates. */
static void viewer_at(const conic_finish *finish, float dx, float dy, float viewer[3]) {
  float scale = -1.0f / sqrtf((dx * dx + dy * dy) + 1.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = finish->world_from_cam[i];
    viewer[i] = ((m[0] * dx + m[1] * dy) + m[2]) * scale;
  }
}

void conic_finish_covered(const conic_finish *finish, float weight, const float color_sum[3], const float normal_sum[3],
                          const float heaviest_normal[3], float dx, float dy, conic_finished_pixel *pixel) {
  float viewer[3], mean_normal[3], shaded[3], part = 1.0f / weight;
  for (int axis = 0; axis < 3; axis++) {
    pixel->albedo[axis] = color_sum[axis] * part;
    mean_normal[axis] = normal_sum[axis] * part;
  }
  float norm = sqrtf(conic_float_dot(mean_normal, mean_normal)), scale = 1.0f / norm;
  for (int axis = 0; axis < 3; axis++)
    pixel->normal[axis] = norm > 0.0f ? mean_normal[axis] * scale : heaviest_normal[axis];
  viewer_at(finish, dx, dy, viewer);
  conic_shade(finish, pixel->albedo, pixel->normal, mean_normal, viewer, shaded);
  for (int axis = 0; axis < 3; axis++)
    pixel->rgba[axis] = shaded[axis] * finish->exposure;
  pixel->rgba[3] = 1.0f;
}

void conic_finish_uncovered(const conic_finish *finish, conic_finished_pixel *pixel) {
  for (int channel = 0; channel < 4; channel++)
    pixel->rgba[channel] = finish->background[channel];
  for (int axis = 0; axis < 3; axis++)
    pixel->normal[axis] = pixel->albedo[axis] = 0.0f;
}
