#include "lod/octree/octree_code.h"

#include "core/base/base.h"
#include "core/base/byte_order.h"
#include "core/base/color.h"
#include "core/splats/ellipse.h"

/* Where in the 19 bytes: */
enum {
  AT_CHILDREN = 0,  /* direct leaves, inner nodes: 4 bits each */
  AT_PLACE = 1,     /* 3 × 9 bits with a common exponent of 5 */
  AT_NORMAL = 5,    /* 2 × 12 bits */
  AT_DIRECTION = 8, /* of the major axis */
  AT_RATIO = 9,     /* 1/255 to 1 */
  AT_REACH = 10,    /* 16 bits */
  AT_RADIUS = 12,   /* over the reach */
  AT_ERROR = 13,    /* under twice the radius */
  AT_CONE = 14,
  AT_COLOR = 15,
  AT_OPACITY = 18
};

enum { OCTAVE_STEPS = 1024, SHARE_STEPS = 16 };

/* The upper halves of the bits of 2^-14 and 1. */
enum { FIRST_GUESS = 0x3880, LAST_GUESS = 0x3f80, GUESSES = LAST_GUESS - FIRST_GUESS };

/* 2^(steps/per_octave); per_octave divides 1024. */
static double power(const conic_code_scale *scale, int steps, int per_octave) {
  int octaves = steps >= 0 ? steps / per_octave : -((per_octave - 1 - steps) / per_octave);
  int rest = steps - octaves * per_octave;
  return conic_power_of_two(octaves) * scale->octave[(ptrdiff_t)rest * (OCTAVE_STEPS / per_octave)];
}

void conic_code_scale_init(double length, double cutoff, float color, conic_code_scale *scale) {
  double root = 2.0;
  scale->length = length;
  scale->cutoff = cutoff;
  scale->color = color;
  conic_srgb_decode_table(scale->colors);
  conic_srgb_thresholds(scale->steps);
  for (uint32_t i = 0; i <= GUESSES; i++) {
    uint32_t bits = (FIRST_GUESS + i) << 16;
    float value = conic_float_of_bits(bits);
    scale->guess[i] = conic_srgb_code(scale->steps, value);
  }
  for (int i = 0; i < OCTAVE_STEPS; i++)
    scale->octave[i] = 1.0;
  for (int bit = OCTAVE_STEPS / 2; bit; bit /= 2) { /* 2^(1/2), 2^(1/4), … */
    root = sqrt(root);
    for (int i = 0; i < OCTAVE_STEPS; i++)
      if (i & bit)
        scale->octave[i] *= root;
  }
  for (int i = 0; i < 256; i++) {
    scale->widening[i] = power(scale, i, 32);
    scale->share[i] = power(scale, -i, SHARE_STEPS);
    scale->factor[i] = i ? power(scale, i - 160, 16) : 0.0;
  }
}

uint8_t conic_code_srgb(const conic_code_scale *scale, float linear) {
  uint32_t bits;
  if (!(linear >= 0x1p-14f)) /* black goes on for longer; and what is no number is black */
    return 0;
  memcpy(&bits, &linear, sizeof bits);
  uint8_t code = scale->guess[linear < 1.0f ? (bits >> 16) - FIRST_GUESS : GUESSES];
  while (code < 255 && linear >= scale->steps[code])
    code++;
  return code;
}

/* How many of an octave's `per_octave` parts a ratio is above 1, or one or two beside that: by the exponent, and a
 * polynomial that is off from log2 by no more than 1.5e-4. */
static int guess_steps(double ratio, int per_octave) {
  uint64_t bits;
  memcpy(&bits, &ratio, sizeof bits);
  double m = conic_double_of_bits((bits & UINT64_C(0xfffffffffffff)) | UINT64_C(0x3ff0000000000000)) - 1.0;
  double log2 = m * (1.4387257 + m * (-0.6778778 + m * (0.3218538 - m * 0.0827017)));
  return (int)(((double)(int)(bits >> 52) - 1023.0 + log2) * (double)per_octave);
}

