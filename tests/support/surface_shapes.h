/* Samples of shapes whose surface is known, with their exact normals. */
#pragma once

#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

typedef enum shape { SHAPE_SPHERE, SHAPE_TORUS, SHAPE_GYROID } shape; /* the last: one cell and what is around it */

static const double torus_radius = 0.4; /* about a circle of radius 1 around y */

static const double gyroid_cell = 6.283185307179586, gyroid_area = 122.0, gyroid_rim = 1.0;

/* By Newton's steps to the surface sin x cos y + sin y cos z + sin z cos x = 0, along its gradient at the place. */
static inline double gyroid_distance(const double p[3], double normal[3]) {
  double along = 0.0, q[3] = {p[0], p[1], p[2]};
  normal[0] = normal[1] = normal[2] = 0.0;
  for (int step = 0; step < 8; step++) {
    double value = 0.0, gradient[3], length2 = 0.0, slope = 0.0;
    for (int i = 0; i < 3; i++) {
      double a = q[i], b = q[(i + 1) % 3], c = q[(i + 2) % 3];
      value += sin(a) * cos(b);
      gradient[i] = cos(a) * cos(b) - sin(c) * sin(a);
      length2 += gradient[i] * gradient[i];
    }
    for (int i = 0; i < 3; i++) {
      normal[i] = step == 0 ? gradient[i] / sqrt(length2) : normal[i];
      slope += gradient[i] * normal[i];
    }
    along -= value / slope;
    for (int i = 0; i < 3; i++)
      q[i] = p[i] + along * normal[i];
  }
  return -along;
}

/* The signed distance of a place from the shape, and the unit normal there. */
static inline double shape_distance(shape s, const double p[3], double normal[3]) {
  if (s == SHAPE_GYROID)
    return gyroid_distance(p, normal);
  double ring = sqrt(p[0] * p[0] + p[2] * p[2]);
  const double middle[3] = {s == SHAPE_TORUS ? p[0] / ring : 0.0, 0.0, s == SHAPE_TORUS ? p[2] / ring : 0.0};
  double length2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    normal[axis] = p[axis] - middle[axis];
    length2 += normal[axis] * normal[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    normal[axis] /= sqrt(length2);
  return sqrt(length2) - (s == SHAPE_TORUS ? torus_radius : 1.0);
}

static inline double shape_spacing(shape s, size_t n) {
  double around = gyroid_cell + 2.0 * gyroid_rim,
         cells = around * around * around / (6.283185307 * 6.283185307 * 6.283185307);
  double area = s == SHAPE_GYROID  ? gyroid_area * cells
                : s == SHAPE_TORUS ? 4.0 * 9.8696044010893586 * torus_radius
                                   : 12.566370614359172;
  return sqrt(area / (double)n);
}

/* About a standard normal deviate. */
static inline double shape_deviate(uint64_t *state) {
  double sum = -6.0;
  for (int i = 0; i < 12; i++)
    sum += random_unit(state);
  return sum;
}

static inline conic_splats shape_allocate(conic_context *context, size_t n, unsigned fields) {
  conic_splats splats;
  if (conic_splats_allocate(context, n, fields, &splats) != CONIC_OK)
    exit(1);
  return splats;
}

/* A place near the shape for each of n samples: of the sphere and the torus irregular but everywhere alike, of the
 * gyroid by chance. */
static inline conic_splats shape_places(conic_context *context, shape s, size_t n, uint64_t seed) {
  conic_scene_options options;
  conic_scene *scene;
  conic_splats places = shape_allocate(context, n, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS);
  if (s == SHAPE_GYROID) {
    for (size_t i = 0; i < n;) {
      double p[3], normal[3];
      for (int axis = 0; axis < 3; axis++) {
        p[axis] = (gyroid_cell + 2.0 * gyroid_rim) * random_unit(&seed) - gyroid_rim;
        places.position[axis][i] = (float)p[axis];
        places.color[axis][i] = 1.0f;
      }
      i += fabs(gyroid_distance(p, normal)) < 0.2;
    }
    return places;
  }
  conic_scene_options_init(&options);
  options.type = s == SHAPE_TORUS ? CONIC_SCENE_TORUS : CONIC_SCENE_SPHERE;
  options.count = n;
  options.jitter = 0.5;
  options.seed = seed;
  CHECK_OK(conic_scene_create(context, &options, &scene));
  CHECK_OK(conic_scene_sample(scene, 0, n, &places));
  conic_scene_destroy(scene);
  return places;
}

/* `n` samples on the shape with its normals there, then moved by Gaussian noise of so many spacings along each axis. */
static inline conic_splats shape_sample(conic_context *context, shape s, size_t n, double noise, uint64_t seed) {
  conic_splats places = shape_places(context, s, n, seed);
  conic_splats samples = shape_allocate(context, n, CONIC_SPLATS_NORMALS | CONIC_SPLATS_COLORS);
  for (size_t i = 0; i < n; i++) {
    double p[3], normal[3];
    for (int axis = 0; axis < 3; axis++)
      p[axis] = (double)places.position[axis][i];
    double distance = shape_distance(s, p, normal);
    for (int axis = 0; axis < 3; axis++)
      p[axis] -= distance * normal[axis];
    shape_distance(s, p, normal);
    for (int axis = 0; axis < 3; axis++) {
      double moved = noise > 0.0 ? noise * shape_spacing(s, n) * shape_deviate(&seed) : 0.0;
      samples.position[axis][i] = (float)(p[axis] + moved);
      samples.normal[axis][i] = (float)normal[axis];
      samples.color[axis][i] = places.color[axis][i];
    }
  }
  conic_splats_release(context, &places);
  return samples;
}

static inline conic_surface *shape_surface(conic_context *context, const conic_splats *samples,
                                           const conic_surface_options *options) {
  conic_surface *surface;
  if (conic_surface_create(context, samples, options, &surface) != CONIC_OK)
    exit(1);
  return surface;
}

/* Every `step`-th of the samples, projected; returns how many. The caller frees *points. */
static inline size_t shape_project(conic_surface *surface, const conic_splats *samples, size_t step,
                                   conic_surface_point **points) {
  size_t n = (samples->count + step - 1) / step;
  double(*positions)[3] = malloc(n * sizeof *positions);
  *points = malloc(n * sizeof **points);
  if (!positions || !*points)
    exit(1);
  for (size_t i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++)
      positions[i][axis] = samples->origin[axis] + (double)samples->position[axis][i * step];
  CHECK_OK(conic_surface_project(surface, n, (const double(*)[3])positions, *points));
  free(positions);
  return n;
}
