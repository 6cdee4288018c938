/* How far triangles let light through. */
#pragma once

#include "raster/triangles/triangle_pixel.h"

/* Whether a material, null: white, does so anywhere on these triangles. */
static inline int conic_material_is_transparent(const conic_triangles *triangles, const conic_material *material) {
  if (!material)
    return triangles->alpha != NULL;
  return material->alpha_mode != CONIC_ALPHA_OPAQUE &&
         (material->transparency > 0.0f || triangles->alpha ||
          (material->texture && conic_texture_has_alpha(material->texture)));
}

/* The vertices' alpha where a triangle is seen. Of what is not a number, nothing is. */
static inline float conic_triangle_vertex_alpha(const conic_triangles *triangles, uint32_t index,
                                                const conic_triangle_sight *sight) {
  const uint32_t *corners = triangles->corners[index];
  const float *alpha = triangles->alpha;
  if (!alpha)
    return 1.0f;
  float first = alpha[corners[0]],
        value = first + (sight->at[0] * (alpha[corners[1]] - first) + sight->at[1] * (alpha[corners[2]] - first));
  return value > 0.0f ? value < 1.0f ? value : 1.0f : 0.0f;
}

/* Gives the colour of a triangle's sight its texture, and returns its alpha: 0 where it is not there. */
static inline float conic_triangle_lay_alpha(const conic_triangles *triangles, uint32_t index,
                                             conic_triangle_sight *sight) {
  const conic_material *material =
      triangles->n_materials ? &triangles->materials[triangles->material ? triangles->material[index] : 0] : NULL;
  if (!conic_material_is_transparent(triangles, material)) {
    conic_triangle_lay_texture(sight);
    return 1.0f;
  }
  float alpha = conic_triangle_vertex_alpha(triangles, index, sight), rgba[4];
  if (!material)
    return alpha;
  alpha *= 1.0f - material->transparency;
  if (sight->texture) {
    conic_texture_sample_rgba(sight->texture, sight->uv, sight->along, sight->across, rgba);
    for (int channel = 0; channel < 3; channel++)
      sight->color[channel] *= rgba[channel];
    alpha *= rgba[3];
    sight->texture = NULL;
  }
  if (material->alpha_mode == CONIC_ALPHA_MASK)
    return alpha >= material->alpha_cutoff ? 1.0f : 0.0f;
  return alpha;
}
