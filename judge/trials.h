/* Tries mistakes one by one and in pairs. */
#ifndef CONIC_TRIALS_H
#define CONIC_TRIALS_H

#include "conic/diagnosis.h"
#include "judge/diagnosis_samples.h"

/* Draws a picture with a mistake at the samples, before black and unfinished. */
typedef conic_status conic_planted_drawer(void *world, const conic_planted *planted,
                                          const conic_diagnosis_samples *samples, conic_channels *values);

typedef struct conic_trials {
  conic_context *context;
  const conic_diagnosis_samples *samples;
  const conic_planted *right;
  conic_planted_drawer *draw;
  void *world;
  int n_suspects;
  conic_suspect suspects[CONIC_MOST_SUSPECTS];
} conic_trials;

/* Finds explanations as conic_gaussian_diagnose says. */
conic_status conic_trials_run(conic_trials *trials, conic_diagnosis *found, int room, int *n_found);

#endif
