#include "lod/layers/draw/layers_view.h"

#include <math.h>
#include <string.h>

#include "core/base/vectors.h"

/* Bounds are computed in double and kept apart by this share, which is more than all that drawing, in floats, rounds.
 */
static const double slack = 1e-4;

/* Planes nearer to the eye than this share of the distance count as edge-on: nearer still, floats know little of how
 * steep they are. */
static const double least_slope = 2e-3;

/* The plane through the eye and a side of the picture: points with a·x + b·z ≥ 0 are inside. */
static void set_layers_side(double side[3], int axis, double a, double b) {
  double length = sqrt(a * a + b * b);
  side[0] = side[1] = 0.0;
  side[axis] = a / length;
  side[2] = b / length;
}

static void set_frame(const conic_layers_header *header, const conic_camera *camera, conic_layers_view *view) {
  const double *origin = header->origin;
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    view->translation[row] = ((m[0] * origin[0] + m[1] * origin[1]) + m[2] * origin[2]) + m[3];
    memcpy(view->rotation[row], m, sizeof view->rotation[row]);
  }
  for (int axis = 0; axis < 3; axis++)
    view->eye[axis] =
        -((view->rotation[0][axis] * view->translation[0] + view->rotation[1][axis] * view->translation[1]) +
          view->rotation[2][axis] * view->translation[2]);
}

void conic_layers_view_init(const conic_layers_header *header, const conic_camera *camera,
                            const conic_render_options *render, double near_z, conic_layers_view *view) {
  memset(view, 0, sizeof *view);
  set_frame(header, camera, view);
  view->width = camera->width;
  view->height = camera->height;
  view->fx = camera->fx;
  view->fy = camera->fy;
  view->cx = camera->cx;
  view->cy = camera->cy;
  view->least_focal = camera->fx < camera->fy ? camera->fx : camera->fy;
  view->greatest_focal = camera->fx < camera->fy ? camera->fy : camera->fx;
  double widening = (double)render->kernel.cutoff * sqrt((double)render->prefilter);
  double margin = view->growth_px = widening + 1.0;
  set_layers_side(view->side[0], 0, camera->fx, camera->cx + margin);
  set_layers_side(view->side[1], 0, -camera->fx, (double)camera->width + margin - camera->cx);
  set_layers_side(view->side[2], 1, camera->fy, camera->cy + margin);
  set_layers_side(view->side[3], 1, -camera->fy, (double)camera->height + margin - camera->cy);
  view->near_z = near_z;
  view->cull_back = render->cull_back;
  view->is_exact_outline =
      render->method == CONIC_METHOD_CONIC || render->method == CONIC_METHOD_RAY || render->method == CONIC_METHOD_AUTO;
  /* Within the outline that is widened by the prefilter, a plane is no farther from its disc than that, on the screen.
   * Laplace's splats are bounded by the box of the outline only: by its diagonal, that is. Points and discs have no
   * plane but the one across the line of sight. */
  view->grows_with_size = render->method == CONIC_METHOD_AUTO;
  view->beyond_px = view->grows_with_size ? 1.5 * widening : widening;
  view->is_flat = render->method == CONIC_METHOD_POINT || render->method == CONIC_METHOD_DISC;
}

static void move_center(const conic_layers_view *view, const conic_layers_entry *entry, double p[3]) {
  for (int row = 0; row < 3; row++) {
    const double *m = view->rotation[row];
    p[row] = ((m[0] * (double)entry->center[0] + m[1] * (double)entry->center[1]) + m[2] * (double)entry->center[2]) +
             view->translation[row];
  }
}

/* The sphere's radius, and more for what the renderer rounds. */
static double padded_radius(const conic_layers_entry *entry, const double p[3]) {
  return (double)entry->sphere * (1.0 + slack) + 1e-6 * conic_length(p);
}

/* Where the sphere, all of it before the eye, ends on the screen along an axis: the tangents from the eye to the circle
 * that its shadow on the plane of that axis and z is. */
static void project_sphere(double p, double z, double radius, double focal, double center, double *low, double *high) {
  double along = sqrt(p * p + z * z - radius * radius);
  *low = center + focal * (p * along - z * radius) / (z * along + p * radius);
  *high = center + focal * (p * along + z * radius) / (z * along - p * radius);
}

static void clamp_range(double low, double high, int size, int *begin, int *end) {
  *begin = low > 0.0 ? low < (double)size ? (int)low : size : 0;
  *end = high < (double)size ? high > 0.0 ? (int)high + 1 : 0 : size;
}

/* A displacement by e of what is at X moves its projection by no more than f·e·|X|/z². */
static double most_px(const conic_layers_view *view, double e, double farthest, double front) {
  return view->greatest_focal * e * farthest / (front * front);
}

static int set_pixels(const conic_layers_view *view, const conic_layers_entry *entry, const double p[3], double radius,
                      conic_layers_sight *sight) {
  double low[2], high[2], margin = view->growth_px, front = p[2] - radius;
  project_sphere(p[0], p[2], radius, view->fx, view->cx, &low[0], &high[0]);
  project_sphere(p[1], p[2], radius, view->fy, view->cy, &low[1], &high[1]);
  if (!view->is_exact_outline)
    margin += most_px(view, (double)entry->sphere, conic_length(p) + radius, front);
  clamp_range(low[0] - margin, high[0] + margin, view->width, &sight->pixels.x_begin, &sight->pixels.x_end);
  clamp_range(low[1] - margin, high[1] + margin, view->height, &sight->pixels.y_begin, &sight->pixels.y_end);
  return sight->pixels.x_begin < sight->pixels.x_end && sight->pixels.y_begin < sight->pixels.y_end;
}

