/* One derivative on its way. */
#pragma once

#include "oracle/gaussians/oracle_cells.h"
#include "oracle/gaussians/oracle_gradient.h"

/* What a thread keeps from cell to cell. */
typedef struct gradient_worker {
  const oracle_shown **shown; /* the cell's */
  oracle_met *met;
} gradient_worker;

typedef struct oracle_gradient_job oracle_gradient_job;

/* What of a sum over pixels is not certain. */
typedef struct oracle_sum_bound {
  double size[N_BY_ELLIPSE];  /* of the terms, without regard to sign */
  double slack[N_BY_ELLIPSE]; /* by decisions in doubt */
  uint32_t n, is_open;        /* pixels; whether a decision is in doubt whose other answer is not followed */
} oracle_sum_bound;

/* How far off floats may have what a pixel sees of a Gaussian. */
typedef struct oracle_shown_off {
  double place[2], form[3], opacity, color[3], z, key;
  double compensation; /* of the square of what the opacity is multiplied by, as a share of it */
  double spread[2];    /* of the covariance's terms, in pixels; 0 where it is set up in double */
} oracle_shown_off;

/* What the set-up in float is off by at most, in units of its terms' sizes; and how often roundings are tried. */
enum { ORACLE_SETUP_UNITS = 8, ORACLE_ROUNDING_SAMPLES = 6 };

typedef struct oracle_gradient_judging {
  const conic_float_model *model;
  oracle_shown_off *offs;               /* of each Gaussian */
  oracle_sum_bound *bounds, *totals;    /* of each entry of the band; of each Gaussian */
  char *is_open_pixel;                  /* of each pixel */
  struct gradient_variants *of_threads; /* by thread */
  double (*samples)[N_BY_SCREEN];       /* by rounding sample: the totals of each Gaussian */
} oracle_gradient_judging;

struct oracle_gradient_job {
  conic_context *context;
  const conic_gaussians *set;
  const conic_gaussian_weights *weights;
  const conic_float_model *model; /* null: doubts are not looked for */
  const float *background;
  const conic_gaussian_surfaces *surfaces; /* null: there are none */
  oracle_gaussian_view view;
  oracle_eye eye;
  conic_gaussian_gradient *gradient;

  oracle_shown *shown;                       /* of each Gaussian */
  size_t across, down;                       /* cells */
  size_t *begin, most_entries, most_in_band; /* of each cell's entries; a band is a row of cells */
  uint32_t *entries;                         /* indices of Gaussians */
  gradient_worker *workers;

  size_t band;                   /* that is being worked on: */
  double (*sums)[N_BY_SCREEN];   /* of each of its entries, */
  char *is_touched;              /* and whether a pixel composites it */
  double *losses;                /* of its cells */
  double (*totals)[N_BY_SCREEN]; /* of each Gaussian */
  char *is_shown;
  oracle_camera_gradient *cameras;      /* of each run of Gaussians */
  uint16_t *doubts;                     /* of each Gaussian, by each thread */
  oracle_gradient_judging *judging;     /* null: nothing is judged */
  int passes_most;                      /* oracle_gradient_pixel */
  const oracle_gradient_judging *noise; /* whose roundings come in by chance; null: none */
  uint64_t seed;                        /* of these */
  uint8_t *wrong_kinds;                 /* conic_gradient_options */
};

/* Fills in the totals, is_shown and the loss. Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_differentiate(oracle_gradient_job *job);
void conic_oracle_gradient_end(oracle_gradient_job *job);

/* What the functions of conic/gaussian_gradient.h make of their arguments: a job with the gradient's room, which the
 * caller runs, and ends whatever comes of it. Its parts refer to *entry. Errors: ARGUMENT, MEMORY, UNSUPPORTED. */
conic_status conic_oracle_gradient_begin(conic_context *context, const conic_gaussians *set, const conic_camera *camera,
                                         const conic_gaussian_options *options, const conic_gaussian_weights *weights,
                                         const conic_gradient_options *how, conic_float_kind kind,
                                         conic_gaussian_gradient *gradient, oracle_entry *entry,
                                         oracle_gradient_job *job);
