/* How far two scenes are apart, Gaussian by Gaussian. */

#include "core/base/vectors.h"
#include "gaussians/scene/gaussian_set.h"

/* 0 where both have the same bits. */
static double difference_of(float a, float b) {
  if (conic_bits_of_float(a) == conic_bits_of_float(b) || a == b || (a != a && b != b))
    return 0.0;
  double apart = fabs((double)a - (double)b);
  return apart >= 0.0 ? apart : conic_double_of_bits(UINT64_C(0x7ff0000000000000));
}

static void raise_to(double *greatest, double value) {
  *greatest = value > *greatest ? value : *greatest;
}

/* The angle between the axes of two quaternions of any length: twice that between these, by the chord, which does not
 * cancel. */
static double find_angle_deg(const conic_gaussians *a, const conic_gaussians *b, size_t i) {
  double p[4], q[4], length_p = 0.0, length_q = 0.0, dot = 0.0, chord = 0.0;
  for (int k = 0; k < 4; k++) {
    p[k] = (double)a->rotation[k][i];
    q[k] = (double)b->rotation[k][i];
    length_p += p[k] * p[k];
    length_q += q[k] * q[k];
    dot += p[k] * q[k];
  }
  int is_p = length_p > 0.0 && conic_is_finite(length_p), is_q = length_q > 0.0 && conic_is_finite(length_q);
  if (!is_p || !is_q)
    return is_p == is_q ? 0.0 : 180.0;
  for (int k = 0; k < 4; k++) {
    double apart = p[k] / sqrt(length_p) - (dot < 0.0 ? -q[k] : q[k]) / sqrt(length_q);
    chord += apart * apart;
  }
  double half = 0.5 * sqrt(chord); /* sine of half the angle between the quaternions; at most sin 45° */
  double series = half + half * half * half / 6.0 + 0.075 * half * half * half * half * half;
  return series * 4.0 * (180.0 / 3.14159265358979323846);
}

static void compare_harmonics(const conic_gaussians *a, const conic_gaussians *b, size_t i,
                              conic_gaussians_differences *found) {
  float room_a[CONIC_MOST_HARMONICS], room_b[CONIC_MOST_HARMONICS];
  size_t n_a = conic_harmonics_of_degree(a->sh_degree), n_b = conic_harmonics_of_degree(b->sh_degree);
  const float *of_a = conic_gaussians_harmonics(a, i, room_a), *of_b = conic_gaussians_harmonics(b, i, room_b);
  for (size_t k = 0; k < n_a || k < n_b; k++) {
    double apart = difference_of(k < n_a ? of_a[k] : 0.0f, k < n_b ? of_b[k] : 0.0f);
    raise_to(k < 3 ? &found->color : &found->harmonics, k < 3 ? apart * CONIC_SH_CONSTANT : apart);
  }
  found->is_same &= n_a == n_b;
}

static void compare_one(const conic_gaussians *a, const conic_gaussians *b, size_t i,
                        conic_gaussians_differences *found) {
  for (int axis = 0; axis < 3; axis++) {
    double of_a = conic_gaussians_mean(a, axis, i), of_b = conic_gaussians_mean(b, axis, i), apart = fabs(of_a - of_b);
    if (of_a != of_b && !(of_a != of_a && of_b != of_b))
      raise_to(&found->position, apart >= 0.0 ? apart : conic_double_of_bits(UINT64_C(0x7ff0000000000000)));
    if (!a->scale[axis] || !b->scale[axis])
      continue;
    double larger = fabs((double)a->scale[axis][i]), other = fabs((double)b->scale[axis][i]);
    larger = other > larger ? other : larger;
    raise_to(&found->scale, difference_of(a->scale[axis][i], b->scale[axis][i]) / (larger > 0.0 ? larger : 1.0));
    if (a->log_scale[axis] && b->log_scale[axis])
      found->is_same &= difference_of(a->log_scale[axis][i], b->log_scale[axis][i]) == 0.0;
  }
  for (int k = 0; k < 4; k++)
    found->is_same &= difference_of(a->rotation[k][i], b->rotation[k][i]) == 0.0;
  raise_to(&found->rotation_deg, find_angle_deg(a, b, i));
  raise_to(&found->opacity, difference_of(a->opacity[i], b->opacity[i]));
  if (a->logit_opacity && b->logit_opacity)
    found->is_same &= difference_of(a->logit_opacity[i], b->logit_opacity[i]) == 0.0;
  compare_harmonics(a, b, i, found);
}

conic_status conic_gaussians_compare(conic_context *context, const conic_gaussians *a, const conic_gaussians *b,
                                     conic_gaussians_differences *differences) {
  memset(differences, 0, sizeof *differences);
  conic_status status = conic_gaussians_check(context, a, "gaussians");
  if (status == CONIC_OK)
    status = conic_gaussians_check(context, b, "gaussians");
  if (status != CONIC_OK)
    return status;
  if (a->count != b->count)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gaussians: sets of %zu and %zu cannot be compared", a->count,
                      b->count);
  double up_a[3], up_b[3];
  conic_gaussians_find_up(a, up_a);
  conic_gaussians_find_up(b, up_b);
  differences->is_same = conic_dot(up_a, up_b) > 1.0 - 1e-12 && a->is_antialiased == b->is_antialiased &&
                         a->is_linear == b->is_linear && (a->scale[2] == NULL) == (b->scale[2] == NULL) &&
                         memcmp(a->frame, b->frame, 4) == 0;
  for (size_t i = 0; i < a->count; i++)
    compare_one(a, b, i, differences);
  const double greatest[] = {differences->position, differences->scale, differences->opacity, differences->color,
                             differences->harmonics};
  for (size_t i = 0; i < sizeof greatest / sizeof *greatest; i++)
    differences->is_same &= greatest[i] == 0.0;
  return CONIC_OK;
}
