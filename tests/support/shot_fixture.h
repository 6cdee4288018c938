/* What the tests of shots share: small scenes in files, their sources, and a shot that sees them. */
#pragma once

#include "conic/shot.h"
#include "tests/support/files.h"
#include "tests/support/fixture.h"

enum { SHOT_SPLATS, SHOT_MESH, SHOT_OCTREE, SHOT_LAYERS, SHOT_GAUSSIANS, SHOT_N_SCENES };

static char shot_paths[SHOT_N_SCENES][FOLDER_ROOM + 96];

/* A sheet of squares, some above others, so that they shade each other. */
static inline void shot_write_mesh(const char *path) {
  enum { SIDE = 12 };
  FILE *file = fopen(path, "w");
  for (int y = 0; y <= SIDE; y++)
    for (int x = 0; x <= SIDE; x++)
      fprintf(file, "v %g %g %g\n", (double)x / SIDE, 0.2 * ((x * y) % 5) / SIDE, (double)y / SIDE);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++)
      fprintf(file, "f %d %d %d %d\n", y * (SIDE + 1) + x + 1, (y + 1) * (SIDE + 1) + x + 1,
              (y + 1) * (SIDE + 1) + x + 2, y * (SIDE + 1) + x + 2);
  fclose(file);
}

static inline void shot_write_octree(conic_context *context, const conic_splats *splats, const char *path) {
  conic_octree_options options;
  conic_octree *octree;
  conic_splats copy = {0};
  conic_octree_options_init(&options);
  CHECK_OK(conic_splats_append(context, &copy, splats));
  CHECK_OK(conic_octree_build(context, &copy, &options, &octree));
  CHECK_OK(conic_octree_write(octree, path));
  conic_octree_destroy(octree);
}

/* Where there is no zstd, there are no layers: a second file of splats stands for them. */
static inline void shot_write_layers(conic_context *context, const conic_splats *splats, const char *path) {
  conic_layers_builder *builder;
  if (conic_layers_builder_open(context, path, NULL, &builder) == CONIC_ERROR_UNSUPPORTED) {
    snprintf(shot_paths[SHOT_LAYERS], sizeof shot_paths[SHOT_LAYERS], "%s", shot_paths[SHOT_SPLATS]);
    return;
  }
  CHECK_OK(conic_layers_builder_append(builder, splats));
  CHECK_OK(conic_layers_builder_finish(builder, NULL));
}

static inline void shot_write_gaussians(const char *path) {
  static const char *const properties[] = {"x",       "y",       "z",       "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
                                           "scale_0", "scale_1", "scale_2", "rot_0",  "rot_1",  "rot_2",  "rot_3"};
  enum { N = 60 };
  FILE *file = fopen(path, "wb");
  fprintf(file, "ply\nformat ascii 1.0\nelement vertex %d\n", N);
  for (size_t i = 0; i < sizeof properties / sizeof *properties; i++)
    fprintf(file, "property float %s\n", properties[i]);
  fprintf(file, "end_header\n");
  for (int i = 0; i < N; i++)
    fprintf(file, "%g %g %g %g %g 0.3 %g -2.5 -2 -3 1 0.1 %g 0\n", 0.1 * (i % 7), 0.1 * (i % 5), 0.05 * (i % 11),
            0.2 * (i % 3), -0.1 * (i % 4), 0.5 * (i % 3), 0.1 * (i % 6));
  fclose(file);
}

static inline void shot_write_scenes(conic_context *context) {
  static const char *const names[] = {"splats.ply", "mesh.obj", "tree.cot", "layers.lpc", "gaussians.ply"};
  fixture f = {.context = context};
  for (int i = 0; i < SHOT_N_SCENES; i++)
    snprintf(shot_paths[i], sizeof shot_paths[i], "%s", files_path(names[i]));
  fixture_scene(&f, CONIC_SCENE_KNOT, 3000);
  CHECK_OK(conic_splats_write(context, shot_paths[SHOT_SPLATS], &f.splats, NULL));
  shot_write_mesh(shot_paths[SHOT_MESH]);
  shot_write_octree(context, &f.splats, shot_paths[SHOT_OCTREE]);
  shot_write_layers(context, &f.splats, shot_paths[SHOT_LAYERS]);
  shot_write_gaussians(shot_paths[SHOT_GAUSSIANS]);
  conic_splats_release(context, &f.splats);
}

/* Ends the program where it cannot be opened. */
static inline conic_source *shot_open(conic_context *context, int scene) {
  const char *path = shot_paths[scene];
  conic_source_options options;
  conic_gaussian_options gaussians;
  conic_source *source;
  conic_source_options_init(&options);
  conic_gaussian_options_init(&gaussians);
  options.as = scene == SHOT_MESH ? CONIC_AS_MESH : options.as;
  options.gaussians = scene == SHOT_GAUSSIANS ? &gaussians : NULL;
  if (conic_source_open(context, &path, 1, &options, &source) != CONIC_OK) {
    fprintf(stderr, "%s: %s\n", path, files_message);
    exit(1);
  }
  return source;
}

/* A shot of that size, of a camera that sees all. */
static inline conic_shot shot_of(conic_source *source, conic_camera_kind kind, int width, int height) {
  conic_shot_framing framing;
  conic_shot shot;
  conic_shot_init(&shot);
  conic_shot_framing_init(&framing);
  framing.framing.width = width;
  framing.framing.height = height;
  framing.kind = kind;
  CHECK_OK(conic_shot_frame(source, &framing, &shot));
  return shot;
}
