/* Clip lines, for the oracle: docs/reference/picture.md, Clip lines, from points of the line instead of from matrices.
 */
#ifndef CONIC_ORACLE_CLIP_H
#define CONIC_ORACLE_CLIP_H

#include "oracle/oracle_splat.h"

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

#endif
