/* The suite's scenes of surface splats. */
#include "cli/judge/suite_scenes.h"

#include "core/base/color.h"

enum { SURFEL_FIELDS = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS };

/* Colours are those of 8-bit codes, as in most files of splats. */
static void put_surfel(conic_splats *splats, size_t i, const double center[3], const double u[3], const double v[3]) {
  for (int axis = 0; axis < 3; axis++) {
    splats->position[axis][i] = (float)center[axis];
    splats->tangent_u[axis][i] = (float)u[axis];
    splats->tangent_v[axis][i] = (float)v[axis];
    size_t code = 90 + 70 * ((i + (size_t)axis) % 3) + 5 * (i % 5);
    splats->color[axis][i] = (float)conic_srgb_decode((double)code / 255.0);
  }
}

/* A sheet of 7 × 5 splats from `from` on, in steps of `along` and `down`; splats overlap their neighbours. */
static void put_surfel_sheet(conic_splats *splats, size_t first, const double from[3], const double along[3],
                             const double down[3]) {
  for (size_t i = 0; i < 35; i++) {
    double center[3], u[3], v[3];
    const size_t row = i / 7;
    for (int axis = 0; axis < 3; axis++) {
      center[axis] = from[axis] + along[axis] * (double)(i % 7) + down[axis] * (double)row;
      u[axis] = 0.7 * along[axis];
      v[axis] = 0.7 * down[axis];
    }
    put_surfel(splats, first + i, center, u, v);
  }
}

conic_status cli_suite_make_splat(conic_context *context, conic_splats *splats) {
  static const double center[3] = {0.1, -0.05, 0.0}, u[3] = {0.7, 0.1, 0.35}, v[3] = {-0.1, 0.45, 0.1};
  conic_status status = conic_splats_allocate(context, 1, SURFEL_FIELDS, splats);
  if (status == CONIC_OK)
    put_surfel(splats, 0, center, u, v);
  return status;
}

conic_status cli_suite_make_sheet(conic_context *context, conic_splats *splats) {
  static const double from[3] = {-1.5, -0.9, -0.3}, along[3] = {0.5, 0.03, 0.1}, down[3] = {0.02, 0.42, 0.05};
  conic_status status = conic_splats_allocate(context, 35, SURFEL_FIELDS, splats);
  if (status == CONIC_OK)
    put_surfel_sheet(splats, 0, from, along, down);
  return status;
}

/* Two sheets, one before the other: by more than a splat's depth tolerance, and by less where they meet. */
conic_status cli_suite_make_corner(conic_context *context, conic_splats *splats) {
  static const double from[3] = {-1.6, -0.9, -0.8}, along[3] = {0.4, 0.02, 0.3}, down[3] = {0.0, 0.45, 0.03};
  static const double other_from[3] = {-0.9, -0.8, 1.1}, other_along[3] = {0.42, 0.0, -0.3},
                      other_down[3] = {0.03, 0.4, 0.0};
  conic_status status = conic_splats_allocate(context, 70, SURFEL_FIELDS, splats);
  if (status == CONIC_OK) {
    put_surfel_sheet(splats, 0, from, along, down);
    put_surfel_sheet(splats, 35, other_from, other_along, other_down);
  }
  return status;
}

/* A floor seen from a low and near place, where perspective is strong within a splat. */
conic_status cli_suite_make_steep(conic_context *context, conic_splats *splats) {
  static const double from[3] = {-1.2, 0.35, -3.2}, along[3] = {0.4, 0.0, 0.0}, down[3] = {0.0, 0.01, 0.8};
  conic_status status = conic_splats_allocate(context, 35, SURFEL_FIELDS, splats);
  if (status == CONIC_OK)
    put_surfel_sheet(splats, 0, from, along, down);
  return status;
}
