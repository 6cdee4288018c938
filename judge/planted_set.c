#include "judge/planted_set.h"

#include <math.h>

#include "gaussians/scene/activation.h"

static float planted_scale(conic_planted_reading reading, const conic_gaussians *from, int axis, size_t i) {
  float scale = from->scale[axis][i];
  switch (reading) {
  case CONIC_READING_RAW: /* only its square is visible */
    return fabsf(conic_gaussians_log_scale(from, axis, i));
  case CONIC_READING_TWICE:
    return conic_scale_of_log(scale);
  case CONIC_READING_LENGTH_SQUARED:
    for (int k = 0; k < 4; k++)
      scale =
          k == 0 ? from->rotation[0][i] * from->rotation[0][i] : scale + from->rotation[k][i] * from->rotation[k][i];
    return scale * from->scale[axis][i];
  case CONIC_READING_OWN:
  case CONIC_READING_RAW_LIMITED:
  case CONIC_READING_CONJUGATE:
    break;
  }
  return scale;
}

static float planted_opacity(conic_planted_reading reading, const conic_gaussians *from, size_t i) {
  float raw;
  switch (reading) {
  case CONIC_READING_RAW:
    return conic_gaussians_logit(from, i);
  case CONIC_READING_RAW_LIMITED:
    raw = conic_gaussians_logit(from, i);
    return raw > 0.0f ? (raw < 1.0f ? raw : 1.0f) : 0.0f;
  case CONIC_READING_TWICE:
    return conic_opacity_of_logit(from->opacity[i]);
  case CONIC_READING_OWN:
  case CONIC_READING_LENGTH_SQUARED:
  case CONIC_READING_CONJUGATE:
    break;
  }
  return from->opacity[i];
}

/* Where coefficient k of channel c is read from; there are n above degree 0. */
static size_t place_of_harmonic(conic_planted_reading reading, size_t n, size_t k, size_t c) {
  size_t raw = reading == CONIC_READING_RAW ? 3 * k + c : n * c + k;
  if (reading == CONIC_READING_RAW) /* of a file that has channel by channel */
    return 3 * (raw % n) + raw / n;
  return reading == CONIC_READING_TWICE ? raw : 3 * k + c;
}

static void plant_harmonics(const conic_planted *p, const conic_gaussians *from, size_t first, conic_gaussians *to,
                            float *sh) {
  const size_t n_from = conic_harmonics_of_degree(from->sh_degree), n_to = conic_harmonics_of_degree(to->sh_degree);
  float room[CONIC_MOST_HARMONICS];
  for (size_t i = 0; i < to->count; i++) {
    const float *own = conic_gaussians_harmonics(from, first + i, room);
    for (size_t c = 0; c < 3; c++) {
      sh[i * n_to + c] = own[c];
      for (size_t k = 0; 3 * k + 3 < n_to; k++)
        sh[i * n_to + 3 * (k + 1) + c] = own[3 + place_of_harmonic(p->harmonics, n_from / 3 - 1, k, c)];
    }
  }
  to->sh = sh;
  to->sh_half = NULL;
}

conic_gaussians conic_planted_read(const conic_planted *p, const conic_gaussians *from, size_t first, size_t n,
                                   conic_planted_run *room) {
  static const int order[][4] = {[CONIC_READING_OWN] = {0, 1, 2, 3},
                                 [CONIC_READING_RAW] = {3, 0, 1, 2},
                                 [CONIC_READING_TWICE] = {1, 2, 3, 0},
                                 [CONIC_READING_CONJUGATE] = {0, 1, 2, 3}};
  const size_t n_harmonics = conic_harmonics_of_degree(from->sh_degree);
  conic_gaussians to = *from;
  to.count = n;
  for (int k = 0; k < 3; k++) {
    to.position[k] = from->position[k] + first;
    to.scale[k] = from->scale[k] ? from->scale[k] + first : NULL;
    for (size_t i = 0; p->scale && to.scale[k] && i < n; i++)
      room->scale[k][i] = planted_scale(p->scale, from, k, first + i);
    if (p->scale && to.scale[k])
      to.scale[k] = room->scale[k];
  }
  for (int k = 0; k < 4; k++)
    to.rotation[k] = from->rotation[order[p->rotation][k]] + first;
  for (size_t i = 0; p->rotation == CONIC_READING_CONJUGATE && i < n; i++)
    room->w[i] = -from->rotation[0][first + i];
  if (p->rotation == CONIC_READING_CONJUGATE)
    to.rotation[0] = room->w;
  for (size_t i = 0; p->opacity && i < n; i++)
    room->opacity[i] = planted_opacity(p->opacity, from, first + i);
  to.opacity = p->opacity ? room->opacity : from->opacity + first;
  to.sh = from->sh ? from->sh + first * n_harmonics : NULL;
  to.sh_half = from->sh_half ? from->sh_half + first * n_harmonics : NULL;
  to.sh_degree = p->most_degree < from->sh_degree ? p->most_degree : from->sh_degree;
  if (p->harmonics || to.sh_degree < from->sh_degree)
    plant_harmonics(p, from, first, &to, room->sh);
  return to;
}
