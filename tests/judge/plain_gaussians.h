/* A plain renderer of Gaussians, as the author of a CUDA or WebGPU program would write it from the papers: project,
 * sort, composite front to back, all in float. It shares no code with the library. */
#pragma once

#include "tests/judge/plain_floats.h"
#include "tests/judge/plain_scene.h"

typedef struct plain_profile {
  const char *name;
  int is_ray;               /* the greatest response along each pixel's ray, in the order of where it is */
  int is_disc;              /* a 2D Gaussian where the ray meets it; else an ellipse by the Jacobian */
  float near;               /* means up to there are left out, */
  int near_is_in;           /* but not at near itself */
  float dilation;           /* px² */
  float least_compensation; /* of det/det′; below 0: none */
  float most_alpha, least_alpha;
  float stop;                   /* T′ at which compositing ends; 0: never */
  int stops_at;                 /* also at `stop` itself */
  float cutoff;                 /* of q; 0: none */
  int is_inria;                 /* tiles of the square of 3σ, the centre in the middle */
  int is_by_distance;           /* the order of the means */
  float disc_cutoff, disc_near; /* of the box whose middle is the low-pass's; of the hit */
} plain_profile;

/* Null: there is none of that name. */
const plain_profile *plain_profile_find(const char *name);

/* How a program came to be written: what the papers leave open. */
typedef struct plain_manner {
  int projects_covariance; /* 0: J·(W·Σ·Wᵀ)·Jᵀ; 1: (J·W)·Σ·(J·W)ᵀ; 2: by the rows of J·W·R·S, without Σ */
  int sums_in_any_order;   /* as atomic additions do; else front to back */
  int sums_weights;        /* alpha is Σ w, and not 1 − T */
  int divides_by_alpha;    /* the depth is Σ wz / (1 − T), and not / Σ w */
  int subtracts_weights;   /* T′ is T − αT, and not T·(1 − α) */
  int divides_form;        /* the form is c/det, and not c·(1/det) */
  int normalises_rotation; /* 0: by q/|q|; 1: by q·rsqrt(q·q); 2: by 2/(q·q) in R */
} plain_manner;

typedef struct plain_settings {
  const plain_profile *profile;
  unsigned faults;
  float background[3];
  plain_manner manner;
  plain_floats floats;
} plain_settings;

void plain_gaussians_draw(const plain_scene *scene, const plain_camera *camera, const plain_settings *settings,
                          plain_picture *picture);
