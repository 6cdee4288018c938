#include "lod/layers/draw/layers_view.h"

#include "raster/view/method.h"

/* Bounds are computed in double and kept apart by this share, which is more than all that drawing, in floats, rounds.
 */
static const double slack = 1e-4;

/* Planes nearer to the eye than this share of the distance count as edge-on: nearer still, floats know little of how
 * steep they are. */
static const double least_slope = 2e-3;

void conic_layers_view_init(const conic_layers_header *header, const conic_camera *camera,
                            const conic_render_options *render, double near_z, conic_layers_view *view) {
  memset(view, 0, sizeof *view);
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
  conic_viewpoint_init(&view->from, camera, header->origin, margin);
  view->near_z = near_z;
  view->cull_back = render->cull_back;
  view->is_exact_outline = conic_method_has_exact_outline(render->method);
  /* Within the outline, widened by the prefilter, a plane is on the screen no farther from its disc than that.
   * Laplace's splats are bounded by the box of the outline only, so by its diagonal. Points and discs have no plane but
   * the one across the line of sight. */
  view->grows_with_size = render->method == CONIC_METHOD_AUTO;
  view->beyond_px = view->grows_with_size ? 1.5 * widening : widening;
  view->is_flat = conic_method_is_dot(render->method);
}

/* The sphere's radius, and more for what the renderer rounds. */
static double padded_radius(const conic_layers_entry *entry, const double p[3]) {
  return (double)entry->sphere * (1.0 + slack) + 1e-6 * conic_length(p);
}

/* Where the sphere ends on the screen along an axis; all of it is before the eye. On the plane of that axis and z its
 * shadow is a circle, and these are the tangents from the eye to that. */
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

/* The cosine and the sine of two angles, with slack: the one between the cone's axis and the ray to the sphere's
 * centre; and the sum of the cone's half opening and the angle under which the sphere's radius is seen. 0 where that
 * sum is a right angle or more. */
