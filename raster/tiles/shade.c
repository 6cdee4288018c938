#include <math.h>

#include "raster/tiles/light_terms.h"

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
  float lit[3], glossy[3] = {0.0f, 0.0f, 0.0f};
  conic_light_from_around(lights, mean_normal, lit);
  for (int i = 0; i < lights->n_lights; i++)
    conic_light_add(&lights->lights[i], options->shading == CONIC_SHADE_PHONG, normal, mean_normal, viewer, lit,
                    glossy);
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