uint16_t conic_code_length(const conic_code_scale *scale, double longest, double length) {
  double ratio = longest / length;
  int code = ratio > 1.0 && ratio < 0x1p64 ? guess_steps(ratio, OCTAVE_STEPS) : ratio > 1.0 ? 65535 : 0;
  code = code < 65535 ? code : 65535;
  /* The greatest code that still gives `length` or more. */
  while (code > 0 && !(longest * power(scale, -code, OCTAVE_STEPS) >= length))
    code--;
  while (code < 65535 && longest * power(scale, -code - 1, OCTAVE_STEPS) >= length)
    code++;
  return (uint16_t)code;
}

double conic_code_length_of(const conic_code_scale *scale, double longest, uint16_t code) {
  return longest * power(scale, -(int)code, OCTAVE_STEPS);
}

/* Of what an int holds. */
static int round_to_int(double value) {
  int whole = (int)(value + 0.5); /* towards 0 */
  return whole - ((double)whole > value + 0.5);
}

static double sign_of(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

void conic_code_normal(const double normal[3], uint8_t code[3]) {
  double sum = fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]);
  double x = normal[0] / sum, y = normal[1] / sum;
  if (normal[2] < 0.0) { /* the lower half is folded out */
    double folded = (1.0 - fabs(y)) * sign_of(x);
    y = (1.0 - fabs(x)) * sign_of(y);
    x = folded;
  }
  int qx = round_to_int((x + 1.0) * 2047.0), qy = round_to_int((y + 1.0) * 2047.0);
  code[0] = (uint8_t)qx;
  code[1] = (uint8_t)(qx >> 8 | (qy & 15) << 4);
  code[2] = (uint8_t)(qy >> 4);
}

void conic_code_normal_of(const uint8_t code[3], double normal[3]) {
  double x = (double)(code[0] | (code[1] & 15) << 8) / 2047.0 - 1.0;
  double y = (double)(code[1] >> 4 | code[2] << 4) / 2047.0 - 1.0;
  double z = 1.0 - fabs(x) - fabs(y);
  /* Both are worked out, for which half it is cannot be foreseen. Neither coordinate is -0. */
  const double xs[2] = {x, (1.0 - fabs(y)) * copysign(1.0, x)}, ys[2] = {y, (1.0 - fabs(x)) * copysign(1.0, y)};
  x = xs[z < 0.0];
  y = ys[z < 0.0];
  double length = sqrt(x * x + y * y + z * z);
  normal[0] = x / length;
  normal[1] = y / length;
  normal[2] = z / length;
}

/* By the tangent of half the angle, which is within ±1 for a direction without sign. */
uint8_t conic_code_direction(double x, double y) {
  double length = sqrt(x * x + y * y);
  double half = x >= 0.0 ? y / (length + x) : -y / (length - x);
  return (uint8_t)round_to_int((half + 1.0) * 127.5);
}

void conic_code_direction_of(uint8_t code, double direction[2]) {
  double half = (double)code / 127.5 - 1.0, scale = 1.0 / (1.0 + half * half);
  direction[0] = (1.0 - half * half) * scale;
  direction[1] = 2.0 * half * scale;
}

uint8_t conic_code_factor(const conic_code_scale *scale, double factor) {
  int low = 1, high = 255; /* the greatest that is not more than half a step above */
  double most = factor * scale->octave[OCTAVE_STEPS / 32];
  if (!(factor > 0.0))
    return 0;
  while (low < high) {
    int middle = (low + high + 1) / 2;
    if (scale->factor[middle] <= most)
      low = middle;
    else
      high = middle - 1;
  }
  return (uint8_t)low;
}

float conic_code_factor_of(const conic_code_scale *scale, uint8_t code) {
  return (float)scale->factor[code];
}

