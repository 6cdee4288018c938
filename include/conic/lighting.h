/* Light that does not arrive: shadows, ambient occlusion and the sky. Depth pictures drawn from where the light comes
 * tell what it meets (docs/reference/lighting.md). */
#ifndef CONIC_LIGHTING_H
#define CONIC_LIGHTING_H

#include "conic/render.h"

CONIC_BEGIN_C

/* Draws what casts shadows into the plane Z of `depth`, which has the camera's size and is zero. Nothing nearer than
 * near_z is drawn. Called by the thread that asked for light, one picture at a time. Any status but OK ends the
 * work. */
typedef conic_status conic_depth_drawer(void *cookie, const conic_camera *camera, double near_z, conic_image *depth);

typedef struct conic_casters {
  conic_depth_drawer *draw;
  void *cookie;
  double minimum[3], maximum[3]; /* box of all that casts, in world units */
  double epsilon; /* how far the drawn depth may lie off the surface that it shows, in world units: for splats the
                     cutoff times their length, for triangles 0 */
  uint64_t epsilon_is_drawn; /* 1: Z, drawn by CONIC_PASS_OF_HIDING, has each splat's own ε in it, and `epsilon` is what
                                a slope adds; else 0 */
  uint64_t lets_through; /* 1: the maps have the plane T, too, for what part of the light comes as far as Z; else 0 */
  uint64_t reserved[2];
} conic_casters;

/* A drawer of maps by CONIC_PASS_OF_HIDING multiplies the splats' length by this in its options. So no ε is above four
 * lengths; a splat much larger than most sticks out of its surface by the excess. */
#define CONIC_MAP_LENGTHS 4.0

/* A sky: light from all around, by direction. */
typedef struct conic_sky conic_sky;

/* Reads a picture of all directions: as an equirectangular camera at azimuth 0 and elevation 0 of conic_framing, with
 * that `up`, sees them. Its colours are linear. On success the caller owns *sky, which must not outlive the context;
 * threads may share it. Errors: ARGUMENT (no direction up), INPUT (no colours; a number that is not finite; no light),
 * UNSUPPORTED, MEMORY. */
CONIC_API conic_status conic_sky_read(conic_context *context, const char *path, const double up[3], conic_sky **sky);
/* The same from a picture in memory, of which nothing is kept. */
CONIC_API conic_status conic_sky_create(conic_context *context, const conic_image *image, const double up[3],
                                        conic_sky **sky);
/* Null is allowed. */
CONIC_API void conic_sky_destroy(conic_sky *sky);

/* Direction i of the sequence, a unit vector towards the light, and the light that it stands for: the mean over i of
 * light × visible × cosine is what a white surface reflects. A null sky is white, of radiance 1. */
CONIC_API void conic_sky_direction(const conic_sky *sky, uint64_t i, double direction[3], double light[3]);

/* The shape of a lamp, and where its light goes. */
typedef enum conic_lamp_kind {
  CONIC_LAMP_SPHERE = 0,   /* to all sides */
  CONIC_LAMP_DISC = 1,     /* to one side, as the cosine of the angle to its normal */
  CONIC_LAMP_RECTANGLE = 2 /* as a disc's */
} conic_lamp_kind;

/* A light that stands in the scene, and fades with the square of the distance. */
typedef struct conic_lamp {
  conic_lamp_kind kind;
  float color[3];     /* linear RGB, 0 to 1e12. A surface that faces the lamp at distance 1, in the world's unit of
                         length, is lit as by a directed light of that colour; for a disc and a rectangle, straight
                         ahead */
  double position[3]; /* of its middle, in the world */
  double radius;      /* of a sphere; 0: a point */
  double axes[2][3];  /* of a disc and a rectangle: from the middle to the rim or to two edges. Light goes to the side
                         of the first × the second */
  uint64_t reserved[4];
} conic_lamp;

#define CONIC_MAX_LAMPS 8

