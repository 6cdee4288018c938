/* A pixel of the oracle: what covers it, what is visible, what the planes hold, and what is in doubt. */
#pragma once

#include "oracle/oracle_scene.h"

/* What a stable pixel may be off by: see docs/reference/oracle.md. */
#define ORACLE_COLOR_BOUND 1e-4
#define ORACLE_NORMAL_BOUND 1e-4
#define ORACLE_WEIGHT_BOUND 1e-4
#define ORACLE_Z_BOUND 1e-5

/* A splat of the scene set up to be evaluated: as it is, and with each input disturbed. */
typedef struct oracle_candidate {
  const oracle_splat *splat;
  oracle_shape shape, disturbed[ORACLE_N_INPUTS];
  int is_drawn, n_disturbed, is_disturbed[ORACLE_N_INPUTS];
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
  int may_miss;                /* it is in doubt whether it covers */
  oracle_interval seen, hides; /* max(iz, iz_plane), s·min(iz, iz_plane) */
  double iz, iz_error;
  double weight, weight_error, weight_spread; /* opacity and floor in */
  double z, z_error;
  /* What they may be, by whatever formula and rounding. */
  oracle_interval weights, nearness, depths; /* of weight, iz, z */
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
  uint32_t id;
  int has_rivals; /* others are as near but for rounding */
  unsigned doubt;
} oracle_pixel;

/* Blends the visible fragments; there is at least one. `passes` as in the options; with `is_exact` nothing is
 * said about precision. */
void conic_oracle_blend(const oracle_fragment *fragments, size_t n, int passes, int is_exact, oracle_pixel *pixel);

/* Whether two have exactly the same depth, however it is computed. */
int conic_oracle_are_as_near(const oracle_fragment *a, const oracle_fragment *b);
/* Whether a visible one might be nearer than `nearest`, the nearest. */
int conic_oracle_is_rival(const oracle_fragment *f, const oracle_fragment *nearest);

/* The shaded colour of a covered pixel, premultiplied, exposure in. */
void conic_oracle_shade(const conic_camera *camera, const conic_render_options *options, double x, double y,
                        const oracle_pixel *pixel, double rgba[4]);
/* What an uncovered pixel shows. */
void conic_oracle_background(const conic_render_options *options, double rgba[4]);

/* Where the channels of planes stand in a pixel's values, and in those of a conic_alternative. */
enum {
  ORACLE_AT_RGBA = 0,
  ORACLE_AT_Z = 4,
  ORACLE_AT_NORMAL = 5,
  ORACLE_AT_ALBEDO = 8,
  ORACLE_AT_WEIGHT = 11,
  ORACLE_AT_COUNT = 12
};

/* A pixel, or a sample of one. Of what is in doubt there is at least one alternative, unless the question is exact. */
typedef struct oracle_sample {
  double values[CONIC_N_ALTERNATIVE_VALUES];
  uint32_t id;
  unsigned doubt;
  int is_unbounded;                                          /* the alternatives say nothing of some plane */
  size_t first_alternative, n_alternatives, first_id, n_ids; /* in the lists of doubts */
} oracle_sample;

struct oracle_doubts;

/* Makes one pixel of n × n samples, whose doubts are in `from`; those of the pixel, under its number, go to `to`.
 * Errors: MEMORY. */
conic_status conic_oracle_reduce(const oracle_sample *samples, int n, const struct oracle_doubts *from, uint32_t number,
                                 struct oracle_doubts *to, oracle_sample *pixel);

/* What conic_oracle_render_pixels is asked for; is_brute is oracle_scene's. */
typedef struct oracle_request {
  conic_oracle_question question;
  int samples;
  size_t n_pixels;
  int is_brute;
  conic_float_kind floats;
} oracle_request;
conic_status conic_oracle_draw(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                               const conic_render_options *options, const oracle_request *request,
                               conic_reference *reference);
