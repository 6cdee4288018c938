#include "lod/layers/format/layers_axes.h"

#include "core/base/vectors.h"

/* Codes 0 to twice the half are −1 to 1, so that the axes are exact. */
enum { COARSE_HALF = 127, FINE_HALF = 32767, AXES_TURN_BITS = 16, LINE_BITS = 24 };

/* The most of c over the length of (a, b). Farther out a line cuts nothing or all. */
static const double farthest_line = 8.0, most_of_line = 16777215.0;

static int round_to_int(float value) {
  return (int)floorf(value + 0.5f);
}

static void fold_out(float *x, float *y) {
  float folded = (1.0f - fabsf(*y)) * (*x < 0.0f ? -1.0f : 1.0f);
  *y = (1.0f - fabsf(*x)) * (*y < 0.0f ? -1.0f : 1.0f);
  *x = folded;
}

static void code_octahedron(const float normal[3], float half, int code[2]) {
  float sum = fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]);
  float x = normal[0] / sum, y = normal[1] / sum;
  if (normal[2] < 0.0f) /* the lower half is folded out */
    fold_out(&x, &y);
  code[0] = round_to_int((x + 1.0f) * half);
  code[1] = round_to_int((y + 1.0f) * half);
}

static void octahedron_of(const int code[2], float half, float normal[3]) {
  float x = ((float)code[0] - half) / half, y = ((float)code[1] - half) / half, z = 1.0f - fabsf(x) - fabsf(y);
  if (z < 0.0f)
    fold_out(&x, &y);
  float length = sqrtf(x * x + y * y + z * z);
  normal[0] = x / length;
  normal[1] = y / length;
  normal[2] = z / length;
}

void conic_layers_code_normal(const float normal[3], uint8_t code[2]) {
  int wide[2];
  code_octahedron(normal, (float)COARSE_HALF, wide);
  code[0] = (uint8_t)wide[0];
  code[1] = (uint8_t)wide[1];
}

void conic_layers_normal_of(const uint8_t code[2], float normal[3]) {
  const int wide[2] = {code[0], code[1]};
  octahedron_of(wide, (float)COARSE_HALF, normal);
}

void conic_layers_code_fine_normal(const float normal[3], uint16_t code[2]) {
  int wide[2];
  code_octahedron(normal, (float)FINE_HALF, wide);
  code[0] = (uint16_t)wide[0];
  code[1] = (uint16_t)wide[1];
}

void conic_layers_fine_normal_of(const uint16_t code[2], float normal[3]) {
  const int wide[2] = {code[0], code[1]};
  octahedron_of(wide, (float)FINE_HALF, normal);
}

void conic_layers_frame(const float normal[3], float u[3], float v[3]) {
  float nx = normal[0], ny = normal[1], nz = normal[2];
  float sign = nz >= 0.0f ? 1.0f : -1.0f, a = -1.0f / (sign + nz), b = nx * ny * a;
  u[0] = 1.0f + sign * (nx * nx) * a;
  u[1] = sign * b;
  u[2] = -sign * nx;
  v[0] = b;
  v[1] = sign + ny * ny * a;
  v[2] = -ny;
}

/* A direction in the plane as a diamond angle, of so many bits a turn: along the edges of |x| + |y| = 1. */
static uint32_t code_turn(double x, double y, unsigned n_bits) {
  double along = y / (fabs(x) + fabs(y)); /* -1 to 1 */
  double turn = x >= 0.0 ? along : 2.0 - along;
  return (uint32_t)((int64_t)floor(turn * (double)(1u << (n_bits - 2)) + 0.5) & ((INT64_C(1) << n_bits) - 1));
}

static void turn_of(uint32_t code, unsigned n_bits, double *x, double *y) {
  double turn = (double)code / (double)(1u << (n_bits - 2)); /* 0 to 4 */
  *y = turn <= 1.0 ? turn : turn <= 3.0 ? 2.0 - turn : turn - 4.0;
  *x = turn <= 1.0 || turn >= 3.0 ? 1.0 - fabs(*y) : fabs(*y) - 1.0;
  double length = sqrt(*x * *x + *y * *y);
  *x /= length;
  *y /= length;
}

