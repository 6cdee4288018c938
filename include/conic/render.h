/* Rendering: splats and a camera in, an image and its statistics out.
 *
 * docs/reference/picture.md defines the picture. It has one set of bits: threads, tile size, compiler and machine
 * change none of them. */
#ifndef CONIC_RENDER_H
#define CONIC_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "conic/camera.h"
#include "conic/context.h"
#include "conic/image.h"
#include "conic/isa.h"
#include "conic/splats.h"

CONIC_BEGIN_C

/* How a splat is projected and weighed. */
typedef enum conic_method {
  CONIC_METHOD_CONIC = 0,  /* EWA with the conic whose outline at the cutoff is the exact projection (PAS) */
  CONIC_METHOD_RAY = 1,    /* exact ray–splat parameter, the pixel's filter mapped into the splat at the pixel */
  CONIC_METHOD_AFFINE = 2, /* EWA with the Jacobian at the splat's centre (HQP §3.4) */
  CONIC_METHOD_POINT = 3,  /* the pixel that holds the projected centre */
  CONIC_METHOD_DISC = 4,   /* a circle on the screen about the projected centre (QSplat) */
  CONIC_METHOD_AUTO = 5    /* conic where the bound of its error is small, else ray or better (picture.md, Laplace) */
} conic_method;

#define CONIC_N_METHODS 6
#define CONIC_MAX_METHODS 16

/* "conic", "ray" …; null for a number that is no method. */
CONIC_API const char *conic_method_name(conic_method method);

typedef enum conic_kernel_type {
  CONIC_KERNEL_GAUSS = 0,    /* exp(-r²/2) up to the cutoff */
  CONIC_KERNEL_CONFETTI = 1, /* exp(-a (r/b)ⁿ / (1 - (r/b)ⁿ)) for r < b, 0 beyond (Confetti Eq. 10, corrected) */
  CONIC_KERNEL_HAT = 2,      /* 1 - r/F_g */
  CONIC_KERNEL_BOX = 3       /* 1 */
} conic_kernel_type;

#define CONIC_N_KERNELS 4

/* "gauss", "confetti" …; null for a number that is no kernel. */
CONIC_API const char *conic_kernel_type_name(conic_kernel_type type);

typedef struct conic_kernel {
  conic_kernel_type type;
  float cutoff; /* F_g, in standard deviations; 0.25 to 5 */
  float a, b;   /* Confetti's, both above 0 */
  int n;        /* Confetti's, 1 to 16 */
} conic_kernel;

typedef enum conic_shading {
  CONIC_SHADE_NONE = 0,    /* the albedo */
  CONIC_SHADE_LAMBERT = 1, /* ambient and diffuse */
  CONIC_SHADE_PHONG = 2    /* ambient, diffuse and a highlight */
} conic_shading;

#define CONIC_N_SHADINGS 3

/* "none", "lambert" …; null for a number that is no shading. */
CONIC_API const char *conic_shading_name(conic_shading shading);

/* Where a light stands. */
typedef enum conic_light_frame {
  CONIC_LIGHT_WORLD = 0,  /* fixed in the scene: its direction is in world coordinates */
  CONIC_LIGHT_CAMERA = 1, /* moves with the camera: x to the right, y up in the picture, z towards the viewer */
  CONIC_LIGHT_HEAD = 2    /* at the viewer's eye, without a direction */
} conic_light_frame;

typedef struct conic_light {
  conic_light_frame frame;
  float color[3];      /* linear RGB, 0 to 1e6; 1, 1, 1 is as bright as the one white light */
  double direction[3]; /* towards the light, any length but zero */
} conic_light;

#define CONIC_MAX_LIGHTS 8

/* Several lights, and light from all around. */
typedef struct conic_lighting {
  int is_given; /* 0: one white light, as has_light and light say, and 0.05 from all around */
  int n_lights; /* 0 to CONIC_MAX_LIGHTS */
  conic_light lights[CONIC_MAX_LIGHTS];
  float sky[3], ground[3]; /* linear RGB, 0 to 1e6: the light on a surface that faces up, and on one that faces down
                              … */
  double up[3];            /* … in the world, any length but zero; unused where the two are equal */
  uint64_t reserved[4];
} conic_lighting;

/* Given as the number of passes: draws the plane Z alone, and the image may have no other. Z is then the depth at which
 * a pixel begins to hide: the least depth of a triangle, or of a splat with its ε behind it. For a splat it is 1 over
 * the number that docs/reference/picture.md, "Visible", compares with. Surfaces at a smaller depth are not hidden. */
#define CONIC_PASS_OF_HIDING 2