void conic_code_place(const conic_code_scale *scale, const double mean[3], const double first[3], uint8_t *code) {
  double longest = 0.0;
  uint32_t bits = 0;
  int exponent = 0;
  for (int axis = 0; axis < 3; axis++)
    longest = fabs(mean[axis] - first[axis]) > longest ? fabs(mean[axis] - first[axis]) : longest;
  while (exponent < 31 && scale->length * conic_power_of_two(-exponent - 1) * (255.0 / 256.0) >= longest)
    exponent++;
  double unit = scale->length * conic_power_of_two(-exponent - 8);
  for (int axis = 0; axis < 3; axis++) {
    int steps = round_to_int((mean[axis] - first[axis]) / unit);
    steps = steps < -255 ? -255 : steps > 255 ? 255 : steps;
    bits |= (uint32_t)(steps + 256) << 9 * axis;
  }
  bits |= (uint32_t)exponent << 27;
  conic_store_32(code + AT_PLACE, bits);
}

static void decode_place(const conic_code_scale *scale, const double first[3], const uint8_t *code,
                         double position[3]) {
  uint32_t bits = conic_load_32(code + AT_PLACE);
  double unit = scale->length * conic_power_of_two(-(int)(bits >> 27) - 8);
  for (int axis = 0; axis < 3; axis++) /* as a float, as it will be drawn */
    position[axis] = (double)(float)(first[axis] + unit * (double)((int)(bits >> 9 * axis & 511) - 256));
}

void conic_code_facing(const double normal[3], uint8_t *code) {
  conic_code_normal(normal, code + AT_NORMAL);
}

void conic_code_axes(double x, double y, double ratio, uint8_t *code) {
  int steps = (int)ceil(ratio * 255.0);
  code[AT_DIRECTION] = conic_code_direction(x, y);
  code[AT_RATIO] = (uint8_t)(steps < 1 ? 1 : steps > 255 ? 255 : steps);
}

void conic_code_basis(const uint8_t *code, double u[3], double v[3], double n[3]) {
  conic_code_normal_of(code + AT_NORMAL, n);
  conic_tangent_basis(n, u, v);
}

void conic_code_frame_in(const conic_code_scale *scale, const double first[3], const uint8_t *code, const double u[3],
                         const double v[3], const double n[3], conic_node_frame *frame) {
  double direction[2];
  decode_place(scale, first, code, frame->position);
  conic_code_direction_of(code[AT_DIRECTION], direction);
  for (int axis = 0; axis < 3; axis++) {
    frame->u[axis] = direction[0] * u[axis] + direction[1] * v[axis];
    frame->v[axis] = direction[0] * v[axis] - direction[1] * u[axis];
    frame->n[axis] = n[axis];
  }
  frame->ratio = (double)(code[AT_RATIO] ? code[AT_RATIO] : 1) / 255.0;
}

void conic_code_frame(const conic_code_scale *scale, const double first[3], const uint8_t *code,
                      conic_node_frame *frame) {
  double u[3], v[3], n[3];
  conic_code_basis(code, u, v, n);
  conic_code_frame_in(scale, first, code, u, v, n, frame);
}

void conic_code_extent(const conic_code_scale *scale, double *reach, double *radius, uint8_t *code) {
  double longest = scale->length * scale->cutoff, widest = scale->widening[255];
  double wanted = *reach * widest > *radius ? *reach : *radius / widest * (1.0 + 1e-12);
  uint16_t steps = conic_code_length(scale, longest, wanted);
  *reach = conic_code_length_of(scale, longest, steps);
  conic_store_bits(code + AT_REACH, 2, steps);
  int widening = 0;
  while (widening < 255 && *reach * scale->widening[widening] < *radius)
    widening++;
  code[AT_RADIUS] = (uint8_t)widening;
  *radius = *reach * scale->widening[widening];
}

