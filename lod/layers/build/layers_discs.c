/* How far full resolution is from the discs that stand for it, found by holding discs against discs. */

#include "lod/layers/build/layers_thin.h"

enum { MOST_BESIDE = 256, N_CORNERS = 16 };

/* A disc that is held against the chosen ones about it. */
typedef struct disc_search {
  const conic_layers_chosen *chosen;
  const conic_layers_disc *disc;
  uint32_t beside[MOST_BESIDE]; /* where there are more, those left out could only be nearer */
  size_t n_beside;
} disc_search;

/* All of the disc is no farther than this from one that was chosen: by how high it lies above that, how much it is or
 * may be turned against it, and how far it reaches past it. */
static float error_from_one(const disc_search *p, uint32_t i_chosen, int is_turn_known) {
  const conic_layers_disc *disc = p->disc, *s = &p->chosen->discs[i_chosen];
  float height = 0.0f, way2 = 0.0f, turn = 1.0f;
  for (int axis = 0; axis < 3; axis++) {
    float way = disc->center[axis] - s->center[axis];
    height += way * s->normal[axis];
    way2 += way * way;
  }
  if (is_turn_known) {
    const float *n = disc->normal;
    float cosine = n[0] * s->normal[0] + n[1] * s->normal[1] + n[2] * s->normal[2], sine2 = 1.0f - cosine * cosine;
    turn = sine2 > 0.0f ? sqrtf(sine2) : 0.0f;
  }
  float past = sqrtf(way2) + disc->radius - s->radius;
  return fabsf(height) + disc->radius * turn + (past > 0.0f ? past : 0.0f);
}

/* How far a place is from the discs beside; or no more than `enough`. */
static float error_from_nearest(const conic_layers_disc *from, const uint32_t *list, size_t n, const float at[3],
                                float enough) {
  float nearest2 = HUGE_VALF, enough2 = enough > 0.0f ? enough * enough : 0.0f;
  for (size_t i = 0; i < n && !(nearest2 <= enough2); i++) {
    const conic_layers_disc *s = &from[list ? list[i] : i];
    float height = 0.0f, way2 = 0.0f;
    for (int axis = 0; axis < 3; axis++) {
      float way = at[axis] - s->center[axis];
      height += way * s->normal[axis];
      way2 += way * way;
    }
    float along2 = way2 - height * height, past = along2 > 0.0f ? sqrtf(along2) - s->radius : 0.0f;
    float error2 = height * height + (past > 0.0f ? past * past : 0.0f);
    nearest2 = error2 < nearest2 ? error2 : nearest2;
  }
  return sqrtf(nearest2);
}

/* The farthest of the disc's middle and the corners of a polygon around it. The polygon is turned by an angle. */
static float error_of_places(const conic_layers_disc *disc, const conic_layers_disc *from, const uint32_t *list,
                             size_t n_from, const float turn[2], float enough) {
  static const float corners[4][2] = {
      {1.0f, 0.19891237f}, {0.84775907f, 0.56645450f}, {0.56645450f, 0.84775907f}, {0.19891237f, 1.0f}};
  const float *n = disc->normal, radius = disc->radius;
  float sign = n[2] >= 0.0f ? 1.0f : -1.0f, a = -1.0f / (sign + n[2]), b = n[0] * n[1] * a;
  const float u[3] = {1.0f + sign * (n[0] * n[0]) * a, sign * b, -sign * n[0]};
  const float v[3] = {b, sign + n[1] * n[1] * a, -n[1]};
  float farthest = error_from_nearest(from, list, n_from, disc->center, enough);
  for (int i = 0; i < N_CORNERS; i++) {
    float x = corners[i % 4][0] * (i & 4 ? -radius : radius), y = corners[i % 4][1] * (i & 8 ? -radius : radius), at[3];
    float along_u = x * turn[0] - y * turn[1], along_v = x * turn[1] + y * turn[0];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = disc->center[axis] + along_u * u[axis] + along_v * v[axis];
    float error = error_from_nearest(from, list, n_from, at, enough);
    farthest = error > farthest ? error : farthest;
  }
  return farthest;
}

float conic_layers_disc_off(const conic_layers_disc *disc, const conic_layers_disc *from, size_t n, float enough) {
  const float turn[2] = {1.0f, 0.0f};
  return error_of_places(disc, from, NULL, n, turn, enough);
}

/* Looks also at corners of the same polygon turned, where places between the corners could come to more than enough.
 * They lie within a fifth of the radius of its corners, so that nothing else decides whether one counts. */
static float error_of_more_places(const disc_search *p, float enough) {
  static const float turns[4][2] = {
      {1.0f, 0.0f}, {0.99518473f, 0.09801714f}, {0.98078528f, 0.19509032f}, {0.95694034f, 0.29028468f}};
  float nearly = enough - 0.2f * p->disc->radius,
        farthest = error_of_places(p->disc, p->chosen->discs, p->beside, p->n_beside, turns[0], nearly);
  for (int i = 1; i < 4 && farthest > nearly; i++) {
    float error = error_of_places(p->disc, p->chosen->discs, p->beside, p->n_beside, turns[i], enough);
    farthest = error > farthest ? error : farthest;
  }
  return farthest;
}

/* How far the disc is from the chosen ones; `enough`, or less, where it is no more than that. *last is one that may do,
 * and then the one that did. */
static float error_of_disc(disc_search *p, float enough, uint32_t *last) {
  float least = error_from_one(p, *last, 1);
  if (least <= enough)
    return least;
  least = HUGE_VALF; /* which is of this disc, whatever came before */
  for (int is_wide = 0; is_wide < 2; is_wide++) {
    p->n_beside = conic_thinner_beside(p->chosen->thinner, p->disc->center, is_wide, p->beside, MOST_BESIDE);
    for (size_t i = 0; i < p->n_beside; i++) {
      float error = error_from_one(p, p->beside[i], 1);
      if (error <= enough) {
        *last = p->beside[i];
        return error;
      }
      least = error < least ? error : least;
    }
  }
  if (p->n_beside == 0)
    return error_from_one(p, 0, 1);
  float measured = error_of_more_places(p, enough);
  return measured < least ? measured : least;
}

double conic_layers_disc_error(const conic_layers_chosen *chosen, const conic_layers_disc *discs, size_t n,
                               double beyond, double error) {
  disc_search p = {.chosen = chosen};
  uint32_t last = 0;
  for (size_t i = 0; i < n; i++) {
    float enough = (float)(error - beyond);
    p.disc = &discs[i];
    if (error_from_one(&p, last, 0) <= enough)
      continue;
    double found = (double)error_of_disc(&p, enough, &last) + beyond;
    error = found > error ? found : error;
  }
  return error;
}
