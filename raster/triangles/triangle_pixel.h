/* What a triangle looks like at one pixel. Shared by plain C and by a device's programs (opencl/triangles.cl);
 * triangle_body.h does the same in lanes. */
#pragma once

#include <math.h>

#include "core/splats/float_vectors.h"
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

/* The unit normal, towards the viewer, who looks along (dx, dy, 1). Corners' normals lie on the side of the face that
 * is seen, and where their mean leans away even so, as near an outline, it is mirrored in the plane across the ray:
 * turned round it would point the other way at once, and light would jump. */
static inline void conic_triangle_look_normal(const conic_triangle_look *look, const conic_triangle_weights *w,
                                              const float world_from_cam[3][3], float dx, float dy, float normal[3]) {
  float ray[3];
  for (int axis = 0; axis < 3; axis++) {
    const float *m = world_from_cam[axis];
    ray[axis] = (m[0] * dx + m[1] * dy) + m[2];
    normal[axis] = look->face[axis];
  }
  if (look->has_normals) {
    float mean[3], scale;
    for (int axis = 0; axis < 3; axis++)
      mean[axis] = look->normal[0][axis] + (w->at[0] * look->normal[1][axis] + w->at[1] * look->normal[2][axis]);
    float squared = (mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2];
    scale = (look->side < 0.0f ? -1.0f : 1.0f) / sqrtf(squared);
    for (int axis = 0; axis < 3 && squared > 1e-30f && squared < 1e30f; axis++)
      normal[axis] = mean[axis] * scale;
  }
  int is_behind = conic_float_dot(look->face, ray) > 0.0f;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = is_behind ? -normal[axis] : normal[axis];
  float away = conic_float_dot(normal, ray), part = 2.0f * away / conic_float_dot(ray, ray);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = away > 0.0f ? normal[axis] - part * ray[axis] : normal[axis];
}

/* What a pixel sees of its triangle; where there is a texture, the colour without it, and where it is seen. */
typedef struct conic_triangle_sight {
  float color[3], normal[3];
  float at[2];                  /* the weights of the triangle's second and third corner */
  const conic_texture *texture; /* null: none */
  float uv[2], along[2], across[2];
} conic_triangle_sight;

/* A covered pixel's, which looks along the ray (x, y, 1). */
static inline void conic_triangle_see(const conic_triangle_frame *frame, const conic_triangle_record *record,
                                      const float world_from_cam[3][3], int x, int y, const float ray[2],
                                      conic_triangle_sight *sight) {
  int column = x % CONIC_BLOCK_EDGE, row = y % CONIC_BLOCK_EDGE;
  conic_triangle_look look;
  conic_triangle_weights weights;
  conic_triangle_look_at(frame, record, x - column, y - row, &look);
  conic_triangle_weights_at(&look, (float)column, (float)row, &weights);
  conic_triangle_look_plain_color(&look, &weights, sight->color);
  conic_triangle_look_normal(&look, &weights, world_from_cam, ray[0], ray[1], sight->normal);
  int is_swapped = record->is_swapped && record->piece == CONIC_NO_PIECE;
  sight->at[0] = weights.at[is_swapped];
  sight->at[1] = weights.at[!is_swapped];
  sight->texture = look.texture;
  if (look.texture)
    conic_triangle_look_place(&look, &weights, sight->uv, sight->along, sight->across);
}

/* Gives the colour its texture. */
static inline void conic_triangle_lay_texture(conic_triangle_sight *sight) {
  float texel[3];
  if (!sight->texture)
    return;
  conic_texture_sample(sight->texture, sight->uv, sight->along, sight->across, texel);
  for (int channel = 0; channel < 3; channel++)
    sight->color[channel] *= texel[channel];
  sight->texture = NULL;
}
