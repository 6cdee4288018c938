/* Layered point clouds for tests that draw: shells within shells, so that much is hidden, some of it but for splats
 * seen from their edge. */
#pragma once

#include "tests/support/fixture.h"

enum { LAYERS_SHELLS = 8, LAYERS_SHELL_SPLATS = 9000 };

/* Writes the cloud; ends the program where that fails. */
static inline void layers_build(conic_context *context, const char *path, uint32_t cloud_size) {
  conic_scene_options options;
  conic_layers_options layers_options;
  conic_layers_builder *builder;
  conic_scene *scene;
  conic_splats shell;
  conic_scene_options_init(&options);
  conic_layers_options_init(&layers_options);
  options.type = CONIC_SCENE_SPHERE;
  options.count = LAYERS_SHELL_SPLATS;
  layers_options.cloud_size = cloud_size;
  if (conic_scene_create(context, &options, &scene) != CONIC_OK ||
      conic_splats_allocate(context, options.count, conic_scene_fields(options.type), &shell) != CONIC_OK ||
      conic_layers_builder_open(context, path, &layers_options, &builder) != CONIC_OK)
    exit(1);
  for (int i_shell = 0; i_shell < LAYERS_SHELLS; i_shell++) {
    float radius = 1.0f - 0.12f * (float)i_shell;
    if (conic_scene_sample(scene, 0, options.count, &shell) != CONIC_OK)
      exit(1);
    for (size_t i = 0; i < shell.count; i++)
      for (int axis = 0; axis < 3; axis++) {
        shell.position[axis][i] *= radius;
        shell.tangent_u[axis][i] *= radius;
        shell.tangent_v[axis][i] *= radius;
        shell.color[axis][i] *= (float)((i_shell + axis) % 3) / 2.0f;
      }
    if (conic_layers_builder_append(builder, &shell) != CONIC_OK)
      exit(1);
  }
  if (conic_layers_builder_finish(builder, NULL) != CONIC_OK)
    exit(1);
  conic_splats_release(context, &shell);
  conic_scene_destroy(scene);
}

/* One frame of a cloud. */
typedef struct layers_frame {
  fixture f;
  conic_layers *layers;
  conic_layers_access access;
  conic_layers_draw_options draw;
  conic_layers_drawn drawn;
  conic_status status;
} layers_frame;

static inline layers_frame layers_open(int threads, const char *name, const conic_layers_access *access) {
  layers_frame frame;
  conic_framing framing;
  conic_layers_scale scale;
  memset(&frame, 0, sizeof frame);
  frame.f = fixture_open(threads);
  conic_layers_draw_options_init(&frame.draw);
  frame.status = conic_layers_open(frame.f.context, name, access, &frame.layers);
  if (frame.status != CONIC_OK)
    return frame;
  conic_layers_measure(frame.layers, 1.5f, &scale);
  conic_framing_init(&framing);
  framing.width = 200;
  framing.height = 160;
  CHECK_OK(conic_camera_frame(frame.f.context, &framing, scale.minimum, scale.maximum, &frame.f.camera));
  return frame;
}

/* How many pixels the disc of a sample covers about: no hole of a coarser picture is larger. */
static inline double layers_disc_pixels(const layers_frame *frame) {
  const conic_camera *camera = &frame->f.camera;
  conic_layers_scale scale;
  conic_layers_measure(frame->layers, 1.0f, &scale);
  double radius_px = scale.splat_length * camera->fx / camera->cam_from_world[2][3];
  return 3.14159 * radius_px * radius_px;
}

static inline void layers_close(layers_frame *frame) {
  conic_layers_close(frame->layers);
  fixture_close(&frame->f);
}

/* Draws the frame into its image, all planes. */
static inline conic_status layers_draw(layers_frame *frame) {
  fixture *f = &frame->f;
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &f->image));
  return conic_layers_draw(frame->layers, f->renderer, &f->camera, &f->options, &frame->draw, &f->image, &f->statistics,
                           &frame->drawn);
}

static inline int layers_same_picture(const conic_image *a, const conic_image *b) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (conic_image_hash(a, (conic_plane)i) != conic_image_hash(b, (conic_plane)i))
      return 0;
  return 1;
}
