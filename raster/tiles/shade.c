#include "raster/tiles/finish.h"

static float dot(const float a[3], const float b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static float at_least_zero(float x) {
  return x > 0.0f ? x : 0.0f;
}

/* x³² */
static float gloss(float x) {
  for (int i = 0; i < 5; i++)
    x *= x;
  return x;
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
  const float *light = options->has_light ? finish->light : viewer;
  float towards_light = dot(normal, light), glossy = 0.0f;
  float lit = CONIC_AMBIENT + CONIC_DIFFUSE * at_least_zero(dot(mean_normal, light));
  if (options->shading == CONIC_SHADE_PHONG && towards_light > 0.0f) {
    float reflected[3];
    for (int i = 0; i < 3; i++)
      reflected[i] = 2.0f * towards_light * normal[i] - light[i];
    glossy = CONIC_SPECULAR * gloss(at_least_zero(dot(reflected, viewer))) * dot(mean_normal, mean_normal);
  }
  for (int i = 0; i < 3; i++)
    shaded[i] = albedo[i] * lit + glossy;
}
