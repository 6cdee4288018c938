/* conic_shade (raster/tiles/shade.c) lane by lane, with the same operations in the same order. C and OpenCL C share
 * this text. */
#pragma once

#include "core/lanes/lanes.h"
#include "raster/tiles/finish.h"

CONIC_INLINE lanes dot_lanes(const lanes a[3], const lanes b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* add_light of raster/tiles/shade.c. */
CONIC_INLINE void add_light_lanes(const conic_finish_light *light, conic_shading shading, int n_channels,
                                  const lanes normal[3], const lanes mean_normal[3], const lanes viewer[3],
                                  lanes lit[3], lanes glossy[3]) {
  lanes zero = lanes_of(0.0f), towards[3], reflected[3];
  for (int i = 0; i < 3; i++)
    towards[i] = light->is_head ? viewer[i] : lanes_of(light->towards[i]);
  lanes facing = lanes_max(dot_lanes(mean_normal, towards), zero), along = dot_lanes(normal, towards);
  for (int i = 0; i < n_channels; i++)
    lit[i] += light->diffuse[i] * facing;
  if (shading != CONIC_SHADE_PHONG)
    return;
  for (int i = 0; i < 3; i++)
    reflected[i] = 2.0f * along * normal[i] - towards[i];
  lanes shine = lanes_max(dot_lanes(reflected, viewer), zero), agreement = dot_lanes(mean_normal, mean_normal);
  for (int i = 0; i < 5; i++)
    shine *= shine;
  for (int i = 0; i < n_channels; i++)
    glossy[i] += lanes_keep(lanes_less(zero, along), light->specular[i] * shine * agreement);
}

/* The first channels of the light that falls on a surface and of what is reflected like a gloss. */
CONIC_INLINE void light_lanes(const conic_finish *finish, int n_channels, const lanes normal[3],
                              const lanes mean_normal[3], const lanes viewer[3], lanes lit[3], lanes glossy[3]) {
  const conic_finish_lights *lights = finish->lights;
  for (int i = 0; i < n_channels; i++) {
    glossy[i] = lanes_of(0.0f);
    lit[i] = lanes_of(lights->ambient[i]);
  }
  if (lights->has_sky) {
    const lanes up[3] = {lanes_of(lights->up[0]), lanes_of(lights->up[1]), lanes_of(lights->up[2])};
    lanes upward = dot_lanes(mean_normal, up);
    for (int i = 0; i < n_channels; i++)
      lit[i] += lights->slope[i] * upward;
  }
  for (int i = 0; i < lights->n_lights; i++)
    add_light_lanes(&lights->lights[i], finish->options->shading, n_channels, normal, mean_normal, viewer, lit, glossy);
}

/* conic_shade, but for CONIC_SHADE_NONE. Where all light is white or grey, one channel is all three. */
CONIC_INLINE void shade_lanes(const conic_finish *finish, const lanes albedo[3], const lanes normal[3],
                              const lanes mean_normal[3], const lanes viewer[3], lanes shaded[3]) {
  lanes lit[3], glossy[3];
  if (finish->lights->is_grey) {
    light_lanes(finish, 1, normal, mean_normal, viewer, lit, glossy);
    for (int i = 0; i < 3; i++)
      shaded[i] = albedo[i] * lit[0] + glossy[0];
    return;
  }
  light_lanes(finish, 3, normal, mean_normal, viewer, lit, glossy);
  for (int i = 0; i < 3; i++)
    shaded[i] = albedo[i] * lit[i] + glossy[i];
}

/* The unit directions to the viewer, in the world, from where pixels look along (dx, dy, 1). */
CONIC_INLINE void look_back(const float world_from_cam[3][3], lanes dx, lanes dy, lanes viewer[3]) {
  lanes scale = -1.0f / lanes_sqrt((dx * dx + dy * dy) + 1.0f);
  for (int i = 0; i < 3; i++) {
    const float *m = world_from_cam[i];
    viewer[i] = ((m[0] * dx + m[1] * dy) + m[2]) * scale;
  }
}
