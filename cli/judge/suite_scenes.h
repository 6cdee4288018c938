/* The scenes of the conformance suite: what each is about, how it is seen, and whose profiles draw it. */
#ifndef CONIC_SUITE_SCENES_H
#define CONIC_SUITE_SCENES_H

#include "conic/gaussian_render.h"

enum { SUITE_LEVELS = 5 };

/* The formats of a scene besides .ply, as bits. */
enum { SUITE_SPZ = 1, SUITE_GLB = 2 };

typedef struct suite_scene {
  const char *name, *about;
  int level; /* 1 to SUITE_LEVELS */
  int width, height;
  double focal[2], center[2]; /* in pixels */
  double rotation[4];         /* camera from world, a quaternion w, x, y, z of any length */
  double eye[3];              /* in the world */
  float background[3];
  unsigned profiles; /* bits 1 << conic_gaussian_profile */
  unsigned formats;
  conic_status (*make)(conic_context *context, conic_gaussians *gaussians);
} suite_scene;

extern const suite_scene cli_suite_scenes[];
extern const int cli_n_suite_scenes;

/* What a level asks of a renderer, in a few words. */
const char *cli_suite_level_about(int level);

void cli_suite_camera(const suite_scene *scene, conic_camera *camera);

#endif
