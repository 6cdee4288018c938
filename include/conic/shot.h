/* Shots: a picture as one value. A shot holds every number that decides a bit of the picture, and nothing else: no
 * names of outputs, no threads, no state and no results. conic_shot_draw makes its picture: accumulated, lit, gathered
 * from views and moved, as the shot says.
 *
 * To make a shot, fill it in by hand, with the functions below, which look at the source, or from a file
 * (conic/shot_file.h). From then on it is constant. */
#ifndef CONIC_SHOT_H
#define CONIC_SHOT_H

#include "conic/accumulate.h"
#include "conic/lighting.h"
#include "conic/motion.h"

CONIC_BEGIN_C

/* Where the camera goes while the shutter is open. */
typedef enum conic_way_kind {
  CONIC_WAY_STILL = 0,  /* it stays */
  CONIC_WAY_ORBIT = 1,  /* it turns about an axis */
  CONIC_WAY_CAMERAS = 2 /* it goes from one camera of a list to the next */
} conic_way_kind;

typedef struct conic_camera_way {
  conic_way_kind kind;
  int reserved_int;
  /* An orbit turns the shot's camera about `up` through `center`, once in so many frames. */
  double frames_a_turn, center[3], up[3];
  /* Cameras stand one frame apart. `place` is the shot's own among them, from 0. Before the first and after the last
   * the camera stays. The caller keeps the list. */
  const conic_camera *cameras;
  uint64_t n_cameras;
  double place;
  uint64_t reserved[4];
} conic_camera_way;

/* One of two eyes. */
typedef struct conic_stereo_eye {
  double shift;          /* from the camera to the right, in world units; 0: the camera itself */
  double convergence;    /* the depth at which both eyes' pictures agree; 0: they look in parallel */
  double center[3];      /* used in place of `convergence` where finds_convergence is set: the depth of this point */
  int finds_convergence; /* 1: the depth of `center`; cameras that distort then look in parallel */
  int reserved_int;
  uint64_t reserved[2];
} conic_stereo_eye;

/* Where all is sharp. */
typedef enum conic_focus_kind {
  CONIC_FOCUS_MIDDLE = 0, /* on what is in the picture's middle */
  CONIC_FOCUS_DEPTH = 1,  /* at the depth that the aperture says */
  CONIC_FOCUS_PIXEL = 2   /* on what is at a pixel */
} conic_focus_kind;

/* Light that may be hidden, and lamps: what conic/lighting.h does to a drawn picture. */
typedef struct conic_shot_light {
  uint64_t n_directions; /* of ambient occlusion and of a sky; 0: none is occluded */
  int has_shadows;       /* of the lights of the render options that have a direction */
  int n_lamps;           /* 0 to CONIC_MAX_LAMPS */
  conic_lamp lamps[CONIC_MAX_LAMPS];
  float sun_radius_deg[CONIC_MAX_LIGHTS]; /* of the lights with a direction, 0 to 90: how large they are for samples */
  const conic_sky *sky;                   /* null: none; the caller's */
  double reflectance;                     /* 0 to 1: so much of each colour is the sky, mirrored */
  double dome_stops;                      /* 0 to 16: the strength of conic_image_eye_dome; 0: none of it */
  uint64_t reserved[2];
} conic_shot_light;

typedef struct conic_shot {
  size_t size;         /* sizeof(conic_shot), set by the init function */
  conic_camera camera; /* of the frame, when the shutter's time is 0 */
  conic_camera_way way;
  conic_stereo_eye eye;
  unsigned planes; /* that are wanted, as bits 1 << conic_plane */
  int reserved_int;
  conic_render_options render;
  conic_source_view view;
  conic_gaussian_options gaussians; /* of a source that composites Gaussians */
  conic_shot_light light;
  /* Behind the picture: a gradient from top to bottom, in linear colours. */
  int has_backdrop;
  float backdrop_top[3], backdrop_bottom[3];

  /* The rest is of pictures that are means of samples. */
  uint64_t n_samples;      /* 0: the picture is drawn at once */
  double noise;            /* above 0: the noise that is good enough, so that fewer samples may do */
  conic_aperture aperture; /* its focus is the depth, where focus_kind says DEPTH */
  conic_focus_kind focus_kind;
  int is_shutter_open;   /* 0: all samples are of the same moment */
  double focus_pixel[2]; /* where focus_kind says PIXEL */
  double shutter[2];     /* frames from the shot's own, from when to when it is open */
  double frame;          /* the shot's own, for the motion */
  conic_motion *motion;  /* of the source's inputs; null: they rest. The caller's */

  /* Inputs, as bits 1 << number, whose surfaces hide what is behind them and are not seen. Of catchers the picture has
   * the darkening: black, with A = 1 − what is left of the luminance of their light. They need light that is hidden,
   * and both one sample a pixel, unless Gaussians are before them. */
  uint64_t catchers, holdouts;
  uint64_t reserved[6];
} conic_shot;

