/* The oracle's scene: every splat that may be drawn, in camera space, and what is in doubt about it. */
#ifndef CONIC_ORACLE_SCENE_H
#define CONIC_ORACLE_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "conic/oracle.h"
#include "oracle/oracle_clip.h"
#include "oracle/oracle_splat.h"

enum { ORACLE_N_INPUTS = 6, ORACLE_MAX_OTHERS = 3 };

typedef struct oracle_splat {
  oracle_placed placed;
  oracle_formula formula, others[ORACLE_MAX_OTHERS]; /* others: what rounding may choose instead */
  int n_others;
  uint32_t index;
  int is_facing_unsure;
  double box[2][2]; /* what any of the formulas may cover lies within, amply */
  oracle_clip clip;
  double epsilon;
  double behind; /* 1/(1 + ε/‖p‖): s unless the splat is wide */
  double opacity, color[3];
  double normal[3]; /* world, unit, towards the viewer */
} oracle_splat;

typedef struct oracle_scene {
  oracle_view view;
  size_t n;
  oracle_splat *splats;
  double longest; /* the median of the splats' longer axes, which caps the automatic ε */
} oracle_scene;

conic_status conic_oracle_scene_create(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                       const conic_render_options *options, oracle_scene *scene);
void conic_oracle_scene_release(conic_context *context, oracle_scene *scene);

/* The splat with one of its inputs as far off as single precision may put it: the components of the axes, that is. The
 * centre is projected in double precision (docs/reference/picture.md, Numbers). */
oracle_placed conic_oracle_disturb(const oracle_placed *placed, int i);

#endif
