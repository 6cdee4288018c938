/* How far what the clip lines leave of a disc reaches on the screen. */
#ifndef CONIC_CLIP_BOX_H
#define CONIC_CLIP_BOX_H

#include "raster/project/projected.h"

/* The box, in pixels, of the part of the disc before near that `n_lines` lines keep, all of them, or one where `is_or`.
 * Returns 0 where they keep nothing. */
int conic_clip_box(const conic_view *view, const conic_disc *disc, const float lines[2][3], int n_lines, int is_or,
                   double low_px[2], double high_px[2]);

#endif
