#include "lod/hybrid_choose.h"

#include <math.h>
#include <string.h>

#include "core/trigonometry.h"

/* What drawing takes, in nanoseconds of one core: a primitive, and a pixel that it covers (docs/hybrid.md). */
static const double triangle_ns = 90.0, triangle_pixel_ns = 2.0;
static const double surfel_ns = 25.0, surfel_pixel_ns = 2.5;

/* The plane through the eye and a side of the picture: points with a·x + b·z ≥ 0 are inside. */
static void set_side(double side[3], int axis, double a, double b) {
  double length = sqrt(a * a + b * b);
  side[0] = side[1] = 0.0;
  side[axis] = a / length;
  side[2] = b / length;
}

void conic_hybrid_camera_init(const conic_hybrid *hybrid, const conic_camera *camera,
                              const conic_render_options *render, conic_hybrid_camera *view) {
  double margin = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 1.0;
  memset(view, 0, sizeof *view);
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    view->translation[row] = conic_hybrid_dot(m, hybrid->origin) + m[3];
    memcpy(view->rotation[row], m, sizeof view->rotation[row]);
  }
  for (int axis = 0; axis < 3; axis++)
    for (int row = 0; row < 3; row++)
      view->eye[axis] -= view->rotation[row][axis] * view->translation[row];
  set_side(view->side[0], 0, camera->fx, camera->cx + margin);
  set_side(view->side[1], 0, -camera->fx, (double)camera->width + margin - camera->cx);
  set_side(view->side[2], 1, camera->fy, camera->cy + margin);
  set_side(view->side[3], 1, -camera->fy, (double)camera->height + margin - camera->cy);
  view->focal_px = camera->fx > camera->fy ? camera->fx : camera->fy;
  view->near_z = render->near_z;
  view->cull_back = render->cull_back;
  view->margin_px2 = (double)render->prefilter * (double)render->kernel.cutoff * (double)render->kernel.cutoff;
}

static void to_camera(const conic_hybrid_camera *view, const float center[3], double at[3]) {
  const double from[3] = {(double)center[0], (double)center[1], (double)center[2]};
  for (int row = 0; row < 3; row++)
    at[row] = conic_hybrid_dot(view->rotation[row], from) + view->translation[row];
}

/* Away is where the angle between the ray and the axis, half the angle under which the sphere is seen, and half the
 * cone's opening are less than a right angle together. */
static int faces_away(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double radius) {
  double ray[3], axis[3];
  for (int k = 0; k < 3; k++) {
    ray[k] = (double)bound->center[k] - view->eye[k];
    axis[k] = (double)bound->axis[k];
  }
  double distance = sqrt(conic_hybrid_dot(ray, ray)), cone = (double)bound->cone;
  if (!(cone > 0.0) || !(radius < distance))
    return 0;
  double sin_a = radius / distance, cos_a = sqrt(1.0 - sin_a * sin_a),
         sin_c = sqrt(cone < 1.0 ? 1.0 - cone * cone : 0.0);
  double cos_both = cos_a * cone - sin_a * sin_c, sin_both = sin_a * cone + cos_a * sin_c;
  return cos_both > 0.0 && conic_hybrid_dot(ray, axis) > distance * (sin_both + 1e-5);
}

int conic_hybrid_is_hidden(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach) {
  double at[3], radius = ((double)bound->radius + reach) * (1.0 + 1e-6);
  to_camera(view, bound->center, at);
  if (at[2] + radius < view->near_z)
    return 1;
  for (int k = 0; k < 4; k++)
    if (conic_hybrid_dot(view->side[k], at) < -radius)
      return 1;
  return view->cull_back && faces_away(view, bound, radius);
}

/* The most pixels that a displacement of one can be, anywhere in the sphere: the greatest factor of the projection's
 * derivative at X is f·|X|/z². Infinite where the sphere reaches the near plane. */
static double pixels_a_unit(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach) {
  double at[3], radius = ((double)bound->radius + reach) * (1.0 + 1e-6);
  to_camera(view, bound->center, at);
  double front = at[2] - radius, distance = sqrt(conic_hybrid_dot(at, at)) + radius;
  return front > view->near_z ? view->focal_px * distance / (front * front) : HUGE_VAL;
}

double conic_hybrid_error_px(const conic_hybrid_camera *view, const conic_hybrid_patch *patch,
                             const conic_hybrid_level *level) {
  return level->error > 0.0f ? (double)level->error * pixels_a_unit(view, &patch->bound, (double)level->reach) : 0.0;
}

static double cost_of(const conic_hybrid_camera *view, const conic_hybrid_patch *patch, const conic_hybrid_level *level,
                      double scale_px) {
  double n = (double)level->count, area_px = (double)patch->area * scale_px * scale_px;
  if (level->kind == CONIC_HYBRID_TRIANGLES)
    return n * triangle_ns + area_px * triangle_pixel_ns;
  /* Their outlines together cover about twice the patch; the prefilter widens each. */
  return n * (surfel_ns + CONIC_PI * view->margin_px2 * surfel_pixel_ns) + 2.0 * area_px * surfel_pixel_ns;
}

/* The finest of that kind, which is the first; or the first of all. */
static uint32_t first_of_kind(const conic_hybrid_level *levels, uint32_t n, int kind) {
  for (uint32_t k = 0; k < n; k++)
    if (levels[k].kind == (uint32_t)kind)
      return k;
  return 0;
}

uint32_t conic_hybrid_choose(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                             const conic_hybrid_patch *patch, double error_px, int only_kind) {
  const conic_hybrid_level *levels = hybrid->levels + patch->first_level;
  uint32_t best = only_kind < 0 ? patch->built : first_of_kind(levels, patch->n_levels, only_kind);
  double least = HUGE_VAL;
  if (!(error_px > 0.0))
    return best;
  if (only_kind < 0)
    best = 0; /* without an error */
  double mean_scale_px = pixels_a_unit(view, &patch->bound, 0.0);
  if (!(mean_scale_px < HUGE_VAL))
    return best;
  for (uint32_t k = 0; k < patch->n_levels; k++) {
    const conic_hybrid_level *level = &levels[k];
    double cost = cost_of(view, patch, level, mean_scale_px);
    int is_good =
        conic_hybrid_error_px(view, patch, level) <= error_px && (only_kind < 0 || level->kind == (uint32_t)only_kind);
    if (is_good && cost < least) {
      least = cost;
      best = k;
    }
  }
  return best;
}
