/* How a plain renderer sets up a Gaussian for its pixels. */
#pragma once

#include "tests/judge/plain_gaussians.h"

enum { TILE = 16 };

/* A Gaussian as a pixel needs it. */
typedef struct plain_footprint {
  uint32_t index;
  float key, z, opacity, color[3];
  float place[2], form[3]; /* of an ellipse: the inverse of its covariance on the screen, a, b, c */
  float rows[3][3];  /* of a disc: from its plane to the screen; of a ray: to where the Gaussian is a unit ball, */
  float ball[3];     /* and that ball's place */
  float radius;      /* of the square that tiles are found by */
  float reach[2][2]; /* beyond it α is below its least: minimum, maximum */
} plain_footprint;

/* What a pixel sees of a Gaussian. */
typedef struct plain_hit {
  const plain_footprint *g;
  float alpha, before, z; /* before: T there */
} plain_hit;

/* What does not change from Gaussian to Gaussian. */
typedef struct plain_frame {
  const plain_scene *scene;
  const plain_camera *camera;
  const plain_settings *settings;
  plain_floats floats;
  plain_profile profile; /* spoilt by the faults */
  float center[2], eye[3];
  plain_hit *hits; /* room for those of a pixel */
} plain_frame;

plain_frame plain_look(const plain_scene *scene, const plain_camera *camera, const plain_settings *settings);

/* Sets up Gaussian i. 0: it is not drawn. */
int plain_place(plain_frame *v, size_t i, plain_footprint *g);

static inline float plain_clamp(float value, float low, float high) {
  return fminf(fmaxf(value, low), high);
}
