/* What a triangle looks like at one pixel. Shared by plain C and by a device's programs (opencl/triangles.cl);
 * triangle_body.h does the same in lanes. */
#ifndef CONIC_TRIANGLE_PIXEL_H
#define CONIC_TRIANGLE_PIXEL_H

#include <math.h>

#include "raster/triangles/triangle_look.h"

/* The weights of the triangle's second and third corner at a pixel of the block, and how they change from pixel to
 * pixel. */
typedef struct conic_triangle_weights {
  float at[2], by_x[2], by_y[2];
} conic_triangle_weights;

static inline void conic_triangle_weights_at(const conic_triangle_look *look, float column, float row,
                                             conic_triangle_weights *w) {
  float iz = conic_affine_at(&look->iz, column, row), at[2], by_x[2], by_y[2];
  iz = iz > look->iz_far ? iz : look->iz_far;
  iz = iz < look->iz_near ? iz : look->iz_near;
  float z = 1.0f / iz;
  const conic_affine *weights[2] = {&look->first, &look->second};
  for (int i = 0; i < 2; i++) {
    at[i] = conic_affine_at(weights[i], column, row) * z;
    at[i] = at[i] > 0.0f ? at[i] : 0.0f;
    at[i] = at[i] < 1.0f ? at[i] : 1.0f;
    by_x[i] = (weights[i]->by_x - at[i] * look->iz.by_x) * z;
    by_y[i] = (weights[i]->by_y - at[i] * look->iz.by_y) * z;
  }
  for (int i = 0; i < 2; i++) {
    w->at[i] = look->is_piece ? look->at[0][i] + (at[0] * look->at[1][i] + at[1] * look->at[2][i]) : at[i];
    w->by_x[i] = look->is_piece ? by_x[0] * look->at[1][i] + by_x[1] * look->at[2][i] : by_x[i];
    w->by_y[i] = look->is_piece ? by_y[0] * look->at[1][i] + by_y[1] * look->at[2][i] : by_y[i];
  }
}

/* Without the texture's. */
static inline void conic_triangle_look_plain_color(const conic_triangle_look *look, const conic_triangle_weights *w,
                                                   float color[3]) {
  for (int channel = 0; channel < 3; channel++)
    color[channel] =
        look->color[0][channel] + (w->at[0] * look->color[1][channel] + w->at[1] * look->color[2][channel]);
}

/* Where the pixel sees the texture: as conic_texture_sample takes it. */
static inline void conic_triangle_look_place(const conic_triangle_look *look, const conic_triangle_weights *w,
                                             float uv[2], float along[2], float across[2]) {
  for (int i = 0; i < 2; i++) {
    uv[i] = look->uv[0][i] + (w->at[0] * look->uv[1][i] + w->at[1] * look->uv[2][i]);
    along[i] = w->by_x[0] * look->uv[1][i] + w->by_x[1] * look->uv[2][i];
    across[i] = w->by_y[0] * look->uv[1][i] + w->by_y[1] * look->uv[2][i];
  }
}

static inline void conic_triangle_look_color(const conic_triangle_look *look, const conic_triangle_weights *w,
                                             float color[3]) {
  float uv[2], along[2], across[2], texel[3];
  conic_triangle_look_plain_color(look, w, color);
  if (!look->texture)
    return;
  conic_triangle_look_place(look, w, uv, along, across);
  conic_texture_sample(look->texture, uv, along, across, texel);
  for (int channel = 0; channel < 3; channel++)
    color[channel] *= texel[channel];
}

/* The unit normal, towards the viewer, who looks along (dx, dy, 1). */
static inline void conic_triangle_look_normal(const conic_triangle_look *look, const conic_triangle_weights *w,
                                              const float world_from_cam[3][3], float dx, float dy, float normal[3]) {
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = look->face[axis];
  if (look->has_normals) {
    float mean[3], scale;
    for (int axis = 0; axis < 3; axis++)
      mean[axis] = look->normal[0][axis] + (w->at[0] * look->normal[1][axis] + w->at[1] * look->normal[2][axis]);
    float squared = (mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2];
    scale = 1.0f / sqrtf(squared);
    for (int axis = 0; axis < 3 && squared > 1e-30f && squared < 1e30f; axis++)
      normal[axis] = mean[axis] * scale;
  }
  float away = 0.0f;
  for (int i = 0; i < 3; i++) {
    const float *m = world_from_cam[i];
    away += normal[i] * ((m[0] * dx + m[1] * dy) + m[2]);
  }
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = away > 0.0f ? -normal[axis] : normal[axis];
}

#endif