static int is_outside(const conic_layers_view *view, const double p[3], double radius) {
  for (int i = 0; i < 4; i++)
    if ((view->side[i][0] * p[0] + view->side[i][1] * p[1]) + view->side[i][2] * p[2] < -radius)
      return 1;
  return !(p[2] + radius > view->near_z);
}

/* The cosine and the sine of the angle between the cone's axis and the ray to the sphere's centre, and those of the sum
 * of the cone's half opening and the angle under which the sphere's radius is seen, with slack. 0 where that sum is a
 * right angle or more. */
static int cone_angles(const conic_layers_view *view, const conic_layers_entry *entry, double cosine[2],
                       double sine[2]) {
  double to[3], along = 0.0;
  for (int axis = 0; axis < 3; axis++)
    to[axis] = (double)entry->center[axis] - view->eye[axis];
  double distance = conic_length(to), sin_a = (double)entry->sphere / distance * (1.0 + slack) + slack;
  double cos_c = (double)entry->cone - slack;
  if (!(sin_a < 1.0) || !(cos_c > 0.0))
    return 0;
  double cos_a = sqrt(1.0 - sin_a * sin_a), sin_c = sqrt(1.0 - cos_c * cos_c);
  for (int axis = 0; axis < 3; axis++)
    along += to[axis] * (double)entry->axis[axis];
  cosine[0] = along / distance;
  cosine[0] = cosine[0] < 1.0 ? cosine[0] > -1.0 ? cosine[0] : -1.0 : 1.0;
  sine[0] = sqrt(1.0 - cosine[0] * cosine[0]);
  cosine[1] = cos_a * cos_c - sin_a * sin_c;
  sine[1] = sin_a * cos_c + cos_a * sin_c;
  return cosine[1] > 0.0;
}

/* All of the place's splats face away. */
static int is_turned_away(const conic_layers_view *view, const conic_layers_entry *entry) {
  double cosine[2], sine[2];
  return cone_angles(view, entry, cosine, sine) && cosine[0] > 0.0 && cosine[0] > sine[1];
}

int conic_layers_look(const conic_layers_view *view, const conic_layers_entry *entry, conic_layers_sight *sight) {
  double p[3];
  move_center(view, entry, p);
  double radius = padded_radius(entry, p), front = p[2] - radius, distance = conic_length(p);
  memset(sight, 0, sizeof *sight);
  if (is_outside(view, p, radius) || (view->cull_back && is_turned_away(view, entry)))
    return 0;
  sight->distance = distance > radius ? distance - radius : 0.0;
  if (!(front > view->near_z)) {
    sight->error_px = entry->error > 0.0f ? HUGE_VAL : 0.0;
    sight->near_iz = HUGE_VAL;
    sight->pixels.x_end = view->width;
    sight->pixels.y_end = view->height;
    return 1;
  }
  sight->error_px = most_px(view, (double)entry->error, distance + radius, front);
  sight->near_iz = (1.0 + slack) / front;
  return set_pixels(view, entry, p, radius, sight);
}

static void narrow_range(double middle, double reach, int *begin, int *end) {
  double low = middle - reach, high = middle + reach;
  *begin = low > (double)*begin ? low < (double)*end ? (int)low : *end : *begin;
  *end = high < (double)*end ? high > (double)*begin ? (int)high + 1 : *begin : *end;
}

int conic_layers_narrow(const conic_layers_view *view, const float position[3], double radius, conic_window *pixels) {
  double p[3];
  for (int row = 0; row < 3; row++) {
    const double *m = view->rotation[row];
    p[row] = ((m[0] * (double)position[0] + m[1] * (double)position[1]) + m[2] * (double)position[2]) +
             view->translation[row];
  }
  double distance = conic_length(p), front = p[2] - radius * (1.0 + slack) - 1e-6 * distance;
  if (!(front > view->near_z))
    return 1;
  double reach = most_px(view, radius * (1.0 + slack), distance + radius, front) + view->growth_px;
  narrow_range(view->cx + view->fx * p[0] / p[2], reach, &pixels->x_begin, &pixels->x_end);
  narrow_range(view->cy + view->fy * p[1] / p[2], reach, &pixels->y_begin, &pixels->y_end);
  return pixels->x_begin < pixels->x_end && pixels->y_begin < pixels->y_end;
}

double conic_layers_least_offset(const conic_layers_view *view, const conic_layers_entry *entry) {
  double cosine[2], sine[2], to[3];
  for (int axis = 0; axis < 3; axis++)
    to[axis] = (double)entry->center[axis] - view->eye[axis];
  double nearest = conic_length(to) - (double)entry->sphere * (1.0 + slack);
  if (!(nearest > 0.0) || !cone_angles(view, entry, cosine, sine))
    return 0.0;
  /* The normals are within both angles together of the axis, turned to the viewer or from it. */
  double least = fabs(cosine[0]) * cosine[1] - sine[0] * sine[1];
  return least > 0.0 ? nearest * least : 0.0;
}

double conic_layers_hidden_offset(const conic_layers_view *view, const conic_layers_entry *entry,
                                  const conic_layers_sight *sight, double hiding) {
  double gap = hiding * (1.0 - slack) - sight->near_iz, farthest = sight->distance + 2.0 * (double)entry->sphere;
  if (!(gap > 0.0))
    return HUGE_VAL;
  if (view->is_flat)
    return 0.0;
  double beyond = view->beyond_px;
  if (view->grows_with_size)
    beyond += 1.5 * most_px(view, (double)entry->radius, farthest, 1.0 / sight->near_iz);
  /* The gradient of a plane's inverse depth on the screen is at most 1 / (f·|n·p|). */
  double offset = (1.0 + 100.0 * slack) * beyond / (view->least_focal * gap);
  double least = least_slope * farthest * (1.0 + slack);
  return offset > least ? offset : least;
}
