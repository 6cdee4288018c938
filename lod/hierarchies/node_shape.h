/* Normals and sizes for points that come without: found from their neighbours in the node. */
#pragma once

#include "core/base/base.h"

typedef struct conic_node_shape {
  const uint64_t *keys; /* 63-bit Morton codes, ascending */
  const float *position[3];
  size_t n;
  double step;      /* of the keys, in the positions' units: no axis has a shorter one */
  float *normal[3]; /* set: the direction of least spread, turned upwards; zero where neighbours lie in no plane */
  float *spacing;   /* set: the distance of neighbours there, √(area a point); 0: there are none */
} conic_node_shape;

/* One thread. Fills in normals and spacings; *median becomes the lower median of the spacings above 0, or 0. The same
 * points give the same bits everywhere. Errors: MEMORY. */
conic_status conic_node_shape_find(conic_context *context, const conic_node_shape *shape, float *median);