typedef struct conic_lighting_options {
  size_t size;              /* sizeof(conic_lighting_options), set by the init function */
  uint64_t first_direction; /* in the sequence */
  uint64_t n_directions;    /* from which light from all around comes; 0: that light is not occluded */
  int has_shadows;          /* of the lights that have a direction */
  const conic_sky *sky;     /* in the place of the sky and ground of the lights; null: these are used */
  double texels;            /* of a map along an edge of the picture's pixel, 0.125 to 8 */
  int most_texels;          /* along an edge of a map, 16 to 16384 */
  int samples;              /* the picture has N × N a pixel; Z is of the sample nearest to the pixel's centre */
  conic_isa isa;
  int is_sample; /* the picture is one of many whose mean is wanted. Each direction counts with its share of the mean,
                    so that the plane ao and the colours of one picture may be up to 4 times too bright, or dark. A lamp
                    shines from the point that first_direction chooses; else from its middle */
  const conic_lamp *lamps; /* the picture was drawn without them; their light is added */
  size_t n_lamps;          /* 0 to CONIC_MAX_LAMPS */
  double reflectance;      /* 0 to 1: so much of each colour is the sky, mirrored by the plane N; nothing hides it */
} conic_lighting_options;

/* None, no lamps, no shadows, no reflections, 1 texel, 4096 at most, 1 sample. */
CONIC_API void conic_lighting_options_init_sized(conic_lighting_options *options, size_t size);
#define conic_lighting_options_init(options) conic_lighting_options_init_sized(options, sizeof *(options))

/* Takes the light that does not arrive from a drawn picture, by its planes Z and N. Fills those of these planes that
 * the picture has:
 * - ao: Σ V·max(0, n·d) / Σ max(0, n·d) over the directions d, where V is 1 where nothing hides the direction, else 0;
 * - shadow: the part of the power of the lights with a direction that arrives: Σ w·V / Σ w. w is a light's luminance,
 *   for a lamp that of the light from its middle to the pixel. V is 0 where the surface faces away. 1 where there is no
 *   such light;
 * - rgba, which needs albedo: less the hidden part of each light, of sky and of ground; with a sky, plus its light;
 *   with lamps, plus theirs. `render` holds the options that the picture was drawn with.
 * Both planes are 1 where nothing is drawn; next to what is drawn, they are the mean of the neighbours. Errors:
 * ARGUMENT (a plane is missing; a light without a direction; a lamp that is none), UNSUPPORTED (the instruction set),
 * MEMORY, CANCELLED, the drawer's; the planes' contents are then undefined. */
CONIC_API conic_status conic_image_light(conic_context *context, const conic_casters *casters,
                                         const conic_camera *camera, const conic_render_options *render,
                                         const conic_lighting_options *options, conic_image *image);

/* Where the lights stand in sample i_sample of a mean of many pictures. Light i with a direction is a disc of
 * radius_deg[i] degrees, 0 to 90, equally bright all over; in a sample it shines from one point of the disc. `lighting`
 * is that of conic_render_options, and *sample may be the same struct. Draw the sample with *sample, and shade it
 * (conic_lighter) with *sample, too. Errors: ARGUMENT (a radius; a light without a direction that is no head). */
CONIC_API conic_status conic_lighting_sample(conic_context *context, const conic_lighting *lighting,
                                             const float radius_deg[CONIC_MAX_LIGHTS], uint64_t i_sample,
                                             conic_lighting *sample);

/* What lights each of many pictures whose mean is wanted. */
typedef struct conic_lighter {
  conic_context *context;
  const conic_casters *casters;
  const conic_render_options *render;
  const conic_lighting_options *options; /* where n_directions is not 0, each picture gets one direction of its own */
} conic_lighter;

/* conic_image_light of picture i_sample; `cookie` is a conic_lighter. Errors: as there. */
CONIC_API conic_status conic_lighter_shade(void *cookie, uint64_t i_sample, const conic_camera *camera,
                                           conic_image *sample);

/* How much of the light from all around arrives at each splat of a set, as the plane ao has it for a pixel: `count`
 * floats. The set has tangent axes; the normals point to the outer side. `spacing` is a map's texel in world units.
 * Errors: as conic_image_light. */
CONIC_API conic_status conic_splats_occlude(conic_context *context, const conic_casters *casters,
                                            const conic_splats *splats, double spacing,
                                            const conic_lighting_options *options, float *ao);

/* Eye-dome lighting: darkens the rgba of a drawn picture where its plane Z has neighbours that are nearer to the eye,
 * by up to so many stops, 0 to 16 (docs/reference/lighting.md). Errors: ARGUMENT (no such planes, or sizes). */
CONIC_API conic_status conic_image_eye_dome(conic_context *context, const conic_camera *camera, double stops,
                                            conic_image *image);

CONIC_END_C
#endif