typedef struct conic_render_options {
  size_t size; /* sizeof(conic_render_options), set by the init function */
  conic_method method;
  conic_kernel kernel;
  float prefilter; /* low-pass variance h in pixels², 0 or more */
  double epsilon;  /* depth tolerance along the ray in world units; negative: from the splat sizes */
  int passes;      /* 3: blend the splats of one surface; 1: the nearest splat wins; or CONIC_PASS_OF_HIDING */
  int cull_back;   /* leave out splats that face away */
  double near_z;   /* nothing nearer in camera-space z is drawn; 0: 1e-4 × the diagonal of the finite centres' box */
  double splat_length; /* conic_splats_length's result; 0: every call finds it anew */
  conic_shading shading;
  int has_light;   /* 0: headlight, from the viewer */
  double light[3]; /* direction towards the light, world coordinates, any length but zero */
  int has_background;
  float background[3]; /* linear RGB behind the picture, which is then opaque */
  double exposure;     /* in stops: the colour is multiplied by 2^exposure */
  int tile;            /* tile edge in pixels: 8, 16, 32 or 64; changes no bit of the image */
  conic_isa isa;
  conic_lighting lighting; /* in the place of has_light and light */
  /* Names the splats, from 1 to 2⁶³ - 1. A renderer on another device keeps its copy of them, and draws the copy as
   * long as the number and the arrays stay the same. Whoever changes a splat changes the number. 0: the splats are read
   * anew for every picture; a processor's renderer always does so. */
  uint64_t splats_version;
  int skip_hidden; /* leaves out what is surely hidden as soon as that is known: the same picture, sooner where many
                      surfaces lie behind each other. Fragments are then not counted, and 0 in the statistics */
} conic_render_options;

/* auto, Gaussian with cutoff 1.5, prefilter 1, automatic ε, 3 passes, no culling, Phong with a headlight, no
 * background. */
CONIC_API void conic_render_options_init_sized(conic_render_options *options, size_t size);
#define conic_render_options_init(options) conic_render_options_init_sized(options, sizeof *(options))

typedef struct conic_render_milliseconds {
  double lod; /* 0 at first: whoever chooses what to draw (conic/octree.h) may add its time, to frame too */
  double setup, bin, visibility, accumulate, resolve, frame;
  uint64_t reserved[8];
} conic_render_milliseconds;

typedef struct conic_render_statistics {
  uint64_t splats_in;      /* = culled + skipped + drawn */
  uint64_t splats_culled;  /* behind near, off-screen, back-facing */
  uint64_t splats_skipped; /* not finite, or without area where nothing widens them */
  uint64_t splats_drawn;
  uint64_t splats_fallback;                     /* of the drawn: by another formula than the method's own */
  uint64_t splats_by_method[CONIC_MAX_METHODS]; /* of the drawn, by the formula used */
  uint64_t fragments;                           /* splat–pixel pairs inside a cutoff */
  uint64_t pixels_covered;
  uint64_t triangles_in;      /* = culled + skipped + drawn */
  uint64_t triangles_culled;  /* behind near, off-screen, back-facing, or between the places of the samples */
  uint64_t triangles_skipped; /* not finite, or too far out to be projected */
  uint64_t triangles_drawn;
  uint64_t triangle_fragments; /* triangle–sample pairs that are covered */
  double near_z;               /* the one used */
  double epsilon;              /* c of the automatic ε, or the fixed ε */
  int epsilon_is_fixed;
  int threads, tile;
  const char *isa;              /* what the hot loops used; static */
  conic_render_milliseconds ms; /* wall-clock; visibility, accumulate and resolve are shares of the tiles' time */
  uint64_t splats_by_laplace;   /* of the splats that splats_by_method counts as ray: by Laplace's method */
  uint64_t reserved[15];
} conic_render_statistics;

/* The near distance that near_z = 0 stands for. It reads every centre: to draw many frames, ask once. */
CONIC_API double conic_default_near(const conic_splats *splats);

/* A renderer keeps the memory of a frame from one frame to the next. One thread at a time. */
typedef struct conic_renderer conic_renderer;

/* On success the caller owns *renderer, which must not outlive the context. Errors: MEMORY. */
CONIC_API conic_status conic_renderer_create(conic_context *context, conic_renderer **renderer);
CONIC_API void conic_renderer_destroy(conic_renderer *renderer);

/* Draws `splats` (with tangent axes) into the planes that `image` has; its size must be the camera's. `statistics` may
 * be null. Splats that cannot be drawn are counted, never an error; with none at all the image is empty.
 * Errors: ARGUMENT, UNSUPPORTED (the instruction set), MEMORY, CANCELLED; the image's contents are then undefined. */
CONIC_API conic_status conic_render(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                                    const conic_render_options *options, conic_image *image,
                                    conic_render_statistics *statistics);

#define CONIC_MAX_SAMPLES 16

/* conic_render with samples × samples samples a pixel (docs/reference/picture.md): the picture is drawn `samples` times
 * as wide and as high, with the prefilter in px² of that picture, and reduced. 1 is conic_render itself; samples times
 * the image's size is 65535 at most. Besides the renderer's memory it needs room for up to 2²⁴ samples or one row of
 * the image's, whichever is more, at 4 bytes a channel. In `statistics`, fragments and pixels_covered count samples.
 * `context` is the renderer's. */
CONIC_API conic_status conic_render_samples(conic_context *context, conic_renderer *renderer,
                                            const conic_splats *splats, const conic_camera *camera,
                                            const conic_render_options *options, int samples, conic_image *image,
                                            conic_render_statistics *statistics);

CONIC_END_C
#endif
