/* Between conic and the plain renderers, which know nothing of it: cameras and pictures. */
#pragma once

#include <string.h>

#include "conic/camera.h"
#include "conic/image.h"
#include "tests/judge/plain_scene.h"
#include "tests/support/check.h"

static inline plain_camera plain_camera_of(const conic_camera *from) {
  plain_camera c = {from->width,     from->height,    (float)from->fx, (float)from->fy,
                    (float)from->cx, (float)from->cy, {{0.0f}}};
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 4; k++)
      c.view[row][k] = (float)from->cam_from_world[row][k];
  return c;
}

/* Has these of rgba, Z, count and T; the caller releases it. */
static inline conic_image image_of_plain(conic_context *context, const plain_picture *p, unsigned planes) {
  const size_t n = (size_t)p->width * (size_t)p->height;
  conic_image image;
  CHECK_OK(conic_image_allocate(context, p->width, p->height, planes, &image));
  uint32_t *count = image.planes[CONIC_PLANE_COUNT];
  for (size_t i = 0; i < n; i++) {
    float *rgba = (float *)image.planes[CONIC_PLANE_RGBA] + 4 * i;
    memcpy(rgba, p->rgb + 3 * i, 3 * sizeof *rgba);
    rgba[3] = p->alpha[i];
    if (count)
      count[i] = (uint32_t)p->count[i];
  }
  memcpy(image.planes[CONIC_PLANE_Z], p->z, n * sizeof(float));
  if (image.planes[CONIC_PLANE_TRANSPARENCY])
    memcpy(image.planes[CONIC_PLANE_TRANSPARENCY], p->T, n * sizeof(float));
  return image;
}
