/* What lights add to a surface, as conic_shade and the loops of lighting sum it up: without branches that differ from
 * pixel to pixel, so that lanes can share the text. */
#pragma once

#include "core/splats/float_vectors.h"
#include "raster/tiles/finish.h"

/* The light from all around. */
static inline void conic_light_from_around(const conic_finish_lights *lights, const float mean_normal[3],
                                           float lit[3]) {
  float upward = conic_float_dot(mean_normal, lights->up);
  for (int i = 0; i < 3; i++)
    lit[i] = lights->has_sky ? lights->ambient[i] + lights->slope[i] * upward : lights->ambient[i];
}

/* x³² for a positive x, else 0 */
static inline float conic_gloss(float x) {
  x = x > 0.0f ? x : 0.0f;
  for (int i = 0; i < 5; i++)
    x *= x;
  return x;
}

/* What one light adds to the light that falls on a surface, and to what is reflected like a gloss. */
static inline void conic_light_add(const conic_finish_light *light, int is_phong, const float normal[3],
                                   const float mean_normal[3], const float viewer[3], float lit[3], float glossy[3]) {
  float towards[3], reflected[3];
  for (int i = 0; i < 3; i++)
    towards[i] = light->is_head ? viewer[i] : light->towards[i];
  float facing = conic_float_dot(mean_normal, towards), along = conic_float_dot(normal, towards);
  facing = facing > 0.0f ? facing : 0.0f;
  for (int i = 0; i < 3; i++)
    lit[i] += light->diffuse[i] * facing;
  if (!is_phong)
    return;
  for (int i = 0; i < 3; i++)
    reflected[i] = 2.0f * along * normal[i] - towards[i];
  float agreement = conic_float_dot(mean_normal, mean_normal), shine = conic_gloss(conic_float_dot(reflected, viewer));
  for (int i = 0; i < 3; i++) {
    float sum = glossy[i] + light->specular[i] * shine * agreement;
    glossy[i] = along > 0.0f ? sum : glossy[i];
  }
}
