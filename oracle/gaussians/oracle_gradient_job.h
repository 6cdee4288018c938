/* One derivative on its way. */
#ifndef CONIC_ORACLE_GRADIENT_JOB_H
#define CONIC_ORACLE_GRADIENT_JOB_H

#include "oracle/gaussians/oracle_gradient.h"

/* What a thread keeps from cell to cell. */
typedef struct gradient_worker {
  const oracle_shown **shown; /* the cell's */
  oracle_met *met;
} gradient_worker;

typedef struct oracle_gradient_job {
  conic_context *context;
  const conic_gaussians *set;
  const conic_gaussian_weights *weights;
  const conic_float_model *model; /* null: doubts are not looked for */
  const float *background;
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
  oracle_camera_gradient *cameras; /* of each run of Gaussians */
  uint16_t *doubts;                /* of each Gaussian, by each thread */
} oracle_gradient_job;

/* Fills in the totals, is_shown and the loss. Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_differentiate(oracle_gradient_job *job);
void conic_oracle_gradient_end(oracle_gradient_job *job);

/* A gradient of zeros. Errors: MEMORY. */
conic_status conic_oracle_gradient_room(conic_context *context, size_t n, int sh_degree, int has_third_scale,
                                        conic_gaussian_gradient *gradient);

/* A pixel's weights; 0 where there are none. */
int conic_oracle_pixel_weights(const conic_gaussian_weights *weights, size_t pixel, double of_pixel[N_WEIGHTS]);

#endif
