/* The exact weight: a splat's kernel, projected without approximation, convolved with the pixel's Gaussian. */
#ifndef CONIC_ORACLE_EXACT_H
#define CONIC_ORACLE_EXACT_H

#include "oracle/oracle_splat.h"

/* From places of the screen to the splat's plane: U, V, 1/z = row 0·x + row 1·y + row 2. */
typedef struct oracle_exact {
  int has_plane; /* 0: seen exactly from its edge, it weighs nothing */
  double from_screen[3][3];
  double center_px[2]; /* where p projects to, if it does */
  int is_center_in_front;
} oracle_exact;

void conic_oracle_exact(const oracle_view *view, const oracle_placed *s, oracle_exact *exact);

/* The weight at a place, and the change that the last refinement of the integral made. */
double conic_oracle_exact_weight(const oracle_view *view, const oracle_exact *exact, double x, double y,
                                 double *change);

#endif
