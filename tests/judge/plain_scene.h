/* A scene of 3D or 2D Gaussian splatting, a camera and a picture, as a plain renderer has them. Nothing here shares
 * code with the library. */
#pragma once

#include <stdio.h>
#include <stdlib.h>

/* What renderers get wrong. Several at once are a mask of 1u << fault. */
typedef enum plain_fault {
  PLAIN_DILATION_0,
  PLAIN_DILATION_0_1,
  PLAIN_EXTENT_3_SIGMA,
  PLAIN_ALPHA_MAX_0_999,
  PLAIN_ALPHA_MAX_0_99,
  PLAIN_FALLOFF_RENORMALISED,
  PLAIN_ORDER_DISTANCE,
  PLAIN_ORDER_FILE,
  PLAIN_SH_DEGREE_0,
  PLAIN_F_REST_INTERLEAVED,
  PLAIN_QUATERNION_XYZW,
  PLAIN_QUATERNION_NOT_NORMALISED,
  PLAIN_SCALE_LINEAR,
  PLAIN_OPACITY_LINEAR,
  PLAIN_HALF_PIXEL,
  PLAIN_MIRRORED_X,
  PLAIN_MIRRORED_Y,
  PLAIN_CENTRE_IGNORED,
  PLAIN_SRGB_DECODED,
  PLAIN_SRGB_ENCODED,
  PLAIN_PREMULTIPLIED,
  PLAIN_BACKGROUND_WHITE,
  PLAIN_NEAR,
  PLAIN_AFFINE, /* from here on of surfels */
  PLAIN_NO_AMPLITUDE,
  PLAIN_EPSILON_IN_Z,
  PLAIN_RADIUS_AS_SIGMA,
  PLAIN_NO_NORMALISATION,
  PLAIN_BACK_FACES,
  PLAIN_N_FAULTS
} plain_fault;

/* Beside them: as other programs have them, where there are several ways: scales that are undone twice, opacities
 * limited to 0 to 1, sRGB as a power of 2.2, colours divided by alpha, … */
#define PLAIN_OTHERWISE (1u << 31)

extern const char *const plain_fault_names[PLAIN_N_FAULTS];

/* The fault of a name; ends the program where there is none. */
plain_fault plain_fault_find(const char *name);

static inline int plain_has(unsigned faults, plain_fault fault) {
  return faults >> fault & 1;
}

/* As the file has it, but that scales and opacities are linear. */
typedef struct plain_scene {
  size_t count;
  int sh_degree, n_scales;        /* 3, or 2 of flat Gaussians */
  float *mean, *scale, *rotation; /* 3, 3 and 4 of each: w, x, y, z */
  float *opacity;
  float *sh; /* (degree + 1)² of each, of 3 channels each */
} plain_scene;

typedef struct plain_camera {
  int width, height;
  float fx, fy, cx, cy;
  float view[3][4]; /* from the world: x right, y down, z forward */
} plain_camera;

/* Colours over the background, row by row from above. */
typedef struct plain_picture {
  int width, height;
  float *rgb, *T, *alpha, *z, *count;
} plain_picture;

/* Prints what is wrong and ends the program. */
void plain_give_up(const char *path, const char *what);

/* A binary PLY's rows of floats by name. `values` has room for the file's; absent ones are null. */
typedef struct plain_table {
  size_t n_rows;
  int n_columns;
  char names[96][24];
  double *values; /* n_rows × n_columns */
} plain_table;
plain_table plain_table_read(const char *path);
/* A column's number; −1: there is none. */
int plain_table_find(const plain_table *table, const char *name);

plain_scene plain_scene_read(const char *path, unsigned faults);
void plain_scene_release(plain_scene *scene);
plain_camera plain_camera_read(const char *path);

/* Writes a scene of n Gaussians and a camera before it. */
void plain_random_write(unsigned long long seed, size_t n, const char *scene, const char *camera);

plain_picture plain_picture_allocate(int width, int height);
void plain_picture_release(plain_picture *picture);
/* Faults of what is done with a finished picture: mirrored, sRGB, multiplied by alpha. */
void plain_picture_spoil(plain_picture *picture, unsigned faults);
/* By the ending: OUT.pfm and OUT.T.pfm, OUT.Z.pfm; or OUT.npy (H, W, 4) and OUT.Z.npy. */
void plain_picture_write(const plain_picture *picture, const char *path);
