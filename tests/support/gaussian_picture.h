/* Pictures of Gaussians for tests, and how they compare with the oracle's. */
#pragma once

#include "conic/gaussian_oracle.h"
#include "conic/gaussian_render.h"
#include "tests/support/gaussian_fixture.h"

static inline conic_gaussian_planes picture_planes(const conic_camera *camera) {
  const size_t n = (size_t)camera->width * (size_t)camera->height;
  return (conic_gaussian_planes){.width = camera->width,
                                 .height = camera->height,
                                 .rgb = calloc(n, 3 * sizeof(float)),
                                 .transparency = calloc(n, sizeof(float)),
                                 .z = calloc(n, sizeof(float)),
                                 .median_z = calloc(n, sizeof(float)),
                                 .inverse_z = calloc(n, sizeof(float)),
                                 .normal = calloc(n, 3 * sizeof(float)),
                                 .count = calloc(n, sizeof(uint32_t)),
                                 .id = calloc(n, sizeof(uint32_t)),
                                 .last = calloc(n, sizeof(uint32_t))};
}

static inline void picture_release(conic_gaussian_planes *p) {
  void *const all[] = {p->rgb, p->transparency, p->z, p->median_z, p->inverse_z, p->normal, p->count, p->id, p->last};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    free(all[i]);
}

/* A picture with all planes; ends the program where there is none. */
static inline conic_gaussian_planes picture_draw(conic_context *context, const conic_gaussians *scene,
                                                 const conic_camera *camera, conic_gaussian_profile profile,
                                                 conic_isa isa) {
  conic_gaussian_planes planes = picture_planes(camera);
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.profile = profile;
  options.isa = isa;
  if (conic_gaussians_render(context, scene, camera, &options, &planes, NULL) != CONIC_OK)
    exit(1);
  return planes;
}

static inline int picture_is_same(const conic_gaussian_planes *a, const conic_gaussian_planes *b) {
  const size_t n = (size_t)a->width * (size_t)a->height;
  return memcmp(a->rgb, b->rgb, n * 3 * sizeof(float)) == 0 &&
         memcmp(a->transparency, b->transparency, n * sizeof(float)) == 0 &&
         memcmp(a->z, b->z, n * sizeof(float)) == 0 && memcmp(a->median_z, b->median_z, n * sizeof(float)) == 0 &&
         memcmp(a->inverse_z, b->inverse_z, n * sizeof(float)) == 0 &&
         memcmp(a->normal, b->normal, n * 3 * sizeof(float)) == 0 &&
         memcmp(a->count, b->count, n * sizeof(uint32_t)) == 0 && memcmp(a->id, b->id, n * sizeof(uint32_t)) == 0 &&
         memcmp(a->last, b->last, n * sizeof(uint32_t)) == 0;
}

static inline double picture_difference(const float *a, const double *b, size_t n) {
  double greatest = 0.0;
  for (size_t i = 0; i < n; i++) {
    double apart = fabs((double)a[i] - b[i]);
    greatest = apart <= greatest ? greatest : apart; /* a NaN is one, too */
  }
  return greatest;
}

static inline conic_gaussian_reference picture_reference(conic_context *context, const conic_gaussians *scene,
                                                         const conic_camera *camera, conic_gaussian_profile profile,
                                                         conic_gaussian_question question) {
  conic_gaussian_reference reference;
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.profile = profile;
  if (conic_gaussian_oracle_render(context, scene, camera, &options, question, &reference) != CONIC_OK)
    exit(1);
  return reference;
}
