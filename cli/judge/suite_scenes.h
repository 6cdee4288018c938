/* The scenes of the conformance suite: what each tests, how it is seen, and which profiles draw it. */
#pragma once

#include "conic/gaussian_intermediates.h"

enum { SUITE_LEVELS = 7 };

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
  SUITE_WITH_NEAR = 64,   /* a near plane */
  SUITE_WITH_TILES = 128  /* lists of tiles */
};

/* Gaussians by chance: n of them about a place, of a size, an opacity and bands of harmonics. */
typedef struct suite_recipe {
  size_t n;
  double place[3], spread[3], size[3]; /* size: times ½ to 1½, where they are turned by chance */
  double rotation[4];                  /* zeros: by chance */
  double opacity[2];                   /* from, to */
  double brightness;                   /* 0: 1 */
  unsigned bands;                      /* bits 1 << degree, besides degree 0 */
} suite_recipe;

struct khr_asset;

typedef struct suite_scene { /* NOLINT(clang-analyzer-optin.performance.Padding): in the order of the tables */
  const char *name, *about;
  int level; /* 1 to SUITE_LEVELS */
  int width, height;
  double focal[2], center[2]; /* in pixels */
  double rotation[4];         /* camera from world, a quaternion w, x, y, z of any length */
  double eye[3];              /* in the world */
  float background[3];
  unsigned drawn_by; /* of the bits above */
  unsigned formats;
  conic_gaussian_stage stage; /* of a renderer, that it tests most */
  int step;                   /* every so many pixels are judged, in x and in y; 0: all */
  suite_recipe recipe;        /* n 0: it is made by the next */
  conic_status (*make)(conic_context *context, conic_gaussians *gaussians);  /* null: by the recipe */
  conic_status (*make_splats)(conic_context *context, conic_splats *splats); /* for the profile surface; else null */
  const struct khr_asset *asset;                                             /* of the Khronos pack; else null */
} suite_scene;

extern const suite_scene cli_suite_scenes[];
extern const int cli_n_suite_scenes;

/* The profiles that draw it, as bits 1 << profile. */
unsigned cli_suite_profiles(const suite_scene *scene);

/* What a level tests in a renderer, in a few words. */
const char *cli_suite_level_about(int level);

/* Makes its Gaussians. Errors: MEMORY. */
conic_status cli_suite_make(conic_context *context, const suite_scene *scene, conic_gaussians *gaussians);

/* Of a side of so many pixels, how many are judged, and the i-th of them. */
static inline int cli_suite_judged(int n, int step) {
  return step ? (n - step / 2 + step - 1) / step : n;
}
static inline int cli_suite_judged_at(int i, int step) {
  return step ? i * step + step / 2 : i;
}

void cli_suite_camera(const suite_scene *scene, conic_camera *camera);

/* Scenes of surface splats: one; a sheet; two that meet; a floor, nearly from its edge. Errors: MEMORY. */
conic_status cli_suite_make_splat(conic_context *context, conic_splats *splats);
conic_status cli_suite_make_sheet(conic_context *context, conic_splats *splats);
conic_status cli_suite_make_corner(conic_context *context, conic_splats *splats);
conic_status cli_suite_make_steep(conic_context *context, conic_splats *splats);
