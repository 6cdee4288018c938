/* What a shot of a source comes to: every question about it, answered once. */
#pragma once

#include "conic/shot.h"

/* When hidden light is taken away. */
typedef enum conic_lit {
  CONIC_LIT_NOT = 0,
  CONIC_LIT_WHOLE = 1,    /* once, of the whole picture */
  CONIC_LIT_BY_VIEW = 2,  /* of each view that the picture is gathered from */
  CONIC_LIT_BY_SAMPLE = 3 /* of each sample, by light of its own */
} conic_lit;

typedef struct conic_shot_plan {
  int is_accumulated; /* it is the mean of samples */
  int is_gathered;    /* from views by pinholes */
  conic_lit lit;
  unsigned planes;   /* what has to be drawn: the shot's, and what these are made of */
  int has_windows;   /* it can be drawn piece by piece, to the same bits: in strips, or by several processes */
  int is_composited; /* surfaces are among Gaussians */
  int is_apart;      /* and a stage has to see them before they are */
} conic_shot_plan;

/* Errors: ARGUMENT (a member is out of its range; what cannot be together). */
conic_status conic_shot_plan_make(const conic_source *source, const conic_renderer *renderer, const conic_shot *shot,
                                  conic_shot_plan *plan);

/* Parts of the plan, for who asks before there is a source: whether light is hidden at all; and of planes those that
 * have to be drawn for them. */
int conic_shot_is_lit(const conic_shot *shot);
unsigned conic_shot_needs(const conic_shot *shot, unsigned planes);

/* Whether pictures of a camera are gathered, by the source's abilities. */
int conic_shot_is_gathered(const conic_shot *shot, unsigned abilities, const conic_camera *camera);
