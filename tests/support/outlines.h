/* Sets of points for the estimate's tests, and what the outlines that it finds cover. */
#pragma once

#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

/* A model that grows point by point; no array but the positions. */
static inline conic_model outlines_model(conic_context *context, size_t room, unsigned fields) {
  conic_model model;
  memset(&model, 0, sizeof model);
  if (conic_splats_allocate(context, room, fields, &model.points) != CONIC_OK)
    exit(1);
  model.points.count = 0;
  return model;
}

static inline size_t outlines_add(conic_model *model, double x, double y, double z) {
  size_t i = model->points.count++;
  model->points.position[0][i] = (float)x;
  model->points.position[1][i] = (float)y;
  model->points.position[2][i] = (float)z;
  return i;
}

static inline conic_repairs outlines_estimate(conic_context *context, conic_model *model) {
  conic_estimate_options options;
  conic_repairs repairs;
  memset(&repairs, 0xFF, sizeof repairs);
  conic_estimate_options_init(&options);
  CHECK_OK(conic_model_to_splats(context, &options, model, &repairs));
  return repairs;
}

/* Half axes of the outline at the cutoff of 1.5, and the unit normal. */
typedef struct outlines_splat {
  double center[3], u[3], v[3], a, b, normal[3];
} outlines_splat;

static inline outlines_splat outlines_get(const conic_splats *splats, size_t i) {
  outlines_splat s;
  double uu = 0.0, vv = 0.0, nn = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    s.center[axis] = (double)splats->position[axis][i];
    s.u[axis] = (double)splats->tangent_u[axis][i];
    s.v[axis] = (double)splats->tangent_v[axis][i];
    uu += s.u[axis] * s.u[axis];
    vv += s.v[axis] * s.v[axis];
  }
  s.a = 1.5 * sqrt(uu);
  s.b = 1.5 * sqrt(vv);
  for (int axis = 0; axis < 3; axis++) {
    s.normal[axis] = s.u[(axis + 1) % 3] * s.v[(axis + 2) % 3] - s.u[(axis + 2) % 3] * s.v[(axis + 1) % 3];
    nn += s.normal[axis] * s.normal[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    s.normal[axis] /= sqrt(nn);
  return s;
}

/* Whether the line through p along `view` meets the splat inside its outline, at a height of at most `reach`. */
static inline int outlines_cover(const outlines_splat *s, const double p[3], const double view[3], double reach) {
  double height = 0.0, cosine = 0.0, u = 0.0, v = 0.0, uu = s->a * s->a / 2.25, vv = s->b * s->b / 2.25;
  for (int axis = 0; axis < 3; axis++) {
    height += (s->center[axis] - p[axis]) * s->normal[axis];
    cosine += view[axis] * s->normal[axis];
  }
  double way = height / cosine;
  if (!(fabs(way) <= reach))
    return 0;
  for (int axis = 0; axis < 3; axis++) {
    double d = p[axis] + way * view[axis] - s->center[axis];
    u += d * s->u[axis] / uu;
    v += d * s->v[axis] / vv;
  }
  return u * u + v * v <= 2.25;
}

/* How many of the splats [begin, end) cover p as seen along `view`. */
static inline int outlines_count(const conic_splats *splats, size_t begin, size_t end, const double p[3],
                                 const double view[3], double reach) {
  int n = 0;
  for (size_t i = begin; i < end; i++) {
    outlines_splat s = outlines_get(splats, i);
    n += outlines_cover(&s, p, view, reach);
  }
  return n;
}
