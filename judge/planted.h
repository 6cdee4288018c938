/* A picture with a mistake in it: what of the scene, of the camera, of the rules and of the finished picture is other
 * than it should be. */
#ifndef CONIC_PLANTED_H
#define CONIC_PLANTED_H

#include "conic/triangles.h"
#include "gaussians/draw/gaussian_rules.h"
#include "raster/view/slips.h"

/* By what Gaussians are composited where it is not the profile's key. */
typedef enum conic_planted_order {
  CONIC_ORDER_OWN = 0,
  CONIC_ORDER_Z = 1,
  CONIC_ORDER_DISTANCE = 2,
  CONIC_ORDER_FILE = 3,
  CONIC_N_PLANTED_ORDERS
} conic_planted_order;

/* Where a Gaussian ends, 3 standard deviations from its centre. */
typedef enum conic_planted_extent {
  CONIC_EXTENT_OWN = 0,
  CONIC_EXTENT_ELLIPSE = 1, /* q ≤ 9 */
  CONIC_EXTENT_BOX = 2,     /* the box of that ellipse … */
  CONIC_EXTENT_WHOLE_BOX,   /* … rounded up to whole pixels */
  CONIC_EXTENT_SQUARE,      /* of the longer axis */
  CONIC_EXTENT_WHOLE_SQUARE,
  CONIC_EXTENT_CIRCLE,
  CONIC_EXTENT_WHOLE_CIRCLE,
  CONIC_EXTENT_TILES, /* inria's */
  CONIC_EXTENT_EXACT  /* none where the profile has one */
} conic_planted_extent;

/* How numbers of a file are read. */
typedef enum conic_planted_reading {
  CONIC_READING_OWN = 0,
  CONIC_READING_RAW = 1,       /* ln s or logit o are not undone; quaternions x, y, z, w; harmonics by channel */
  CONIC_READING_RAW_LIMITED,   /* and what is negative is 0, above 1 1 */
  CONIC_READING_TWICE,         /* or where there was nothing to undo, they are; the same in the other direction */
  CONIC_READING_CONJUGATE,     /* of quaternions */
  CONIC_READING_LENGTH_SQUARED /* of quaternions: scales are multiplied by |q|² */
} conic_planted_reading;

/* What is done to colours. */
typedef enum conic_planted_transfer {
  CONIC_TRANSFER_OWN = 0,
  CONIC_TRANSFER_DECODED = 1,
  CONIC_TRANSFER_DECODED_BY_POWER, /* 2.2 */
  CONIC_TRANSFER_DECODED_TWICE,
  CONIC_TRANSFER_ENCODED,
  CONIC_TRANSFER_ENCODED_BY_POWER,
  CONIC_TRANSFER_ENCODED_TWICE
} conic_planted_transfer;

typedef enum conic_planted_alpha {
  CONIC_ALPHA_OWN = 0,
  CONIC_ALPHA_MULTIPLIED = 1,
  CONIC_ALPHA_DIVIDED,
  CONIC_ALPHA_WEIGHTED,        /* colours times Σ w: of surfels */
  CONIC_ALPHA_WEIGHTED_LIMITED /* … of at most 1 */
} conic_planted_alpha;

typedef struct conic_planted {
  conic_camera camera;
  /* Of Gaussians: */
  conic_gaussian_profile profile;
  conic_gaussian_rules rules;
  double prefilter;
  conic_planted_order order;
  int is_reversed;
  conic_planted_extent extent;
  float falloff_end; /* half of the q at which the falloff is 0; 0: none is */
  int has_unit_volume;
  double least_z;    /* means that are nearer are left out */
  float shift_px[2]; /* of the places on the screen from where the camera sees them */
  int most_degree;
  conic_planted_reading harmonics, rotation, scale, opacity;
  conic_planted_transfer own_transfer; /* of each Gaussian's own colour */
  /* Of surfels: */
  int is_of_surfels;
  conic_render_options options;
  unsigned slips;
  double axes;
  /* Of the picture: */
  int mirrors[2];
  float behind[3];
  int is_opaque;
  conic_planted_alpha alpha;
  conic_planted_transfer transfer;
} conic_planted;

/* A mistake in one of its readings. */
typedef struct conic_suspect {
  const char *name;
  int kind, how;
  double value;
} conic_suspect;

enum { CONIC_MOST_SUSPECTS = 160 };

/* Fills in those that could be of pictures drawn so; returns how many. Profiles come last. */
int conic_suspects_of_gaussians(const conic_planted *right, conic_suspect suspects[CONIC_MOST_SUSPECTS]);
int conic_suspects_of_surfels(const conic_planted *right, conic_suspect suspects[CONIC_MOST_SUSPECTS]);

void conic_suspect_plant(const conic_suspect *suspect, conic_planted *planted);

/* Which of two mistakes is planted first: profiles, then what their rules are changed by. */
int conic_suspect_rank(const conic_suspect *suspect);

/* Whether it is one of the finished picture, for which nothing is drawn anew. */
int conic_suspect_is_finish(const conic_suspect *suspect);
int conic_suspect_is_profile(const conic_suspect *suspect);
/* Whether its value may be any: those that are listed are some. */
int conic_suspect_is_any(const conic_suspect *suspect);

#endif
