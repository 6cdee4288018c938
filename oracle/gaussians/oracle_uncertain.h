/* A Gaussian as floats may have it: what they are given at a pixel, and what may come of it there. */
#pragma once

#include "conic/gaussian_judge.h"
#include "oracle/gaussians/oracle_bounded.h"
#include "oracle/gaussians/oracle_gaussian.h"
#include "oracle/gaussians/oracle_lens.h"
#include "oracle/gaussians/oracle_surface.h"

/* The profile's limits as the floats that everybody has of them. */
typedef struct oracle_limits {
  double alpha_least, alpha_most, stop, half_cutoff, disc_near, fall_end, fall_factor;
} oracle_limits;

typedef struct oracle_doubting {
  const oracle_gaussian_view *view;
  const conic_float_model *model;
  const conic_gaussians *set;
  oracle_limits limits;
} oracle_doubting;

typedef struct oracle_uncertain {
  uint32_t index;
  unsigned doubts; /* CONIC_DOUBT_NEAR: it may be left out everywhere */
  int is_here;     /* as the double run has it */
  bounded key, z, opacity, fade, color[3], normal[3];
  double pixel[2];             /* the centre of the pixel that offsets are counted from */
  bounded place[2], offset[2]; /* on the screen; from there to that pixel */
  bounded form[3];
  bounded g[4][3], c[4][3], e[4];   /* of rays: at that pixel, and how they grow in x and in y; of rays that are not
                                       affine on the screen, at `towards`, and by x, y and z of the direction */
  double towards[3], from[3], unit; /* where that ray begins; what g was divided by */
  bounded rows[3][3];               /* of a disc: from its plane to the screen */
  int is_placed;                    /* these are known, though it may be drawn nowhere: */
  int may_lack_inverse;             /* its ellipse may be none */
  bounded covariance[3];            /* of an ellipse, dilated: xx, xy, yy */
  bounded radius[2];                /* by the profile's rule, before it is rounded up; negative: it has none */
  double reach[2][2];               /* beyond it on the screen α is below its least for sure: minimum, maximum */
  double sure[2][2], wide[2][2];    /* pixels' centres that the rules of coverage admit: for sure, perhaps */
} oracle_uncertain;

/* Where the view's rays are not affine on the screen, the pixel's. */
void conic_oracle_sight_of(const oracle_doubting *d, double x, double y, oracle_sight *sight);

/* Whether the profile has radii, and with them tiles. */
int conic_oracle_has_radii(const conic_profile_row *rules);

/* Sets up Gaussian i but for its colour. Returns 0 where it is drawn nowhere, whatever rounding does. */
int conic_oracle_uncertain_place(const oracle_doubting *d, size_t i, oracle_uncertain *g);
/* Its colour; 0 where that is no number. */
int conic_oracle_uncertain_color(const oracle_doubting *d, oracle_uncertain *g);

/* What may come of it at a pixel. */
typedef struct oracle_meeting oracle_meeting;

struct oracle_meeting {
  const oracle_uncertain *g;
  double key, key_low, key_high;    /* floats */
  double half_q[2], alpha[2], z[2]; /* least and greatest */
  double half_q_v, alpha_v, z_v;    /* in double */
  unsigned doubts;
  int covers, may_cover;    /* in double; for floats */
  conic_gaussian_part part; /* what keeps it out */
  /* Filled in when it is composited: */
  unsigned noted;                      /* all that is in doubt about it there */
  int is_cut;                          /* all that stands before it comes before it, and before all behind it */
  const oracle_meeting *latest_before; /* among the meetings that stand before it */
};

/* `sight`: conic_oracle_sight_of's. */
void conic_oracle_uncertain_meet(const oracle_doubting *d, const oracle_uncertain *g, const oracle_sight *sight,
                                 double x, double y, oracle_meeting *meeting);

/* Whether a comes before b whatever rounding does. */
int conic_oracle_is_before(const oracle_meeting *a, const oracle_meeting *b);

/* Compositing with bounds, following decisions that are in doubt both ways. */

/* What a path through the decisions has composited. */
typedef struct oracle_step {
  const oracle_meeting *meeting;
  double weight[2];
  int is_sure, may_be_before; /* that it is composited; that the step before it comes after it */
} oracle_step;

/* Notes of a Gaussian at a pixel how it lies to the surface there. Returns whether it may be before it. */
int conic_oracle_is_before_surface(const oracle_surface *surface, oracle_meeting *meeting);

/* Composites the meetings that may cover the pixel, which stand in the order of the double run, and notes at each what
 * is in doubt. A surface hides those behind it, and the background; null: there is none. `steps` has room for as many
 * as there are meetings, which may be put together. */
void conic_oracle_composite(const oracle_doubting *d, oracle_meeting *meetings, size_t n, const float background[3],
                            const oracle_surface *surface, oracle_step *steps, conic_gaussian_bound *bound);
