/* A pixel of the oracle: what covers it, what is visible, what the planes hold, and what is in doubt. */
#ifndef CONIC_ORACLE_PIXEL_H
#define CONIC_ORACLE_PIXEL_H

#include "conic/oracle.h"
#include "oracle/oracle_scene.h"

/* What a stable pixel may be off by: see docs/reference/oracle.md. */
#define ORACLE_COLOR_BOUND 1e-4
#define ORACLE_NORMAL_BOUND 1e-4
#define ORACLE_WEIGHT_BOUND 1e-4
#define ORACLE_Z_BOUND 1e-5

/* A splat of the scene set up to be evaluated: as it is, with each input disturbed, and by the formulas that it might
 * have been given instead. */
typedef struct oracle_candidate {
  const oracle_splat *splat;
  oracle_shape shape, disturbed[ORACLE_N_INPUTS], others[ORACLE_MAX_OTHERS];
  int is_drawn, n_disturbed, is_disturbed[ORACLE_N_INPUTS], is_other[ORACLE_MAX_OTHERS];
} oracle_candidate;

void conic_oracle_candidate(const oracle_view *view, const oracle_splat *splat, oracle_candidate *candidate);

typedef struct oracle_interval {
  double low, value, high;
} oracle_interval;

/* A candidate at a pixel that it covers, or may cover. */
typedef struct oracle_fragment {
  const oracle_candidate *candidate;
  double values[ORACLE_N_VALUES];
  unsigned doubt; /* reasons why it may or may not cover */
  int covers, is_visible;
  oracle_interval seen, hides; /* max(iz, iz_plane), s·min(iz, iz_plane) */
  double iz, iz_error;
  double weight, weight_error, weight_spread; /* opacity and floor in */
  double z, z_error;
} oracle_fragment;

/* Evaluates a candidate at a place; 0 where it doesn't cover it and can't. */
int conic_oracle_fragment(const oracle_view *view, const oracle_candidate *candidate, double x, double y,
                          oracle_fragment *fragment);

/* Sets is_visible, and returns the reasons why coverage or visibility are in doubt. */
unsigned conic_oracle_see(oracle_fragment *fragments, size_t n);

/* What the planes hold, before shading. */
typedef struct oracle_pixel {
  double albedo[3], normal[3], mean_normal[3], z, weight;
  size_t count;
  uint32_t id, tied_id; /* tied: CONIC_NO_ID, or as near but for rounding */
  unsigned doubt;
} oracle_pixel;

/* Blends the visible fragments, of which there is at least one. `passes` as in the options; with `is_exact` nothing is
 * said about precision. */
void conic_oracle_blend(const oracle_fragment *fragments, size_t n, int passes, int is_exact, oracle_pixel *pixel);

/* The shaded colour of a covered pixel, premultiplied, exposure in. */
void conic_oracle_shade(const conic_camera *camera, const conic_render_options *options, double x, double y,
                        const oracle_pixel *pixel, double rgba[4]);
/* Room for the planes of a reference whose size is set, all zero; what there is of it stays after a failure. */
conic_status conic_oracle_allocate(conic_context *context, conic_reference *reference);

/* conic_oracle_render of splats and triangles. */
conic_status conic_oracle_draw(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                               const conic_render_options *options, conic_oracle_question question,
                               conic_reference *reference);

/* What an uncovered pixel shows. */
void conic_oracle_background(const conic_render_options *options, double rgba[4]);

#endif