static int cone_angles(const conic_layers_view *view, const conic_layers_entry *entry, double cosine[2],
                       double sine[2]) {
  double to[3], along = 0.0;
  for (int axis = 0; axis < 3; axis++)
    to[axis] = (double)entry->center[axis] - view->from.eye[axis];
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

/* |X|/z of what is seen within the window, at most: a displacement by e there moves its projection by no more than
 * f·e·|X|/z². */
static double longest_ray(const conic_layers_view *view, const conic_window *window) {
  double left = view->cx - (double)window->x_begin, right = (double)window->x_end - view->cx;
  double above = view->cy - (double)window->y_begin, below = (double)window->y_end - view->cy;
  double x = (left > right ? left : right) / view->fx, y = (above > below ? above : below) / view->fy;
  return sqrt(1.0 + x * x + y * y);
}

int conic_layers_look(const conic_layers_view *view, const conic_layers_entry *entry, conic_layers_sight *sight) {
  double p[3];
  conic_viewpoint_move_floats(&view->from, entry->center, p);
  double radius = padded_radius(entry, p), front = p[2] - radius, distance = conic_length(p);
  memset(sight, 0, sizeof *sight);
  if (conic_viewpoint_misses(&view->from, p, radius) || !(p[2] + radius > view->near_z) ||
      (view->cull_back && is_turned_away(view, entry)))
    return 0;
  sight->distance = distance > radius ? distance - radius : 0.0;
  if (!(front > view->near_z)) {
    sight->error_px = entry->error > 0.0f ? HUGE_VAL : 0.0;
    sight->near_iz = HUGE_VAL;
    sight->pixels.x_end = view->width;
    sight->pixels.y_end = view->height;
    return 1;
  }
  sight->near_iz = (1.0 + slack) / front;
  int is_in_sight = set_pixels(view, entry, p, radius, sight);
  sight->error_px = view->greatest_focal * (double)entry->error * longest_ray(view, &sight->pixels) / front;
  return is_in_sight;
}

static void narrow_range(double middle, double reach, int *begin, int *end) {
  double low = middle - reach, high = middle + reach;
  *begin = low > (double)*begin ? low < (double)*end ? (int)low : *end : *begin;
  *end = high < (double)*end ? high > (double)*begin ? (int)high + 1 : *begin : *end;
}

int conic_layers_narrow(const conic_layers_view *view, const float position[3], double radius, conic_window *pixels) {
  double p[3];
  conic_viewpoint_move_floats(&view->from, position, p);
  double distance = conic_length(p), front = p[2] - radius * (1.0 + slack) - 1e-6 * distance;
  if (!(front > view->near_z))
    return 1;
  double reach = most_px(view, radius * (1.0 + slack), distance + radius, front) + view->growth_px;
  narrow_range(view->cx + view->fx * p[0] / p[2], reach, &pixels->x_begin, &pixels->x_end);
  narrow_range(view->cy + view->fy * p[1] / p[2], reach, &pixels->y_begin, &pixels->y_end);
  return pixels->x_begin < pixels->x_end && pixels->y_begin < pixels->y_end;
}

double conic_layers_reach(const conic_layers_view *view, const conic_layers_entry *entry,
                          const conic_layers_sight *sight) {
  double radius = (double)entry->radius * (1.0 + 2.0 * slack);
  double farthest = (sight->distance + 2.0 * ((double)entry->sphere + radius)) * 1.001;
  double front = 1.0 / sight->near_iz - radius - 2e-6 * farthest;
  if (!(front > view->near_z))
    return HUGE_VAL;
  return most_px(view, radius, farthest + radius, front) + view->growth_px;
}

double conic_layers_least_offset(const conic_layers_view *view, const conic_layers_entry *entry) {
  double cosine[2], sine[2], to[3];
  for (int axis = 0; axis < 3; axis++)
    to[axis] = (double)entry->center[axis] - view->from.eye[axis];
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

/* --- which way samples face --- */

enum { CODES = 256, CODES_A_SET = CODES / CONIC_LAYERS_FACING_SIDE };

/* All of this is computed in floats and kept apart by more than they round. */
static const float facing_slack = 1e-3f;

/* The codes of a set are a square. */
static void find_cone(conic_layers_facings *facings, int i_set) {
  int x = i_set / CONIC_LAYERS_FACING_SIDE * CODES_A_SET, y = i_set % CONIC_LAYERS_FACING_SIDE * CODES_A_SET;
  float sum[3] = {0.0f, 0.0f, 0.0f}, least = 1.0f;
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < CODES_A_SET * CODES_A_SET; i++) {
      const uint8_t code[2] = {(uint8_t)(x + i / CODES_A_SET), (uint8_t)(y + i % CODES_A_SET)};
      float normal[3];
      conic_layers_normal_of(code, normal);
      float cosine = normal[0] * sum[0] + normal[1] * sum[1] + normal[2] * sum[2];
      least = pass && cosine < least ? cosine : least;
      for (int axis = 0; axis < 3 && !pass; axis++)
        sum[axis] += normal[axis];
    }
    float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (int axis = 0; axis < 3 && !pass; axis++)
      facings->axis[axis][i_set] = sum[axis] /= length;
  }
  facings->cosine[i_set] = least;
  facings->sine[i_set] = sqrtf(1.0f - least * least);
}

void conic_layers_facings_init(conic_layers_facings *facings) {
  for (int i = 0; i < CONIC_LAYERS_FACINGS; i++)
    find_cone(facings, i);
}

void conic_layers_find_turned(const conic_layers_facings *facings, const conic_layers_view *view,
                              const conic_layers_entry *entry, conic_layers_turned *turned) {
  float to[3], distance = 0.0f;
  memset(turned, 0, sizeof *turned);
  for (int axis = 0; axis < 3; axis++) {
    to[axis] = (float)((double)entry->center[axis] - view->from.eye[axis]);
    distance += to[axis] * to[axis];
  }
  distance = sqrtf(distance);
  float sine = entry->sphere / distance + facing_slack; /* of the angle under which the sphere's radius is seen */
  if (!(sine < 1.0f))
    return;
  float cosine = sqrtf(1.0f - sine * sine);
  for (int i = 0; i < CONIC_LAYERS_FACINGS; i++) {
    float along = (facings->axis[0][i] * to[0] + facings->axis[1][i] * to[1] + facings->axis[2][i] * to[2]) / distance;
    int is_away = facings->cosine[i] * cosine > facings->sine[i] * sine + facing_slack &&
                  along > facings->sine[i] * cosine + facings->cosine[i] * sine + facing_slack;
    turned->bits[i / 32] |= (uint32_t)is_away << i % 32;
    turned->is_any |= is_away;
  }
}
