/* Vectors of three floats. Sums go from the first component to the last. C and OpenCL C share this text. */
#pragma once

#include <math.h>

static inline float conic_float_dot(const float a[3], const float b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* Fills `unit`, zero where a is; returns a's length. */
static inline float conic_float_unit(const float a[3], float unit[3]) {
  float length = sqrtf(conic_float_dot(a, a)), scale = length > 0.0f ? 1.0f / length : 0.0f;
  for (int axis = 0; axis < 3; axis++)
    unit[axis] = a[axis] * scale;
  return length;
}
