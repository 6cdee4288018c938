#include "lighting/lamps.h"

#include <string.h>

#include "accumulation/disc_point.h"
#include "accumulation/sequence.h"
#include "core/base/options.h"
#include "core/base/trigonometry.h"
#include "lighting/light_axes.h"

static int are_lengths(const double *of, int n) {
  for (int i = 0; i < n; i++)
    if (!(fabs(of[i]) < 1e20))
      return 0;
  return 1;
}

static const char *fault_of_lamp(const conic_lamp *lamp) {
  double normal[3];
  if (lamp->kind != CONIC_LAMP_SPHERE && lamp->kind != CONIC_LAMP_DISC && lamp->kind != CONIC_LAMP_RECTANGLE)
    return "a lamp is of an unknown kind";
  if (!conic_is_zero(lamp->reserved, sizeof lamp->reserved))
    return "a lamp's reserved words are not zero";
  for (int c = 0; c < 3; c++)
    if (!(lamp->color[c] >= 0.0f && lamp->color[c] <= 1e12f))
      return "a lamp's colour is not within 0 and 1e12";
  if (!are_lengths(lamp->position, 3) || !are_lengths(&lamp->radius, 1) || lamp->radius < 0.0)
    return "a lamp's place or radius is none";
  conic_cross(lamp->axes[0], lamp->axes[1], normal);
  if (lamp->kind != CONIC_LAMP_SPHERE &&
      (!are_lengths(lamp->axes[0], 3) || !are_lengths(lamp->axes[1], 3) || !conic_normalize(normal)))
    return "a lamp's axes span nothing";
  return NULL;
}

const char *conic_lamps_fault(const conic_lighting_options *options) {
  const char *fault = NULL;
  if (options->n_lamps > CONIC_MAX_LAMPS || (options->n_lamps > 0 && !options->lamps))
    return "there are 0 to 8 lamps";
  for (size_t i = 0; i < options->n_lamps && !fault; i++)
    fault = fault_of_lamp(&options->lamps[i]);
  return fault;
}

/* A point of the sphere; equal areas are equally likely. Heights are measured towards `onto`, so that even few samples
 * send the right amount of light there, on average. */
static void shine_from_sphere(double u, double v, const double onto[3], conic_lamp_point *point) {
  double height = 1.0 - 2.0 * u, around = sqrt((1.0 - height) * (1.0 + height)), angle = 2.0 * CONIC_PI * v;
  double way[3], rows[3][3];
  point->is_middle = !(point->lamp->radius > 0.0);
  conic_subtract(onto, point->place, way);
  if (!conic_normalize(way))
    memcpy(way, (const double[3]){0.0, 0.0, 1.0}, sizeof way);
  conic_light_axes(way, rows);
  for (int axis = 0; axis < 3; axis++) {
    point->normal[axis] =
        around * (conic_cos(angle) * rows[0][axis] + conic_sin(angle) * rows[1][axis]) + height * way[axis];
    point->place[axis] += point->lamp->radius * point->normal[axis];
  }
}

static void shine_from_plane(double u, double v, conic_lamp_point *point) {
  double place[2] = {2.0 * u - 1.0, 2.0 * v - 1.0};
  if (point->lamp->kind == CONIC_LAMP_DISC)
    conic_disc_point(u, v, place);
  for (int axis = 0; axis < 3; axis++)
    point->place[axis] += place[0] * point->lamp->axes[0][axis] + place[1] * point->lamp->axes[1][axis];
}

void conic_lamp_shine(const conic_lamp *lamp, const conic_lighting_options *options, const double onto[3],
                      double nearest, conic_lamp_point *point) {
  double u = conic_sequence_at(options->first_direction, CONIC_SEQUENCE_DIRECTION),
         v = conic_sequence_at(options->first_direction, CONIC_SEQUENCE_DIRECTION + 1);
  *point = (conic_lamp_point){.lamp = lamp, .is_middle = 1, .nearest = nearest};
  memcpy(point->place, lamp->position, sizeof point->place);
  if (lamp->kind != CONIC_LAMP_SPHERE) {
    conic_cross(lamp->axes[0], lamp->axes[1], point->normal);
    conic_normalize(point->normal);
  }
  if (!options->is_sample)
    return;
  if (lamp->kind == CONIC_LAMP_SPHERE)
    shine_from_sphere(u, v, onto, point);
  else
    shine_from_plane(u, v, point);
}

double conic_lamp_strength(const conic_lamp_point *point, const double at[3], double towards[3]) {
  double square, least = point->nearest * point->nearest, cosine = 0.0;
  conic_subtract(point->place, at, towards);
  square = conic_dot(towards, towards);
  square = square > least ? square : least;
  if (!conic_normalize(towards) || !(square > 0.0))
    return 0.0;
  if (point->lamp->kind == CONIC_LAMP_SPHERE && point->is_middle)
    return 1.0 / square;
  cosine = -conic_dot(point->normal, towards);
  /* On a sphere, the mean of the cosines, with negative ones as 0, is a quarter. */
  return cosine > 0.0 ? cosine * (point->lamp->kind == CONIC_LAMP_SPHERE ? 4.0 : 1.0) / square : 0.0;
}
