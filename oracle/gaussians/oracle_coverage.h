/* Which pixels a Gaussian may cover: those that the rules of tiles and boxes admit, and those that it reaches. */
#pragma once

#include "oracle/gaussians/oracle_uncertain.h"

/* The reach may be larger than the formula says, by so many pixels. */
#define ORACLE_REACH_MARGIN_PX 1.0

/* Fill in `sure` and `wide` by the tiles of 16 pixels that meet a square of that radius, or a box of half that size,
 * about the place. */
void conic_oracle_admit_square(const oracle_doubting *d, bounded radius, oracle_uncertain *g);
void conic_oracle_admit_box(const oracle_doubting *d, const bounded radius[2], oracle_uncertain *g);

/* q beyond which α is below its least, amply. Below 0: everywhere. */
double conic_oracle_reach_in_q(const oracle_doubting *d, bounded opacity);

/* Fill in `reach`: all of the screen; and an ellipse's up to q, by its variances in x and in y. */
void conic_oracle_reach_everywhere(oracle_uncertain *g);
void conic_oracle_reach_of_ellipse(const bounded variance[2], double q, oracle_uncertain *g);
