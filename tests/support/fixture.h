/* What the tests that draw share: a context, a renderer, splats filled by hand, a camera, an image. */
#pragma once

#include "tests/support/check.h"

#define ALL_PLANES CONIC_DRAWN_PLANES

typedef struct fixture {
  conic_context *context;
  conic_renderer *renderer;
  conic_splats splats;
  conic_camera camera;
  conic_render_options options;
  conic_image image;
  conic_render_statistics statistics;
} fixture;

static inline fixture fixture_open(int threads) {
  fixture f;
  memset(&f, 0, sizeof f);
  f.context = check_context(threads);
  conic_render_options_init(&f.options);
  f.options.shading = CONIC_SHADE_NONE;
  if (conic_renderer_create(f.context, &f.renderer) != CONIC_OK)
    exit(1);
  return f;
}

static inline void fixture_close(fixture *f) {
  conic_image_release(f->context, &f->image);
  conic_splats_release(f->context, &f->splats);
  conic_renderer_destroy(f->renderer);
  conic_context_destroy(f->context);
}

/* A camera at the origin that looks along +z. */
static inline void fixture_camera(fixture *f, int width, int height, double focal_px) {
  memset(&f->camera, 0, sizeof f->camera);
  f->camera.width = width;
  f->camera.height = height;
  f->camera.fx = f->camera.fy = focal_px;
  f->camera.cx = 0.5 * width;
  f->camera.cy = 0.5 * height;
  for (int i = 0; i < 3; i++)
    f->camera.cam_from_world[i][i] = 1.0;
}

static inline void fixture_splats(fixture *f, size_t count) {
  conic_splats_release(f->context, &f->splats);
  if (conic_splats_allocate(f->context, count, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, &f->splats) != CONIC_OK)
    exit(1);
}

static inline void fixture_set(fixture *f, size_t i, const double p[3], const double tu[3], const double tv[3],
                               float red, float green, float blue) {
  const float color[3] = {red, green, blue};
  for (int axis = 0; axis < 3; axis++) {
    f->splats.position[axis][i] = (float)p[axis];
    f->splats.tangent_u[axis][i] = (float)tu[axis];
    f->splats.tangent_v[axis][i] = (float)tv[axis];
    f->splats.color[axis][i] = color[axis];
  }
}

/* Samples of an analytic scene, in place of splats set by hand. */
static inline void fixture_scene(fixture *f, conic_scene_type type, size_t count) {
  conic_scene_options options;
  conic_scene *scene;
  conic_scene_options_init(&options);
  options.type = type;
  options.count = count;
  conic_splats_release(f->context, &f->splats);
  CHECK_OK(conic_splats_allocate(f->context, count, conic_scene_fields(type), &f->splats));
  CHECK_OK(conic_scene_create(f->context, &options, &scene));
  CHECK_OK(conic_scene_sample(scene, 0, count, &f->splats));
  conic_scene_destroy(scene);
}

static inline void fixture_render(fixture *f) {
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &f->image));
  CHECK_OK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, &f->image, &f->statistics));
  CHECK(f->statistics.splats_in ==
        f->statistics.splats_culled + f->statistics.splats_skipped + f->statistics.splats_drawn);
}

static inline const float *fixture_pixel(const fixture *f, conic_plane plane, int x, int y) {
  const float *values = f->image.planes[plane];
  return values + ((size_t)y * (size_t)f->image.width + (size_t)x) * (size_t)conic_plane_describe(plane)->n_channels;
}

static inline uint32_t fixture_index(const fixture *f, conic_plane plane, int x, int y) {
  const uint32_t *values = f->image.planes[plane];
  return values[(size_t)y * (size_t)f->image.width + (size_t)x];
}

/* A small generator for test inputs: uniform in [0, 1). */
static inline double fixture_random(uint64_t *state) {
  *state += 0x9e3779b97f4a7c15u;
  uint64_t z = *state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}