int conic_layers_code_axes(const float u[3], const float v[3], conic_layers_axes *axes) {
  double a[3], b[3], cross[3], along[2] = {0.0, 0.0};
  float normal[3], coded[3], frame[2][3];
  for (int axis = 0; axis < 3; axis++) {
    a[axis] = (double)u[axis];
    b[axis] = (double)v[axis];
  }
  conic_cross(a, b, cross);
  double length = conic_length(cross);
  memset(axes, 0, sizeof *axes);
  if (!(length > 0.0) || !(length - length == 0.0))
    return 0;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = (float)(cross[axis] / length);
  axes->length[0] = (float)conic_length(a);
  axes->length[1] = (float)conic_length(b);
  conic_layers_code_fine_normal(normal, axes->normal);
  conic_layers_fine_normal_of(axes->normal, coded);
  conic_layers_frame(coded, frame[0], frame[1]);
  for (int axis = 0; axis < 3; axis++) {
    along[0] += a[axis] * (double)frame[0][axis];
    along[1] += a[axis] * (double)frame[1][axis];
  }
  if (!(fabs(along[0]) + fabs(along[1]) > 0.0))
    return 0;
  axes->turn = (uint16_t)code_turn(along[0], along[1], AXES_TURN_BITS);
  return 1;
}

void conic_layers_axes_of(const conic_layers_axes *axes, float u[3], float v[3], float normal[3]) {
  float frame[2][3];
  double x, y;
  conic_layers_fine_normal_of(axes->normal, normal);
  conic_layers_frame(normal, frame[0], frame[1]);
  turn_of(axes->turn, AXES_TURN_BITS, &x, &y);
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (float)(x * (double)frame[0][axis] + y * (double)frame[1][axis]);
    v[axis] = (float)(x * (double)frame[1][axis] - y * (double)frame[0][axis]);
  }
}

uint16_t conic_layers_code_size(float size) {
  if (!(size > 0.0f && size < 1e30f))
    return 0;
  uint32_t bits = conic_bits_of_float(size) + 0xffff;
  return (uint16_t)(bits >> 16 ? bits >> 16 : 1);
}

float conic_layers_size_of(uint16_t code) {
  return conic_float_of_bits((uint32_t)code << 16);
}

void conic_layers_code_lines(const conic_clip *clip, conic_layers_lines *lines) {
  memset(lines, 0, sizeof *lines);
  for (int i = 0; i < clip->n_lines && i < 2; i++) {
    double a = (double)clip->lines[i][0], b = (double)clip->lines[i][1], c = (double)clip->lines[i][2];
    double off = c / sqrt(a * a + b * b);
    if (!(fabs(a) + fabs(b) > 0.0) || !(off - off == 0.0))
      continue;
    off = off > -farthest_line ? off < farthest_line ? off : farthest_line : -farthest_line;
    lines->line[lines->kind][0] = code_turn(a, b, LINE_BITS);
    lines->line[lines->kind][1] = (uint32_t)floor((off + farthest_line) / (2.0 * farthest_line) * most_of_line + 0.5);
    lines->kind++;
  }
  if (lines->kind == 2 && clip->operation == CONIC_CLIP_OR)
    lines->kind = 3;
}

int conic_layers_lines_of(const conic_layers_lines *lines, conic_clip *clip) {
  memset(clip, 0, sizeof *clip);
  clip->n_lines = lines->kind < 2 ? (uint16_t)lines->kind : 2;
  clip->operation = lines->kind == 3 ? CONIC_CLIP_OR : CONIC_CLIP_AND;
  for (int i = 0; i < clip->n_lines; i++) {
    double a, b;
    turn_of(lines->line[i][0], LINE_BITS, &a, &b);
    clip->lines[i][0] = (float)a;
    clip->lines[i][1] = (float)b;
    clip->lines[i][2] = (float)((double)lines->line[i][1] / most_of_line * (2.0 * farthest_line) - farthest_line);
  }
  return clip->n_lines > 0;
}