/* The library's defaults: colour and depth of 1024 × 1024 pixels; the camera must be filled in. */
CONIC_API void conic_shot_init_sized(conic_shot *shot, size_t size);
#define conic_shot_init(shot) conic_shot_init_sized(shot, sizeof *(shot))

/* What is known of a drawn picture. */
typedef struct conic_shot_outcome {
  conic_render_statistics statistics; /* of the picture; for a mean, of the sample through the middle of lens and
                                         shutter */
  double light_ms;                    /* the time of hiding light */
  conic_accumulation_facts samples;   /* of means: the samples they are of */
  double noise;                       /* of means: how far they are from their end; below 0: not known */
  double focus_depth;                 /* of a lens: the depth at which it is sharp */
  double bound;                       /* the greatest of the plane, where it was asked for; else below 0 */
  uint64_t reserved[7];
} conic_shot_outcome;

/* Draws a shot of a source into the planes that `image` has; they should be the shot's, and its size is the camera's.
 * One set of bits comes out, whatever the threads and the machine. Afterwards the source's choice is the picture's,
 * except for means and gathered pictures. `outcome` may be null. Errors: ARGUMENT (the shot holds impossible values, or
 * the source cannot draw it), UNSUPPORTED, INPUT, MEMORY, CANCELLED; the image's contents are then undefined. */
CONIC_API conic_status conic_shot_draw(conic_source *source, conic_renderer *renderer, const conic_shot *shot,
                                       conic_image *image, conic_shot_outcome *outcome);

/* Draws a shot and writes it into an EXR file of 32-bit floats, strip by strip, so that at most `most_bytes` of pixels
 * are in memory at a time. The file has the bytes that conic_shot_draw and conic_image_write would write. Errors: as
 * conic_shot_draw; UNSUPPORTED for a picture that is not simply drawn (lit, gathered, a mean, with a backdrop, or of a
 * source without windows); IO. */
CONIC_API conic_status conic_shot_write_strips(conic_source *source, conic_renderer *renderer, const conic_shot *shot,
                                               const char *path, uint64_t most_bytes, conic_shot_outcome *outcome);

/* --- functions that fill in what a shot leaves open --- */

/* How conic_shot_frame looks at a source. */
typedef struct conic_shot_framing {
  size_t size;           /* sizeof(conic_shot_framing), set by the init function */
  conic_framing framing; /* its up and elevation unless they are found */
  conic_camera_kind kind;
  int finds_up;        /* 1: the source's `up` is up */
  int finds_elevation; /* 1: 35 degrees for a flat scene or a survey, 0 for a camera within it, else 15 */
  int is_plain;        /* 1: the sphere about the source's box is framed, without a look at the source */
  int has_eye; /* 1: the camera stands at `eye`; else where it sees all, or in the middle if it looks all around */
  double eye[3];
  int i_turn, n_turns; /* picture i_turn of n_turns around the scene, whose cameras differ in the azimuth alone */
  int finds_near;      /* 1: near_z becomes less where it would cut off what is framed */
  int finds_azimuth;   /* 1: turned where a slope or a facade would be seen from behind or beside */
} conic_shot_framing;

/* 1024 × 1024, a perspective camera at 30 degrees that finds all the rest. */
CONIC_API void conic_shot_framing_init_sized(conic_shot_framing *framing, size_t size);
#define conic_shot_framing_init(framing) conic_shot_framing_init_sized(framing, sizeof *(framing))

/* Sets the shot's camera to one that sees all of a source. Null `framing` is the default. Errors: as
 * conic_source_frame and conic_source_fit. */
CONIC_API conic_status conic_shot_frame(conic_source *source, const conic_shot_framing *framing, conic_shot *shot);

/* Sets the exposure to one that leaves 1 pixel in 20 near white, which takes a picture of one sample a pixel. Errors:
 * as conic_shot_draw. */
CONIC_API conic_status conic_shot_expose(conic_source *source, conic_renderer *renderer, conic_shot *shot);

/* Sets the focus to the depth at which the shot is sharp, which takes a look at the picture unless it is known. Errors:
 * ARGUMENT (the pixel lies outside), and as conic_source_draw. */
CONIC_API conic_status conic_shot_focus(conic_source *source, conic_renderer *renderer, conic_shot *shot);

/* --- parts of a shot, for callers that need one of them --- */

/* Where sample `index` is taken from, in a shot whose focus is set. Moves the source's inputs to where they are at its
 * moment. Errors: as conic_shot_camera, conic_motion_apply and conic_sample_place. */
CONIC_API conic_status conic_shot_sample(conic_source *source, const conic_shot *shot, uint64_t index,
                                         conic_sample *sample);

/* The camera at a time in the shutter, 0 to 1; 0.5 is the middle. Errors: ARGUMENT (no single way leads on, or a second
 * eye of a camera that has none). */
CONIC_API conic_status conic_shot_camera(conic_context *context, const conic_shot *shot, double time,
                                         conic_camera *camera);

CONIC_END_C
#endif
