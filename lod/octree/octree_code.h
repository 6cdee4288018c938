/* The inner nodes of a point-octree as they are kept: 19 bytes each. Numbers are rounded to the side on which the
 * bounds hold, and every bound is found for the numbers that the bytes give back (docs/reference/format-cot.md). */
#pragma once

#include "conic/splats.h"

enum { CONIC_NODE_BYTES = 19, CONIC_NODE_FANOUT = 8 };

/* The scales that the codes of one file are relative to, and what decoding looks up. */
typedef struct conic_code_scale {
  double length;        /* no splat or offset of a node is longer */
  double cutoff;        /* F_g */
  float color;          /* the linear value of code 255, in each channel */
  float colors[256];    /* of the 8-bit codes */
  float steps[255];     /* thresholds between them */
  uint8_t guess[1793];  /* a code not above that of any value with these upper 16 bits, from 2^-14 to 1 */
  double octave[1024];  /* 2^(i/1024) */
  double widening[256]; /* 2^(i/32): of the sphere's radius over the reach */
  double share[256];    /* 2^(-i/16): of the error in twice the radius */
  double factor[256];   /* 0, then 2^((i - 160)/16) */
} conic_code_scale;

void conic_code_scale_init(double length, double cutoff, float color, conic_code_scale *scale);

/* An inner node. */
typedef struct conic_node {
  float position[3];
  float tangent_u[3], tangent_v[3]; /* t_u is the longer */
  float color[3];
  float opacity;   /* gives its kernel the integral that the kernels of its leaves have together */
  float radius;    /* of the sphere about the position that holds all the leaves' discs and the node's own */
  float error;     /* nothing of the node's disc and nothing of its leaves' is farther from the other */
  float normal[3]; /* the cone's axis, unit: t_u × t_v */
  float cone;      /* the least cosine of a leaf's normal to it */
} conic_node;

/* The frame that a node's ellipse lies in: unit axes, and the ratio of its minor axis to its major. */
typedef struct conic_node_frame {
  double position[3];
  double u[3], v[3], n[3];
  double ratio;
} conic_node_frame;

/* Encodes the node's place relative to its first leaf. */
void conic_code_place(const conic_code_scale *scale, const double mean[3], const double first[3], uint8_t *code);
/* Encodes the normal, of any length but zero. */
void conic_code_facing(const double normal[3], uint8_t *code);
/* Encodes the direction (x, y) of the major axis in the facing's own basis, and the ratio. */
void conic_code_axes(double x, double y, double ratio, uint8_t *code);
/* The frame that those three give. */
void conic_code_frame(const conic_code_scale *scale, const double first[3], const uint8_t *code,
                      conic_node_frame *frame);
/* The same, where the facing's basis is known. */
void conic_code_frame_in(const conic_code_scale *scale, const double first[3], const uint8_t *code, const double u[3],
                         const double v[3], const double n[3], conic_node_frame *frame);
/* The sphere alone, faster. */
void conic_code_sphere(const conic_code_scale *scale, const double first[3], const uint8_t *code, float center[3],
                       float *radius);
/* Its radius alone; and the cone's cosine. */
float conic_code_radius_of(const conic_code_scale *scale, const uint8_t *code);
float conic_code_cone_of(const uint8_t *code);
/* The basis in which conic_code_axes takes its direction; n is the facing itself. */
void conic_code_basis(const uint8_t *code, double u[3], double v[3], double n[3]);

/* Encodes the outline's major half axis and the sphere's radius, neither rounded down; returns them as they will be. */
void conic_code_extent(const conic_code_scale *scale, double *reach, double *radius, uint8_t *code);
/* Not rounded down, but never more than twice the radius; returned as it will be. */
double conic_code_error(const conic_code_scale *scale, double error, double radius, uint8_t *code);
void conic_code_cone(double cosine, uint8_t *code);
void conic_code_color(const conic_code_scale *scale, const double color[3], double opacity, uint8_t *code);
void conic_code_children(int n_direct, int n_inner, uint8_t *code);

int conic_code_n_direct(const uint8_t *code);
int conic_code_n_inner(const uint8_t *code);
void conic_code_decode(const conic_code_scale *scale, const double first[3], const uint8_t *code, conic_node *node);

/* The 8-bit code of a linear value: conic_srgb_code, found faster. */
uint8_t conic_code_srgb(const conic_code_scale *scale, float linear);

/* Lengths up to `longest` in 16 bits, 1024 steps an octave; rounded up. */
uint16_t conic_code_length(const conic_code_scale *scale, double longest, double length);
double conic_code_length_of(const conic_code_scale *scale, double longest, uint16_t code);

/* A unit vector in 24 bits: two coordinates of the octahedron. */
void conic_code_normal(const double normal[3], uint8_t code[3]);
void conic_code_normal_of(const uint8_t code[3], double normal[3]);

/* The direction of an axis, which has no sign, in 8 bits: x > 0, or x = 0 and y > 0. */
uint8_t conic_code_direction(double x, double y);
void conic_code_direction_of(uint8_t code, double direction[2]);

/* A factor in 8 bits, 16 steps an octave, 2^-10 to 2^6; 0 for nothing. */
uint8_t conic_code_factor(const conic_code_scale *scale, double factor);
float conic_code_factor_of(const conic_code_scale *scale, uint8_t code);

/* --- leaves of a quantised octree --- */

enum { CONIC_LEAF_BLOCK = 64, CONIC_LEAF_BLOCK_BYTES = 24 };

/* The bytes of one leaf, and of all: the blocks' first, then the leaves'. */
size_t conic_leaf_codes_bytes(size_t n_leaves, int has_colors, int has_opacities);

/* Encodes all leaves in the arrays. */
void conic_leaf_encode(conic_context *context, const conic_code_scale *scale, const conic_splats *leaves,
                       unsigned char *codes);
/* Fills the arrays with what the codes give. */
void conic_leaf_decode(conic_context *context, const conic_code_scale *scale, const unsigned char *codes,
                       conic_splats *leaves);
