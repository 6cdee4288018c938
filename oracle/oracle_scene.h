/* The oracle's scene: where every splat may show, and any of them in camera space, with what is in doubt about it. */
#pragma once

#include "oracle/oracle_splat.h"

/* Clip lines, for the oracle: docs/reference/picture.md, Clip lines, from points of the line instead of from matrices.
 */

typedef struct oracle_clip {
  int n_lines, is_or;
  int is_unsure;      /* which side is kept hangs on roundings */
  double lines[2][3]; /* signed distance in pixels at (x, y): 0·x + 1·y + 2; the overlap not in it */
  int has_box;
  double box[2][2];      /* what is left of the disc, widened: minimum and maximum in x, y */
  double position_error; /* of a distance, in pixels: from the splat's place being formed in double */
} oracle_clip;

/* `given` may be null: no lines. `extent` is how large the numbers are that the splat's place was formed from. */
void conic_oracle_clip(const oracle_view *view, const oracle_placed *s, const conic_clip *given, double extent,
                       oracle_clip *clip);

/* By how much the place is kept (negative: clipped), in pixels; 1 without lines. `*error` is what single precision may
 * make of it, over a footprint that is `reach_px` large. */
double conic_oracle_clip_margin(const oracle_clip *clip, double x, double y, double reach_px, double *error);

enum { ORACLE_N_INPUTS = 9, ORACLE_MAX_OTHERS = 3 };

typedef struct oracle_splat {
  oracle_placed placed;
  oracle_formula formula, others[ORACLE_MAX_OTHERS]; /* others: what rounding may choose instead */
  int n_others;
  uint32_t index;
  int is_facing_unsure;
  double box[2][2]; /* what any of the formulas may cover lies within, amply */
  int is_anywhere;  /* … but is not trusted to: for tests */
  oracle_clip clip;
  double epsilon;
  double behind; /* 1/(1 + ε/‖p‖): s unless the splat is wide */
  double opacity, color[3];
  double normal[3]; /* world, unit, towards the viewer */
  /* What rounding may make of the two: */
  double color_error, normals[2][3]; /* of any component; least and greatest of each */
} oracle_splat;

/* All that a splat may cover lies within this box of the screen: minimum and maximum in x, y; none where empty. */
typedef struct oracle_reach {
  float box[2][2];
} oracle_reach;

typedef struct oracle_scene {
  oracle_view view;
  const conic_splats *splats;
  const conic_render_options *options;
  oracle_reach *reaches; /* one for each splat: they are placed where they are needed, and again elsewhere */
  double longest;        /* the median of the splats' longer axes, which caps the automatic ε */
  int is_brute;          /* every reach is the whole plane */
} oracle_scene;

/* Looks through the splats. With is_brute nothing is left out anywhere, which is for tests. The scene refers to splats
 * and options. Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_scene_create(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                       const conic_render_options *options, conic_float_kind floats, int is_brute,
                                       oracle_scene *scene);
void conic_oracle_scene_release(conic_context *context, oracle_scene *scene);

/* Splat i of the input; 0 where it can't show. */
int conic_oracle_scene_place(const oracle_scene *scene, size_t i, oracle_splat *splat);

/* How many inputs single precision puts off: the components of the axes, and, where the centre is not projected in
 * double precision (docs/reference/picture.md, Numbers), its own. */
int conic_oracle_n_inputs(const oracle_view *view);
/* The splat with one of them as far off as may be. */
oracle_placed conic_oracle_disturb(const oracle_view *view, const oracle_placed *placed, int i);
