/* The unscented transform: a Gaussian's ellipse on the screen from seven points, with bounds of what floats make of it.
 */
#pragma once

#include "oracle/gaussians/oracle_bounded.h"
#include "oracle/gaussians/oracle_gaussian.h"

typedef struct oracle_unscented {
  bounded place[2],
      radius[2];         /* the mean of the points; half the box that the profile looks at, before it is rounded up */
  bounded conditions[4]; /* of which none may be below 0, and the first not 0: it is drawn nowhere else */
  int is_seen, may_be_seen; /* some point lies in the picture, or near it */
} oracle_unscented;

/* Of a mean and axes, one standard deviation long, in camera space. A `unit` of 0 is the double run. */
void conic_oracle_unscent(const oracle_gaussian_view *view, const bounded mean[3], const bounded axes[3][3],
                          bounded opacity, double unit, oracle_unscented *u);
