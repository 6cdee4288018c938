/* Scenes that lamps and suns light, for their tests. */
#pragma once

#include "tests/support/light_fixture.h"

enum { LAMP_PLANES = LIGHT_PLANES | 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ALBEDO };

/* A scene that only lamps light, matt. */
typedef struct lamp_scene {
  light_drawer drawer;
  conic_casters casters;
  light_picture picture;
  conic_lighting_options options;
  conic_lamp lamp;
} lamp_scene;

static inline void lamp_scene_open(conic_context *context, const conic_drawing *drawing, double epsilon,
                                   lamp_scene *s) {
  *s = (lamp_scene){.drawer = {.context = context, .drawing = drawing}};
  CHECK_OK(conic_renderer_create(context, &s->drawer.renderer));
  conic_render_options_init(&s->drawer.options);
  s->drawer.options.shading = CONIC_SHADE_LAMBERT;
  s->drawer.options.lighting.is_given = 1;
  conic_lighting_options_init(&s->options);
  s->options.has_shadows = 1;
  s->options.lamps = &s->lamp;
  s->options.n_lamps = 1;
  s->casters = light_casters(&s->drawer, epsilon);
  s->lamp.color[0] = s->lamp.color[1] = s->lamp.color[2] = 1.0f;
}

static inline void lamp_scene_close(lamp_scene *s) {
  conic_renderer_destroy(s->drawer.renderer);
}

static inline void lamp_scene_drop(lamp_scene *s) {
  conic_image_release(s->drawer.context, &s->picture.image);
}

static inline void lamp_scene_light(lamp_scene *s) {
  CHECK_OK(conic_image_light(s->drawer.context, &s->casters, &s->picture.camera, &s->drawer.options, &s->options,
                             &s->picture.image));
}

static inline const float *lamp_plane(const lamp_scene *s, conic_plane plane) {
  return s->picture.image.planes[plane];
}

/* From a place towards the lamp's middle, a unit vector; returns how far it is. */
static inline double lamp_towards(const lamp_scene *s, const double place[3], double towards[3]) {
  double square = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    towards[axis] = s->lamp.position[axis] - place[axis];
    square += towards[axis] * towards[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    towards[axis] /= sqrt(square);
  return sqrt(square);
}

static inline double lamp_product(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline conic_triangles lamp_floor(conic_context *context, double (*height)(double x, double z)) {
  conic_triangles mesh = light_mesh(context, 2 * 8 * 8);
  light_field(&mesh, 8, 3.0, height);
  return mesh;
}
