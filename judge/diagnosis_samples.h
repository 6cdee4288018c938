/* The pixels by which explanations are compared: wrong ones, and right ones beside them. */
#pragma once

#include "conic/diagnosis.h"
#include "judge/planted.h"

/* The compared values of a pixel. */
enum {
  CONIC_CHANNEL_A = 3,
  CONIC_CHANNEL_T = 4,
  CONIC_CHANNEL_WEIGHT = 5,
  CONIC_CHANNEL_ALBEDO = 6, /* 3 */
  CONIC_CHANNEL_NORMAL = 9, /* 3 */
  CONIC_CHANNEL_Z = 12,     /* this and the next are compared by their ratio */
  CONIC_CHANNEL_MEDIAN_Z = 13,
  CONIC_CHANNEL_INVERSE_Z = 14,
  CONIC_CHANNEL_COUNT = 15,
  CONIC_N_COMPARED_CHANNELS = 16,
  CONIC_CHANNEL_GLOSS = 16, /* 3: highlights, which are added to the colour when the picture is finished */
  CONIC_N_CHANNELS = 20
};

typedef float conic_channels[CONIC_N_CHANNELS];

enum { CONIC_CELL = 8, CONIC_MOST_CELLS = 96 };

/* Samples first … first + n are in the cell whose first pixel is (x, y). */
typedef struct conic_sample_cell {
  size_t first, n;
  int x, y;
} conic_sample_cell;

typedef struct conic_diagnosis_samples {
  conic_context *context;
  int width, height;
  size_t n, n_cells;
  uint16_t (*places)[2];
  uint8_t *is_wrong;
  conic_channels *low, *high; /* the range that the picture's values stand for */
  unsigned channels;          /* the picture's, as bits */
  conic_sample_cell *cells;
} conic_diagnosis_samples;

/* A picture with the classes of its pixels. `greatest` and `ranges` may be null, as in conic_gaussian_judging. */
typedef struct conic_judged_picture {
  const conic_image *image, *greatest;
  const uint8_t *classes;
  const float *ranges;
} conic_judged_picture;

/* Chooses at most `most_cells` cells, a quarter of them without wrong pixels; none where no pixel is wrong. The caller
 * releases *samples, on failure too. Errors: MEMORY. */
conic_status conic_diagnosis_samples_choose(conic_context *context, const conic_judged_picture *picture,
                                            size_t most_cells, conic_diagnosis_samples *samples);
/* Takes the cells from *next on, in rows, and sets *next to the first that is left; none where none is. The caller
 * releases *samples, on failure too. Errors: MEMORY. */
conic_status conic_diagnosis_samples_take(conic_context *context, const conic_judged_picture *picture, size_t *next,
                                          conic_diagnosis_samples *samples);
void conic_diagnosis_samples_release(conic_diagnosis_samples *samples);

/* The channels of an image at a pixel; missing ones are 0. */
void conic_channels_of_image(const conic_image *image, size_t pixel, conic_channels channels);

/* The sum of a sample's differences, each at most 1. */
double conic_diagnosis_distance_at(const conic_diagnosis_samples *samples, size_t i, const conic_channels values);
/* The sum over all samples. Right pixels that are far from `ours` (null: none is) are left out. */
double conic_diagnosis_distance(const conic_diagnosis_samples *samples, const conic_channels *values,
                                const conic_channels *ours);

float conic_planted_transferred(conic_planted_transfer transfer, float value);

/* Applies the mistakes in finishing a picture to the samples. */
void conic_planted_finish(const conic_planted *planted, size_t n, conic_channels *values);

/* Draws a Gaussian scene with a mistake, at samples only. */

/* Composites at the samples, before a black background, with `samples` × `samples` samples a pixel; the camera is the
 * fine picture's already. Without a mistake these are the values of conic_gaussians_render. Errors: MEMORY,
 * CANCELLED. */
conic_status conic_planted_gaussians_draw(conic_context *context, const conic_gaussians *gaussians,
                                          const conic_planted *planted, int samples, const conic_diagnosis_samples *at,
                                          conic_channels *values);

/* Tries mistakes one by one and in pairs. */

/* Draws a picture with a mistake at the samples, before black and unfinished. */
typedef conic_status conic_planted_drawer(void *world, const conic_planted *planted,
                                          const conic_diagnosis_samples *samples, conic_channels *values);

typedef struct conic_trials {
  conic_context *context;
  const conic_judged_picture *picture;
  const conic_diagnosis_samples *samples;
  const conic_planted *right;
  conic_planted_drawer *draw;
  void *world;
  int n_suspects;
  conic_suspect suspects[CONIC_MOST_SUSPECTS];
} conic_trials;

/* How a picture with a mistake fits all of the judged one. */
typedef struct conic_counter_check {
  conic_planted planted;
  int is_rough;                  /* the mistake is only drawn roughly, so that half of the difference suffices */
  double share;                  /* of the difference that it takes away */
  size_t wrong, righted, spoilt; /* pixels; spoilt: right ones that it would make wrong. Those of whose difference
                                    roundings may do more than half count only if righted */
  size_t right;
} conic_counter_check;

/* Draws all that was judged with each mistake, and compares it. Errors: as the drawer's, MEMORY. */
conic_status conic_counter_check_all(conic_trials *trials, size_t n, conic_counter_check *checks);
/* Whether the mistake explains the picture: nine tenths of the difference and eight of the wrong pixels, and it spoils
 * no right ones, but for as few as decisions may turn. */
int conic_counter_check_is_passed(const conic_counter_check *check);

/* Finds explanations as conic_gaussian_diagnose says. */
conic_status conic_trials_run(conic_trials *trials, conic_diagnosis *found, int room, int *n_found);
