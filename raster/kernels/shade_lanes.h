/* conic_shade (raster/tiles/shade.c) lane by lane, with the same operations in the same order. C and OpenCL C share
 * this text. */
#ifndef CONIC_SHADE_LANES_H
#define CONIC_SHADE_LANES_H

#include "core/lanes/lanes.h"
#include "raster/tiles/finish.h"

CONIC_INLINE lanes dot_lanes(const lanes a[3], const lanes b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* conic_shade, but for CONIC_SHADE_NONE. */
CONIC_INLINE void shade_lanes(const conic_finish *finish, const lanes albedo[3], const lanes normal[3],
                              const lanes mean_normal[3], const lanes viewer[3], lanes shaded[3]) {
  const conic_render_options *options = finish->options;
  lanes zero = lanes_of(0.0f), light[3], glossy = zero;
  for (int i = 0; i < 3; i++)
    light[i] = options->has_light ? lanes_of(finish->light[i]) : viewer[i];
  lanes towards_light = dot_lanes(normal, light);
  lanes lit = CONIC_AMBIENT + CONIC_DIFFUSE * lanes_max(dot_lanes(mean_normal, light), zero);
  if (options->shading == CONIC_SHADE_PHONG) {
    lanes reflected[3];
    for (int i = 0; i < 3; i++)
      reflected[i] = 2.0f * towards_light * normal[i] - light[i];
    lanes gloss = lanes_max(dot_lanes(reflected, viewer), zero);
    for (int i = 0; i < 5; i++)
      gloss *= gloss;
    glossy = lanes_keep(lanes_less(zero, towards_light), CONIC_SPECULAR * gloss * dot_lanes(mean_normal, mean_normal));
  }
  for (int i = 0; i < 3; i++)
    shaded[i] = albedo[i] * lit + glossy;
}

/* The unit directions to the viewer, in the world, from where pixels look along (dx, dy, 1). */
CONIC_INLINE void look_back(const float world_from_cam[3][3], lanes dx, lanes dy, lanes viewer[3]) {
  lanes scale = -1.0f / lanes_sqrt((dx * dx + dy * dy) + 1.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = world_from_cam[i];
    viewer[i] = ((m[0] * dx + m[1] * dy) + m[2]) * scale;
  }
}

#endif
