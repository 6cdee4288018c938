/* What a triangle looks like (raster/triangles/triangle_pixel.h) lane by lane, with the same operations in the same
 * order. C and OpenCL C share this text. */
#pragma once

#include "core/lanes/lanes.h"
#include "raster/triangles/triangle_look.h"

/* A triangle's look at the pixels of a part. */
typedef struct look_places {
  lanes at[2], by_x[2], by_y[2];
} look_places;

CONIC_INLINE lanes affine_at(const conic_affine *f, lanes column, lanes row) {
  return (f->at + f->by_y * row) + f->by_x * column;
}

/* A value of the triangle's corners, the second's and third's less the first's. */
CONIC_INLINE lanes blend_corners(const lanes at[2], float first, float second, float third) {
  return first + (at[0] * second + at[1] * third);
}

CONIC_INLINE void find_places(const conic_triangle_look *look, lanes column, lanes row, look_places *p) {
  lanes iz = affine_at(&look->iz, column, row), zero = lanes_of(0.0f), one = lanes_of(1.0f);
  iz = lanes_min(lanes_max(iz, lanes_of(look->iz_far)), lanes_of(look->iz_near));
  lanes z = 1.0f / iz;
  const conic_affine *weights[2] = {&look->first, &look->second};
  for (int i = 0; i < 2; i++) {
    p->at[i] = lanes_min(lanes_max(affine_at(weights[i], column, row) * z, zero), one);
    p->by_x[i] = (weights[i]->by_x - p->at[i] * look->iz.by_x) * z;
    p->by_y[i] = (weights[i]->by_y - p->at[i] * look->iz.by_y) * z;
  }
  if (!look->is_piece)
    return;
  const look_places of_piece = *p;
  for (int i = 0; i < 2; i++) {
    p->at[i] = blend_corners(of_piece.at, look->at[0][i], look->at[1][i], look->at[2][i]);
    p->by_x[i] = of_piece.by_x[0] * look->at[1][i] + of_piece.by_x[1] * look->at[2][i];
    p->by_y[i] = of_piece.by_y[0] * look->at[1][i] + of_piece.by_y[1] * look->at[2][i];
  }
}

CONIC_INLINE lanes dot_of_lanes(const lanes a[3], const lanes b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

CONIC_INLINE void find_normals(const conic_triangle_look *look, const look_places *p, const float world_from_cam[3][3],
                               lanes dx, lanes dy, lanes normal[3]) {
  lanes ray[3], face[3];
  for (int axis = 0; axis < 3; axis++) {
    const float *m = world_from_cam[axis];
    ray[axis] = (m[0] * dx + m[1] * dy) + m[2];
    normal[axis] = face[axis] = lanes_of(look->face[axis]);
  }
  if (look->has_normals) {
    lanes mean[3];
    for (int axis = 0; axis < 3; axis++)
      mean[axis] = blend_corners(p->at, look->normal[0][axis], look->normal[1][axis], look->normal[2][axis]);
    lanes squared = (mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2],
          scale = lanes_of(look->side < 0.0f ? -1.0f : 1.0f) / lanes_sqrt(squared);
    lanes_mask is_usable = lanes_less(lanes_of(1e-30f), squared) & lanes_less(squared, lanes_of(1e30f));
    for (int axis = 0; axis < 3; axis++)
      normal[axis] = lanes_select(is_usable, mean[axis] * scale, normal[axis]);
  }
  lanes zero = lanes_of(0.0f);
  lanes_mask is_behind = lanes_less(zero, dot_of_lanes(face, ray));
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = lanes_select(is_behind, -normal[axis], normal[axis]);
  lanes away = dot_of_lanes(normal, ray), part = 2.0f * away / dot_of_lanes(ray, ray);
  lanes_mask is_away = lanes_less(zero, away);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = lanes_select(is_away, normal[axis] - part * ray[axis], normal[axis]);
}

/* The colours without the texture's. */
CONIC_INLINE void find_colors(const conic_triangle_look *look, const look_places *p, lanes color[3]) {
  for (int channel = 0; channel < 3; channel++)
    color[channel] = blend_corners(p->at, look->color[0][channel], look->color[1][channel], look->color[2][channel]);
}

/* Coordinate i of where the texture is seen, and how it changes along and across the picture. */
CONIC_INLINE void find_texture_places(const conic_triangle_look *look, const look_places *p, int i, lanes *uv,
                                      lanes *along, lanes *across) {
  *uv = blend_corners(p->at, look->uv[0][i], look->uv[1][i], look->uv[2][i]);
  *along = p->by_x[0] * look->uv[1][i] + p->by_x[1] * look->uv[2][i];
  *across = p->by_y[0] * look->uv[1][i] + p->by_y[1] * look->uv[2][i];
}
