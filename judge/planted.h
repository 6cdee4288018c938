/* A picture with a mistake: where the scene, the camera, the rules or the finishing differ from the right ones. */
#pragma once

#include "conic/gaussian_judge.h"
#include "conic/triangles.h"
#include "gaussians/draw/gaussian_rules.h"
#include "raster/view/slips.h"

/* The order of compositing, if it is not the profile's. */
typedef enum conic_planted_order {
  CONIC_ORDER_OWN = 0,
  CONIC_ORDER_Z = 1,
  CONIC_ORDER_DISTANCE = 2,
  CONIC_ORDER_FILE = 3
} conic_planted_order;

/* Where a Gaussian ends: some standard deviations from its centre. */
typedef enum conic_planted_extent {
  CONIC_EXTENT_OWN = 0,
  CONIC_EXTENT_ELLIPSE = 1,
  CONIC_EXTENT_BOX = 2,   /* the box of that ellipse … */
  CONIC_EXTENT_WHOLE_BOX, /* … rounded up to whole pixels */
  CONIC_EXTENT_SQUARE,    /* of the longer axis */
  CONIC_EXTENT_WHOLE_SQUARE,
  CONIC_EXTENT_CIRCLE,
  CONIC_EXTENT_WHOLE_CIRCLE,
  CONIC_EXTENT_LISTED, /* in the tiles that this box meets, … */
  CONIC_EXTENT_WHOLE_LISTED,
  CONIC_EXTENT_LISTED_SQUARE, /* or the square */
  CONIC_EXTENT_WHOLE_LISTED_SQUARE,
  CONIC_EXTENT_TILES, /* inria's */
  CONIC_EXTENT_EXACT  /* no end, where the profile has one */
} conic_planted_extent;

/* Where surfaces among Gaussians are in the order of compositing. */
typedef enum conic_planted_surfaces {
  CONIC_SURFACES_OWN = 0,
  CONIC_SURFACES_BEHIND_ALL,
  CONIC_SURFACES_BEFORE_ALL,
  CONIC_SURFACES_LINEAR /* in their place, but in linear colours */
} conic_planted_surfaces;

/* How a file's numbers are read. */
typedef enum conic_planted_reading {
  CONIC_READING_OWN = 0,
  CONIC_READING_RAW = 1,       /* ln s or logit o are taken as they are; quaternions as x, y, z, w; harmonics channel by
                                  channel */
  CONIC_READING_RAW_LIMITED,   /* RAW, limited to 0 to 1 */
  CONIC_READING_TWICE,         /* undone twice, or undone where nothing was to undo */
  CONIC_READING_CONJUGATE,     /* conjugated quaternions */
  CONIC_READING_LENGTH_SQUARED /* scales are multiplied by |q|² of the quaternion */
} conic_planted_reading;

/* How covariances are turned into the camera's axes, if not by the camera's rotation. */
typedef enum conic_planted_turn {
  CONIC_TURN_OWN = 0,
  CONIC_TURN_HALF, /* and by half a turn about the camera's axis, as the other sign of the Jacobian's third column does
                    */
  CONIC_TURN_NONE,
  CONIC_TURN_TRANSPOSED
} conic_planted_turn;

/* A wrong conversion of colours. */
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
  CONIC_ALPHA_WEIGHTED,        /* for surfels: colours times Σ w */
  CONIC_ALPHA_WEIGHTED_LIMITED /* … with Σ w at most 1 */
} conic_planted_alpha;

typedef struct conic_planted {
  conic_camera camera;
  /* Of Gaussians: */
  conic_gaussian_profile profile;
  conic_profile_row rules;
  double prefilter;
  conic_planted_order order;
  int is_reversed;
  int key_bits; /* of the key's fraction that are kept; 0: all */
  conic_planted_extent extent;
  float extent_sigmas;
  size_t n_whole;    /* of the Gaussians, how many of the first are drawn; 0: all */
  float falloff_end; /* half of the q at which the falloff is 0; 0: it has no such end */
  int has_unit_volume;
  double least_z;    /* nearer means are left out */
  int changes_cross; /* its mixed term is multiplied by … */
  float cross_factor;
  unsigned harmonic_signs; /* bits of the harmonics whose sign is the other */
  float color_offset;      /* added to each channel of a Gaussian's own colour, before its limit */
  int takes_any_color;     /* that has no limit at 0 … */
  int limits_color;        /* … or one at 1, too */
  int takes_translation;   /* the eye, for harmonics, is the camera's translation */
  int turns_directions;    /* harmonics' directions are in the camera's axes */
  float shift_px[2];       /* between the places on the screen and those where the camera sees them */
  int most_degree;
  conic_planted_reading harmonics, rotation, scale, opacity;
  int axes_order; /* 1 to 5: another order of the three scales */
  float size;     /* multiplies scales */
  conic_planted_turn turn;
  int reweighs; /* 1: colours are multiplied by α² T, 2: depths, too; 3 and 4: by α T (1 − α) */
  conic_planted_transfer own_transfer;     /* of each Gaussian's own colour */
  const conic_gaussian_surfaces *surfaces; /* null: there are none */
  conic_planted_surfaces surfaces_are;
  /* Of surfels: */
  int is_of_surfels;
  conic_render_options options;
  unsigned slips;
  double axes;
  /* Of the picture: */
  int mirrors[2], moves[2];          /* moves: in whole pixels, and round the edges */
  int is_bgr, is_clipped, has_raw_z; /* raw: not divided by alpha */
  float behind[3];
  int is_opaque, adds_whole; /* whole: the background is added everywhere, as if nothing hid it */
  conic_planted_alpha alpha;
  conic_planted_transfer transfer;
} conic_planted;

/* A mistake, in one of its readings. */
typedef struct conic_suspect {
  const char *name;
  int kind, how;
  double value;
} conic_suspect;

enum { CONIC_MOST_SUSPECTS = 400 };

/* Fills in the mistakes that pictures drawn so could have; returns how many. Profiles come last. */
int conic_suspects_of_gaussians(const conic_planted *right, conic_suspect suspects[CONIC_MOST_SUSPECTS]);
int conic_suspects_of_surfels(const conic_planted *right, conic_suspect suspects[CONIC_MOST_SUSPECTS]);

void conic_suspect_plant(const conic_suspect *suspect, conic_planted *planted);

/* The order in which two mistakes are planted: first profiles, then changes of their rules. */
int conic_suspect_rank(const conic_suspect *suspect);

/* Whether the mistake is in finishing the picture, so that nothing is drawn anew. */
int conic_suspect_is_finish(const conic_suspect *suspect);
int conic_suspect_is_profile(const conic_suspect *suspect);
/* Whether it is not tried as the second of two. */
int conic_suspect_is_alone(const conic_suspect *suspect);
/* Whether it is drawn only roughly as renderers with that mistake do. */
int conic_suspect_is_rough(const conic_suspect *suspect);
/* Whether any value is possible: the listed ones are only some. */
int conic_suspect_is_any(const conic_suspect *suspect);
