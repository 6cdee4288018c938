/* Analytic scenes, sampled into splats: what the tests, the benchmarks and the demo draw. */
#ifndef CONIC_SCENE_H
#define CONIC_SCENE_H

#include "conic/splats.h"

CONIC_BEGIN_C

typedef enum conic_scene_type {
  CONIC_SCENE_PLANE = 0,   /* the unit square [-½, ½]² in z = 0, facing +z; a checkerboard of 8 × 8 in the
                              sRGB codes 255 and 32, dark at (-½, -½) */
  CONIC_SCENE_SPHERE = 1,  /* radius 1, Fibonacci lattice, checker colours */
  CONIC_SCENE_TORUS = 2,   /* radii 1 and 0.4, around y */
  CONIC_SCENE_KNOT = 3,    /* a (2, 3) torus knot as a tube */
  CONIC_SCENE_TERRAIN = 4, /* an island of fractal heights over [-1, 1]², y up, coloured by height and slope */
  CONIC_SCENE_GYROID = 5,  /* the iso-surface in the cube [-1, 1]³, 22 periods: on average over 20 sheets deep.
                              Resolved from some 4 million splats on */
  CONIC_SCENE_CUBE = 6,    /* edge 1 around the origin, sharp: clip lines at its edges and corners */
  CONIC_SCENE_CORNER = 7   /* the same without the octant of positive coordinates: convex and concave edges, and
                              faces with a concave corner, where lines combine by OR */
} conic_scene_type;

#define CONIC_N_SCENES 8

/* "plane", "sphere" …; null for a number that is no scene. */
CONIC_API const char *conic_scene_name(conic_scene_type type);
/* One line that says what it is. */
CONIC_API const char *conic_scene_summary(conic_scene_type type);

/* Which optional arrays a scene's splats have: bits of conic_splats_field; 0 for a number that is no scene. */
CONIC_API unsigned conic_scene_fields(conic_scene_type type);

typedef struct conic_scene_options {
  size_t size; /* sizeof(conic_scene_options), set by the init function */
  conic_scene_type type;
  size_t count;     /* splats, 1 to 2³² - 2 */
  uint64_t seed;    /* of the jitter, the noise and the terrain's shape */
  double jitter;    /* moves each sample in its tangent plane by up to this many spacings, sqrt(area / count) */
  double noise;     /* moves each sample along its normal by a Gaussian of this many spacings */
  double offset[3]; /* becomes the set's origin: moves the scene away from the world's */
  float cutoff;     /* F_g: the outline is F_g standard deviations */
} conic_scene_options;

/* A sphere of 100,000 splats. */
CONIC_API void conic_scene_options_init_sized(conic_scene_options *options, size_t size);
#define conic_scene_options_init(options) conic_scene_options_init_sized(options, sizeof *(options))

/* A scene that is ready to be sampled; any split into batches gives the same splats. */
typedef struct conic_scene conic_scene;

/* Prepares the scene, in memory that grows at most with the square root of the count. On success the caller owns
 * *scene, which must not outlive the context; on failure it is null. Errors: ARGUMENT, MEMORY, CANCELLED. */
CONIC_API conic_status conic_scene_create(conic_context *context, const conic_scene_options *options,
                                          conic_scene **scene);

/* Samples `n` splats of the scene, from number `first` on, into `splats`. The caller has allocated it with the arrays
 * of conic_scene_fields for at least n splats; its count becomes n, and other arrays stay as they are. A splat gets
 * clip lines where a sharp edge is nearer than twice its outline's radius. Circles: outline radius 1.5 × sqrt(area /
 * count). Errors: ARGUMENT, CANCELLED. */
CONIC_API conic_status conic_scene_sample(conic_scene *scene, size_t first, size_t n, conic_splats *splats);

/* Null is allowed. */
CONIC_API void conic_scene_destroy(conic_scene *scene);

CONIC_END_C
#endif
