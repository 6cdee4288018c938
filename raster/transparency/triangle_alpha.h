/* How far triangles let light through. */
#ifndef CONIC_TRIANGLE_ALPHA_H
#define CONIC_TRIANGLE_ALPHA_H

#include "raster/triangles/triangle_pixel.h"

/* Whether a material does so anywhere. */
static inline int conic_material_is_transparent(const conic_material *material) {
  return material->alpha_mode != CONIC_ALPHA_OPAQUE &&
         (material->transparency > 0.0f || (material->texture && conic_texture_has_alpha(material->texture)));
}

/* Gives the colour of a triangle's sight its texture, and returns its alpha: 0 where it is not there. */
static inline float conic_triangle_lay_alpha(const conic_triangles *triangles, uint32_t index,
                                             conic_triangle_sight *sight) {
  const conic_material *material =
      triangles->n_materials ? &triangles->materials[triangles->material ? triangles->material[index] : 0] : NULL;
  if (!material || !conic_material_is_transparent(material)) {
    conic_triangle_lay_texture(sight);
    return 1.0f;
  }
  float alpha = 1.0f - material->transparency, rgba[4];
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

#endif
