/* The scenes of the conformance suite: what each tests, how it is seen, and which profiles draw it. */
#pragma once

#include "conic/gaussian_render.h"

enum { SUITE_LEVELS = 6 };

/* The profiles: the numbers of conic_gaussian_profile, then "surface": surface splats by the method conic. */
enum { SUITE_SURFACE = CONIC_N_GAUSSIAN_PROFILES, SUITE_PROFILES };

const char *cli_suite_profile_name(int profile);
/* The profiles of an option's list NAME[,NAME], as bits; null: all. Returns 0 after a message where a name is unknown.
 */
unsigned cli_suite_find_profiles(const char *command, const char *list);

/* The formats of a scene besides .ply, as bits. */
enum { SUITE_SPZ = 1, SUITE_GLB = 2 };

/* What profiles draw a scene, as bits: by the shape that they give a Gaussian, fainter or not under their dilation; and
 * what they must have. */
enum {
  SUITE_OF_ELLIPSES = 1,
  SUITE_OF_FAINTER_ELLIPSES = 2,
  SUITE_OF_RAYS = 4,
  SUITE_OF_DISCS = 8,
  SUITE_OF_SURFELS = 16,
  SUITE_WITH_CENTER = 32, /* the camera's own principal point */
  SUITE_WITH_NEAR = 64    /* a near plane */
};

typedef struct suite_scene {
  const char *name, *about;
  int level; /* 1 to SUITE_LEVELS */
  int width, height;
  double focal[2], center[2]; /* in pixels */
  double rotation[4];         /* camera from world, a quaternion w, x, y, z of any length */
  double eye[3];              /* in the world */
  float background[3];
  unsigned drawn_by; /* of the bits above */
  unsigned formats;
  conic_status (*make)(conic_context *context, conic_gaussians *gaussians);
  conic_status (*make_splats)(conic_context *context, conic_splats *splats); /* for the profile surface; else null */
} suite_scene;

extern const suite_scene cli_suite_scenes[];
extern const int cli_n_suite_scenes;

/* The profiles that draw it, as bits 1 << profile. */
unsigned cli_suite_profiles(const suite_scene *scene);

/* What a level tests in a renderer, in a few words. */
const char *cli_suite_level_about(int level);

void cli_suite_camera(const suite_scene *scene, conic_camera *camera);