double conic_code_error(const conic_code_scale *scale, double error, double radius, uint8_t *code) {
  double ratio = 2.0 * radius / error;
  int steps = ratio > 1.0 && ratio < 0x1p16 ? guess_steps(ratio, SHARE_STEPS) : ratio > 1.0 ? 255 : 0;
  steps = steps < 255 ? steps : 255;
  while (steps > 0 && !(2.0 * radius * scale->share[steps] >= error)) /* the most that still give `error` or more */
    steps--;
  while (steps < 255 && 2.0 * radius * scale->share[steps + 1] >= error)
    steps++;
  code[AT_ERROR] = (uint8_t)steps;
  return 2.0 * radius * scale->share[steps];
}

/* 1 - 2(q/255)²: q is the sine of half the angle, which has steps where cosines have none. */
static double cone_of(uint8_t code) {
  double half = (double)code / 255.0;
  return 1.0 - 2.0 * half * half;
}

void conic_code_cone(double cosine, uint8_t *code) {
  double half2 = 0.5 * (1.0 - cosine);
  int steps = half2 > 0.0 ? (int)(255.0 * sqrt(half2 < 1.0 ? half2 : 1.0)) - 1 : 0; /* or one more, or two */
  steps = steps > 0 ? steps : 0;
  while (steps < 255 && cone_of((uint8_t)steps) > cosine)
    steps++;
  code[AT_CONE] = (uint8_t)steps;
}

void conic_code_color(const conic_code_scale *scale, const double color[3], double opacity, uint8_t *code) {
  for (int channel = 0; channel < 3; channel++)
    code[AT_COLOR + channel] = conic_code_srgb(scale, (float)(color[channel] / (double)scale->color));
  code[AT_OPACITY] = conic_code_factor(scale, opacity);
}

void conic_code_children(int n_direct, int n_inner, uint8_t *code) {
  code[AT_CHILDREN] = (uint8_t)(n_direct | n_inner << 4);
}

int conic_code_n_direct(const uint8_t *code) {
  return code[AT_CHILDREN] & 15;
}

int conic_code_n_inner(const uint8_t *code) {
  return code[AT_CHILDREN] >> 4;
}

static double reach_of_code(const conic_code_scale *scale, const uint8_t *code) {
  return conic_code_length_of(scale, scale->length * scale->cutoff, conic_load_16(code + AT_REACH));
}

float conic_code_radius_of(const conic_code_scale *scale, const uint8_t *code) {
  return (float)(reach_of_code(scale, code) * scale->widening[code[AT_RADIUS]]);
}

float conic_code_cone_of(const uint8_t *code) {
  return (float)cone_of(code[AT_CONE]);
}

void conic_code_sphere(const conic_code_scale *scale, const double first[3], const uint8_t *code, float center[3],
                       float *radius) {
  double position[3];
  decode_place(scale, first, code, position);
  for (int axis = 0; axis < 3; axis++)
    center[axis] = (float)position[axis];
  *radius = conic_code_radius_of(scale, code);
}

void conic_code_decode(const conic_code_scale *scale, const double first[3], const uint8_t *code, conic_node *node) {
  conic_node_frame frame;
  conic_code_frame(scale, first, code, &frame);
  double reach = reach_of_code(scale, code), radius = reach * scale->widening[code[AT_RADIUS]];
  double major = reach / scale->cutoff;
  for (int axis = 0; axis < 3; axis++) {
    node->position[axis] = (float)frame.position[axis];
    node->tangent_u[axis] = (float)(major * frame.u[axis]);
    node->tangent_v[axis] = (float)(major * frame.ratio * frame.v[axis]);
    node->normal[axis] = (float)frame.n[axis];
    node->color[axis] = scale->color * scale->colors[code[AT_COLOR + axis]];
  }
  node->opacity = conic_code_factor_of(scale, code[AT_OPACITY]);
  node->radius = (float)radius;
  node->error = (float)(2.0 * radius * scale->share[code[AT_ERROR]]);
  node->cone = (float)cone_of(code[AT_CONE]);
}