/* Decisions in doubt, and the pixels where some of them are (null: not asked). Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_gradient_doubts(oracle_gradient_job *job, oracle_entry *entry);
/* From the totals to the gradient. Errors: MEMORY. */
conic_status conic_oracle_gradient_chain_all(oracle_gradient_job *job);

/* What conic_oracle_differentiate does besides where somebody judges: room; a pixel's bounds, of the n Gaussians of its
 * cell; and summing up. Errors: MEMORY. */
conic_status conic_oracle_judging_room(oracle_gradient_job *job);
void conic_oracle_judging_end(oracle_gradient_job *job);
void conic_oracle_bound_pixel_gradient(const oracle_gradient_job *job, const gradient_worker *worker, size_t n,
                                       size_t x, size_t y, int i_thread, oracle_sum_bound *bounds);
void conic_oracle_add_gradient_bound(oracle_sum_bound *to, const oracle_sum_bound *from);

/* Roundings by chance: of the form of Gaussian i; of all that pixels see of it; of one that covers a pixel; and of what
 * goes back over a pixel's Gaussians. */
void conic_oracle_disturb_form(const oracle_gradient_judging *noise, uint64_t seed, size_t i, double form[3]);
void conic_oracle_disturb_shown(const oracle_gradient_judging *noise, uint64_t seed, oracle_shown *shown);
void conic_oracle_disturb_met(const oracle_gradient_job *job, const oracle_shown *shown, double x, double y,
                              oracle_met *met);
void conic_oracle_disturbed_back(const oracle_gradient_job *job, const oracle_gradient_pixel *pixel,
                                 const oracle_shown *const *shown, oracle_met *met, size_t n, double behind,
                                 double (*sums)[N_BY_SCREEN]);
/* Fills in judging->samples. Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_sample_roundings(const oracle_gradient_job *right);

/* A gradient of zeros. Errors: MEMORY. */
conic_status conic_oracle_gradient_room(conic_context *context, size_t n, int sh_degree, int has_third_scale,
                                        conic_gaussian_gradient *gradient);

/* A pixel's weights; 0 where there are none. */
int conic_oracle_pixel_weights(const conic_gaussian_weights *w, size_t pixel, double weights[N_WEIGHTS]);

/* What judging a gradient needs of the chain. */

/* Rows of J·V·R·S with all terms of one sign, and derivatives on the way. */
typedef struct row_sizes {
  double focal[2], slope[2], rows[2][3], by_rows[2][3], by_mean[3];
} row_sizes;

void conic_oracle_row_sizes(const oracle_gaussian_view *view, const oracle_gaussian *g, row_sizes *sizes);

/* The chain of an ellipse with every term of one sign; `sums` are none below 0. */
void conic_oracle_gradient_sizes(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i,
                                 const double *sums, oracle_parameters *to);

/* A Gaussian's numbers in one row: of the mean, the scales, the quaternion, the opacity, the place and the harmonics.
 * Gaussians are judged in runs of so many. */
enum {
  ORACLE_GRADIENT_RUN = 256,
  ORACLE_FIXED_NUMBERS = 13,
  ORACLE_MOST_NUMBERS = ORACLE_FIXED_NUMBERS + 3 * (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1)
};

conic_gradient_kind conic_oracle_number_kind(size_t at);
size_t conic_oracle_place_in_kind(size_t at);
double conic_oracle_number_in(const conic_gaussian_gradient *gradient, size_t i, size_t at);
/* Of what the chain made of `sums`. */
double conic_oracle_number_of(const oracle_parameters *parameters, const double *sums, size_t at);
/* What a number is multiplied by where stored values are meant. */
double conic_oracle_raw_factor(const oracle_gradient_job *job, size_t i, size_t at);
/* How far off roundings may have Gaussian i's n numbers, and decisions in doubt besides. */
void conic_oracle_bound_numbers(const oracle_gradient_job *job, size_t i, size_t n, double *bound, double *slack);
/* Whether a decision about Gaussian i is in doubt that is not followed the other way. */
int conic_oracle_is_open(const oracle_gradient_job *job, size_t i);

/* Fills in verdict->mistakes. Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_name_mistakes(const oracle_gradient_job *job, const conic_gaussian_gradient *theirs,
                                        conic_gradient_verdict *verdict);
