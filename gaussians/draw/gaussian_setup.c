/* From a Gaussian to its footprint, in double, since what follows is differences; docs/reference/gaussians.md,
 * Set-up. */
#include <string.h>

#include "core/base/power.h"
#include "core/base/vectors.h"
#include "gaussians/draw/gaussian_outline.h"
#include "gaussians/draw/screen_variance.h"
#include "gaussians/draw/unscented_box.h"
#include "gaussians/draw/view_rays.h"

static int is_number(double v) {
  return v - v == 0.0;
}

/* What it reads of the rotation and the scales. Returns 0 where they are none; else |q|². */
static double read_shape(const conic_gaussians *set, size_t i, double q[4], conic_gaussian_placed *p) {
  double squares = 0.0;
  for (int k = 0; k < 4; k++) {
    q[k] = (double)set->rotation[k][i];
    squares += q[k] * q[k];
  }
  for (int axis = 0; axis < 3; axis++) {
    p->scale[axis] = set->scale[axis] ? (double)set->scale[axis][i] : 0.0;
    if (!(p->scale[axis] >= 0.0) || !is_number(p->scale[axis]))
      return 0.0;
  }
  return squares > 0.0 && is_number(squares) ? squares : 0.0;
}

static void place_axes(const conic_gaussian_view *view, const double q[4], double squares, conic_gaussian_placed *p) {
  const int as_is = view->rules->takes_rotation_as_is;
  int is_as_it_is = as_is > 1 || (as_is && squares - 1.0 < CONIC_UNIT_SLACK && 1.0 - squares < CONIC_UNIT_SLACK);
  double one_over = is_as_it_is ? 1.0 : 1.0 / sqrt(squares);
  const double unit[4] = {q[0] * one_over, q[1] * one_over, q[2] * one_over, q[3] * one_over};
  double rows[3][3];
  conic_rotation_of(unit, rows);
  memcpy(p->world, rows, sizeof rows);
  for (int axis = 0; axis < 3; axis++)
    for (int row = 0; row < 3; row++) {
      const double *camera = view->camera->cam_from_world[row];
      p->unit[axis][row] = camera[0] * rows[0][axis] + camera[1] * rows[1][axis] + camera[2] * rows[2][axis];
    }
}

/* Returns 0 where a number is not finite. */
static int place_in_camera(const conic_gaussian_view *view, const conic_gaussians *set, size_t i,
                           conic_gaussian_placed *p, double from_eye[3]) {
  double mean[3];
  for (int axis = 0; axis < 3; axis++) {
    mean[axis] = set->origin[axis] + (double)set->position[axis][i];
    from_eye[axis] = mean[axis] - view->eye[axis];
  }
  for (int row = 0; row < 3; row++) {
    const double *camera = view->camera->cam_from_world[row];
    p->mean[row] = camera[0] * mean[0] + camera[1] * mean[1] + camera[2] * mean[2] + camera[3];
    if (!is_number(p->mean[row]))
      return 0;
  }
  p->opacity = (double)set->opacity[i];
  p->is_flat = !set->scale[2] || view->rules->shape == CONIC_SHAPE_DISC;
  return is_number(p->opacity);
}

/* The pixel that a place is in, or the nearest one within a picture's width of the picture, and the rest. */
static void take_reference(const conic_gaussian_view *view, double x, double y, conic_gaussian_footprint *f) {
  double width = view->camera->width, height = view->camera->height;
  f->x = (int32_t)conic_limited(x, -width, 2.0 * width);
  f->y = (int32_t)conic_limited(y, -height, 2.0 * height);
  f->dx = (float)((double)f->x + 0.5 - x);
  f->dy = (float)((double)f->y + 0.5 - y);
}

/* Twice the logarithm of how much the opacity is above the least alpha: beyond this q nothing is. 0: nowhere. */
static double reach_of(const conic_profile_row *rules, double opacity) {
  const double least = (double)(float)rules->alpha_least;
  const double most = rules->greatest_half_q > 0.0 ? 2.0 * rules->greatest_half_q : INFINITY;
  if (!(least > 0.0))
    return most;
  double reach = opacity >= least ? 2.0 * conic_logarithm(opacity / least) + CONIC_REACH_SLACK : 0.0;
  return reach < most ? reach : most;
}

/* Half of it, with room for roundings. Where the exponential ends at e⁻⁸⁰, it never falls below what is composited. */
static float half_reach_of(double reach) {
  return reach < 158.0 ? (float)(0.5 * reach) + 1e-4f : INFINITY;
}

/* Whole tiles, as integers that are cut off towards 0. */
static double tile_border(double place, double size, double tile) {
  int n_tiles = ((int)size + (int)tile - 1) / (int)tile;
  double n = place / tile, most = (double)n_tiles;
  return tile * (double)(int)conic_limited(n, 0.0, most);
}

static void cover_square(const conic_gaussian_view *view, const double place[2], double radius, double least[2],
                         double most[2]) {
  const double size[2] = {view->camera->width, view->camera->height};
  for (int axis = 0; axis < 2; axis++) {
    double first = tile_border(place[axis] - 0.5 - radius, size[axis], 16.0);
    double behind = tile_border(place[axis] - 0.5 + radius + 15.0, size[axis], 16.0);
    least[axis] = least[axis] > first ? least[axis] : first;
    most[axis] = most[axis] < behind ? most[axis] : behind;
  }
}

static double round_up(double value) {
  double whole = (double)(int64_t)conic_limited(value, -1e15, 1e15);
  return whole + (whole < value);
}

/* The tiles that a box of half that size meets. Returns 0 where that is none. */
static int cover_box(const conic_gaussian_view *view, const double place[2], const double half[2], double least[2],
                     double most[2]) {
  const double size[2] = {view->camera->width, view->camera->height};
  const double tile = conic_profile_tile(view->rules, view->camera);
  for (int axis = 0; axis < 2; axis++) {
    double radius = round_up(half[axis]);
    if (place[axis] + radius <= 0.0 || place[axis] - radius >= size[axis])
      return 0;
    double first = tile_border(place[axis] - radius, size[axis], tile);
    double behind = tile_border(place[axis] + radius + tile - 1e-9, size[axis], tile);
    least[axis] = least[axis] > first ? least[axis] : first;
    most[axis] = most[axis] < behind ? most[axis] : behind;
  }
  return 1;
}

/* Whether a Gaussian is so far beside the picture that its ellipse cannot come to it, nor its ellipsoid, which is
 * before the eye: taken for a ball of its largest scale, a tenth larger than it is, and opaque. */
static int is_far_beside(const conic_gaussian_view *view, const conic_gaussian_placed *p) {
  const conic_profile_row *rules = view->rules;
  const double focal[2] = {view->camera->fx, view->camera->fy}, z = p->mean[2];
  const double size[2] = {view->camera->width, view->camera->height}, most_reach = 11.2;
  double scale = p->scale[0] > p->scale[1] ? p->scale[0] : p->scale[1];
  scale = 1.1 * (scale > p->scale[2] ? scale : p->scale[2]);
  if (view->rays || view->is_parallel || view->prefilter > 0.0 || rules->shape == CONIC_SHAPE_DISC ||
      !(p->opacity <= 1.0) || !(z > 0.0) || (rules->shape != CONIC_SHAPE_ELLIPSE && !(z > 6.0 * scale)))
    return 0;
  for (int axis = 0; axis < 2; axis++) {
    const double slope = p->mean[axis] / z, place = focal[axis] * slope + view->center_px[axis];
    const double beside = (place < 0.0 ? -place : place - size[axis]) - 1.0, spread = focal[axis] * scale / z;
    /* of a ball before the eye the outline reaches farther outwards, at z = 4·scale and 3.35 scales by less than this
     */
    const double farther = rules->shape != CONIC_SHAPE_ELLIPSE ? 8.0 : 1.0;
    if (beside > 0.0 && beside * beside > farther * most_reach *
                                              (spread * spread * (1.0 + slope * slope) + rules->dilation +
                                               rules->spread_least + rules->axis_least))
      return 1;
  }
  return 0;
}

static conic_gaussian_fate set_up_ellipse(const conic_gaussian_view *view, conic_gaussian_placed *p,
                                          conic_gaussian_footprint *f) {
  const conic_profile_row *rules = view->rules;
  const conic_camera *camera = view->camera;
  const double focal[2] = {camera->fx, camera->fy}, size[2] = {camera->width, camera->height};
  const double h = rules->dilation;
  double rows[2][3], place[2], area[3], least[2], most[2];
  for (int axis = 0; axis < 2; axis++) {
    double slope = p->mean[axis] / p->mean[2], half = 0.5 * size[axis] / focal[axis], c = view->center_px[axis];
    place[axis] = focal[axis] * slope + c;
    if (rules->slope_margin >= 0.0)
      slope = conic_limited(slope, -(c / focal[axis] + rules->slope_margin * half),
                            (size[axis] - c) / focal[axis] + rules->slope_margin * half);
    for (int k = 0; k < 3; k++)
      rows[axis][k] = focal[axis] / p->mean[2] * (p->unit[k][axis] - slope * p->unit[k][2]) * p->scale[k];
  }
  conic_cross(rows[0], rows[1], area);
  double xx = conic_dot(rows[0], rows[0]), xy = conic_dot(rows[0], rows[1]), yy = conic_dot(rows[1], rows[1]);
  double bare = conic_dot(area, area), wide = bare + h * (xx + yy) + h * h;
  conic_screen_variance v = {{xx + h, xy, yy + h}, wide};
  if (!(wide > 0.0) || !is_number(wide) || !is_number(place[0]) || !is_number(place[1]))
    return CONIC_GAUSSIAN_CULLED;
  if (rules->compensation_least >= 0.0)
    p->opacity *= conic_screen_compensation(rules, bare, wide);
  for (int axis = 0; axis < 2; axis++)
    if (rules->clip > 0.0 && fabs(place[axis] - 0.5 * size[axis]) > rules->clip * 0.5 * size[axis])
      return CONIC_GAUSSIAN_CULLED;
  if (conic_profile_limits_axes(rules) && !conic_screen_limit_axes(view, &v))
    return CONIC_GAUSSIAN_CULLED;
  const double variance[2] = {v.c[0], v.c[2]}, reach = reach_of(rules, p->opacity);
  for (int axis = 0; axis < 2; axis++) {
    least[axis] = place[axis] - (sqrt(reach * variance[axis]) + CONIC_GAUSSIAN_SLACK_PX);
    most[axis] = place[axis] + (sqrt(reach * variance[axis]) + CONIC_GAUSSIAN_SLACK_PX);
  }
  if (rules->coverage == CONIC_COVERAGE_TILES) {
    double mean = 0.5 * (v.c[0] + v.c[2]), apart = mean * mean - wide;
    cover_square(view, place, round_up(3.0 * sqrt(mean + sqrt(apart > 0.1 ? apart : 0.1))), least, most);
  }
  take_reference(view, place[0], place[1], f);
  f->half_reach = half_reach_of(reach);
  f->form[0] = (float)(v.c[2] / v.area);
  f->form[1] = (float)(-v.c[1] / v.area);
  f->form[2] = (float)(v.c[0] / v.area);
  return reach > 0.0 && conic_gaussian_limit_box(view, least, most, f) ? CONIC_GAUSSIAN_DRAWN : CONIC_GAUSSIAN_CULLED;
}

/* The rays of pixels: origin and direction at the reference pixel's centre, and by how much they grow in x and in y. */
static void find_steps(const conic_gaussian_view *view, const conic_gaussian_footprint *f, double origin[3][3],
                       double direction[3][3]) {
  const conic_camera *camera = view->camera;
  const double steps[3][3] = {{((double)f->x + 0.5 - view->center_px[0]) / camera->fx,
                               ((double)f->y + 0.5 - view->center_px[1]) / camera->fy, 1.0},
                              {1.0 / camera->fx, 0.0, 0.0},
                              {0.0, 1.0 / camera->fy, 0.0}};
  memset(origin, 0, sizeof steps);
  memcpy(direction, steps, sizeof steps);
  if (view->is_parallel) {
    memcpy(origin, steps, sizeof steps);
    memset(direction, 0, sizeof steps);
    direction[0][2] = 1.0;
    origin[0][2] = 0.0;
  }
}

/* docs/reference/gaussians.md, Filter; g and m before a flat Gaussian's are cut down, all over `unit_of`. */
static void find_filter(const conic_gaussian_view *view, const double g[3][3], const double m[3][3], int is_flat,
                        double unit_of, conic_gaussian_filter *filter) {
  const double(*moves)[3] = view->is_parallel ? m : g, factor = sqrt(view->prefilter) / unit_of;
  double x[3], y[3], both[3], area[3];
  conic_cross(g[0], moves[1], x);
  conic_cross(g[0], moves[2], y);
  conic_cross(moves[1], moves[2], area);
  for (int k = 0; k < 3; k++) {
    int is_left = !is_flat || k < 2;
    both[k] = view->is_parallel ? 0.0 : area[k];
    filter->x[k] = is_left ? (float)(factor * x[k]) : 0.0f;
    filter->y[k] = is_left ? (float)(factor * y[k]) : 0.0f;
    filter->both[k] = is_left ? (float)(factor * both[k]) : 0.0f;
  }
  filter->turn[0] = (float)(factor * conic_dot(m[0], x));
  filter->turn[1] = (float)(factor * conic_dot(m[0], y));
  filter->turn[2] = (float)(factor * (view->is_parallel ? -conic_dot(m[2], x) : conic_dot(m[0], both)));
  filter->area = (float)(view->prefilter * (conic_dot(g[0], area) / unit_of));
}

/* The vectors whose products with a place tell how far along each axis it is. Unit axes are these vectors themselves.
 * Quaternions of any length give a disc other axes: there each vector is at right angles to the other two axes. */
static void find_inverse_axes(const conic_gaussian_view *view, const conic_gaussian_placed *p, double inverse[3][3]) {
  memcpy(inverse, p->unit, sizeof p->unit);
  const int as_is = view->rules->takes_rotation_as_is;
  if (as_is <= 1 || (as_is == 2 && !p->is_flat))
    return;
  conic_cross(p->unit[1], p->unit[2], inverse[0]);
  const double volume = conic_dot(p->unit[0], inverse[0]);
  for (int k = 0; k < 3; k++) {
    conic_cross(p->unit[(k + 1) % 3], p->unit[(k + 2) % 3], inverse[k]);
    for (int row = 0; row < 3; row++)
      inverse[k][row] /= volume;
  }
}

/* g, c and e at a place of the screen, and their gradients. In the frame where the Gaussian is a unit ball, times its
 * third scale where it is flat, so that nothing is divided by zero. */
static int find_ray(const conic_gaussian_view *view, const conic_gaussian_placed *p, const conic_gaussian_footprint *f,
                    conic_gaussian_ray *ray, conic_gaussian_filter *filter, double *unit) {
  double g[3][3], whole[3][3], c[3][3], e[3], m[3][3], one_over[3], unit_of = 0.0, origin[3][3], direction[3][3];
  double unit_axes[3][3];
  const double *const mean = p->mean;
  find_steps(view, f, origin, direction);
  find_inverse_axes(view, p, unit_axes);
  const double from_origin[3] = {mean[0] - origin[0][0], mean[1] - origin[0][1], mean[2] - origin[0][2]};
  for (int k = 0; k < 3; k++) {
    one_over[k] = p->is_flat && k == 2 ? 1.0 : 1.0 / p->scale[k];
    for (int step = 0; step < 3; step++) {
      g[step][k] = conic_dot(unit_axes[k], direction[step]) * one_over[k];
      m[step][k] = -(conic_dot(unit_axes[k], origin[step]) * one_over[k]);
    }
    m[0][k] = conic_dot(unit_axes[k], from_origin) * one_over[k];
  }
  memcpy(whole, g, sizeof g);
  for (int step = 0; step < 3; step++) {
    double *own_g = g[view->is_parallel ? 0 : step], *own_m = m[view->is_parallel ? step : 0];
    conic_cross(whole[view->is_parallel ? 0 : step], own_m, c[step]);
    if (p->is_flat) {
      c[step][2] = 0.0;
      own_g[0] = own_g[1] = 0.0;
    }
    e[step] = p->is_flat ? own_g[2] * own_m[2] : conic_dot(own_g, own_m);
  }
  unit_of = conic_length(g[0]);
  for (int step = 1; step < 3; step++) /* of a plane seen from its edge, g may be zero here */
    unit_of = unit_of > conic_length(g[step]) ? unit_of : conic_length(g[step]);
  if (!(unit_of > 0.0) || !is_number(unit_of))
    return 0;
  *unit = unit_of;
  for (int step = 0; step < 3; step++) {
    for (int k = 0; k < 3; k++) {
      ray->g[step][k] = (float)(g[step][k] / unit_of);
      ray->c[step][k] = (float)(c[step][k] / unit_of);
    }
    ray->e[step] = (float)(e[step] / unit_of / unit_of);
  }
  if (view->prefilter > 0.0)
    find_filter(view, (const double(*)[3])whole, (const double(*)[3])m, p->is_flat, unit_of, filter);
  return is_number((double)(ray->c[0][0] + ray->c[0][1] + ray->c[0][2] + ray->e[0]));
}

static void take_mean(const conic_gaussian_view *view, const conic_gaussian_placed *p, conic_gaussian_footprint *f) {
  double x = view->center_px[0], y = view->center_px[1];
  if (view->is_parallel) {
    x += view->camera->fx * p->mean[0];
    y += view->camera->fy * p->mean[1];
  } else if (p->mean[2] > 0.0) {
    x += view->camera->fx * (p->mean[0] / p->mean[2]);
    y += view->camera->fy * (p->mean[1] / p->mean[2]);
  }
  take_reference(view, x, y, f);
}

/* Whether it lies within what its axes say: not where they are neither of unit length nor inverted. */
static int lies_within_axes(const conic_gaussian_view *view, const conic_gaussian_placed *p) {
  return view->rules->takes_rotation_as_is != 2 || p->is_flat;
}

/* An outline is known of rays through an eye without a filter alone. */
static int find_ray_outline(const conic_gaussian_view *view, const conic_gaussian_placed *p, double reach,
                            const conic_gaussian_ray *ray, double unit_of, conic_gaussian_footprint *f) {
  f->half_reach = half_reach_of(reach);
  return view->is_parallel || view->prefilter > 0.0 || !lies_within_axes(view, p) ||
         conic_gaussian_find_outline(view, p, reach, ray, unit_of, f);
}

static conic_gaussian_fate set_up_ray(const conic_gaussian_view *view, conic_gaussian_placed *p,
                                      conic_gaussian_footprint *f, conic_gaussian_ray *ray,
                                      conic_gaussian_filter *filter) {
  double least[2], most[2], unit_of, reach = reach_of(view->rules, p->opacity);
  reach -= view->prefilter > 0.0 ? CONIC_REACH_SLACK : 0.0; /* a filter's box is a rule */
  if (!(reach > 0.0) || !conic_gaussian_project(view, p, reach, least, most))
    return CONIC_GAUSSIAN_CULLED;
  for (int axis = 0; axis < 2 && !lies_within_axes(view, p); axis++) {
    least[axis] = 0.0;
    most[axis] = axis ? view->camera->height : view->camera->width;
  }
  if (!conic_gaussian_limit_box(view, least, most, f))
    return CONIC_GAUSSIAN_CULLED;
  take_mean(view, p, f);
  return find_ray(view, p, f, ray, filter, &unit_of) && find_ray_outline(view, p, reach, ray, unit_of, f)
             ? CONIC_GAUSSIAN_DRAWN
             : CONIC_GAUSSIAN_CULLED;
}

/* The ray towards the mean at the time when it is seen. */
static void aim_in_time(const conic_gaussian_view *view, const conic_gaussian_placed *p, double direction[3],
                        double origin[3]) {
  double place[2], turn[3][3], at[3], share;
  conic_view_rays_show(view->rays, p->mean, view->rules->unscented_share, place, &share);
  share = conic_limited(share, -1.0, 1.0);
  conic_camera_shutter_pose(&view->rays->shutter, share, turn, at);
  for (int i = 0; i < 3; i++)
    at[i] += conic_dot(turn[i], p->mean);
  conic_view_rays_towards(view->camera, at, direction);
  conic_view_rays_turn(view->rays, share, direction, origin);
}

/* g and c about a direction, and their derivatives by directions; e of these. */
static int find_sight(const conic_gaussian_view *view, const conic_gaussian_placed *p, conic_gaussian_sight *sight) {
  double directions[4][3] = {{0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  double g[4][3], c[4][3], e[4], m[3], one_over[3], unit_of = 0.0, origin[3] = {0.0, 0.0, 0.0};
  if (view->camera->shutter)
    aim_in_time(view, p, directions[0], origin);
  else
    conic_view_rays_towards(view->camera, p->mean, directions[0]);
  const double from_origin[3] = {p->mean[0] - origin[0], p->mean[1] - origin[1], p->mean[2] - origin[2]};
  for (int k = 0; k < 3; k++) {
    one_over[k] = p->is_flat && k == 2 ? 1.0 : 1.0 / p->scale[k];
    m[k] = conic_dot(p->unit[k], from_origin) * one_over[k];
    sight->origin_high[k] = (float)origin[k];
    sight->origin_low[k] = (float)(origin[k] - (double)sight->origin_high[k]);
    sight->high[k] = (float)directions[0][k];
    sight->low[k] = (float)(directions[0][k] - (double)sight->high[k]);
  }
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < 3; k++)
      g[i][k] = conic_dot(p->unit[k], directions[i]) * one_over[k];
    conic_cross(g[i], m, c[i]);
    if (p->is_flat)
      c[i][2] = g[i][0] = g[i][1] = 0.0;
    e[i] = conic_dot(g[i], m);
    unit_of = unit_of > conic_length(g[i]) ? unit_of : conic_length(g[i]);
  }
  if (!(unit_of > 0.0) || !is_number(unit_of))
    return 0;
  sight->unit = view->camera->shutter ? (float)unit_of : 0.0f;
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < 3; k++) {
      sight->g[k][i] = (float)(g[i][k] / unit_of);
      sight->c[k][i] = (float)(c[i][k] / unit_of);
    }
    sight->e[i] = (float)(e[i] / unit_of / unit_of);
  }
  return is_number((double)(sight->c[0][1] + sight->c[1][2] + sight->c[2][3] + sight->e[0]));
}

static conic_gaussian_fate aim_sight(const conic_gaussian_view *view, const conic_gaussian_placed *p,
                                     conic_gaussian_footprint *f, conic_gaussian_sight *sight) {
  f->x = f->box[0][0];
  f->y = f->box[0][1];
  f->dx = f->dy = 0.0f;
  f->half_reach = INFINITY;
  return find_sight(view, p, sight) ? CONIC_GAUSSIAN_DRAWN : CONIC_GAUSSIAN_CULLED;
}

static conic_gaussian_fate set_up_sight(const conic_gaussian_view *view, const conic_gaussian_placed *p,
                                        conic_gaussian_footprint *f, conic_gaussian_sight *sight) {
  double reach = reach_of(view->rules, p->opacity), longest = 0.0;
  for (int k = 0; k < 3; k++)
    longest = p->scale[k] > longest ? p->scale[k] : longest;
  return reach > 0.0 && conic_view_rays_box(view->rays, p->mean, sqrt(reach) * longest, f->box)
             ? aim_sight(view, p, f, sight)
             : CONIC_GAUSSIAN_CULLED;
}

static conic_gaussian_fate set_up_solid(const conic_gaussian_view *view, conic_gaussian_placed *p,
                                        conic_gaussian_footprint *f, conic_gaussian_ray *ray,
                                        conic_gaussian_sight *sight) {
  const double reach = reach_of(view->rules, p->opacity);
  double least[2] = {0.0, 0.0}, most[2] = {view->camera->width, view->camera->height}, unit_of, place[2], half[2];
  for (int k = 0; k < 3; k++)
    if (!(p->scale[k] > 0x1p-23))
      return CONIC_GAUSSIAN_CULLED;
  if (!(reach > 0.0) || (!view->rays && !conic_gaussian_project(view, p, reach, least, most)))
    return CONIC_GAUSSIAN_CULLED;
  if (!conic_gaussian_unscented_box(view, p, place, half) ||
      (view->rules->coverage == CONIC_COVERAGE_BOX && !cover_box(view, place, half, least, most)) ||
      !conic_gaussian_limit_box(view, least, most, f))
    return CONIC_GAUSSIAN_CULLED;
  if (view->rays)
    return aim_sight(view, p, f, sight);
  take_mean(view, p, f);
  return find_ray(view, p, f, ray, NULL, &unit_of) && find_ray_outline(view, p, reach, ray, unit_of, f)
             ? CONIC_GAUSSIAN_DRAWN
             : CONIC_GAUSSIAN_CULLED;
}

/* The centre of the box of the outline at the profile's cutoff, and half the box's size. */
static int find_disc_box(const conic_gaussian_view *view, const conic_gaussian_placed *p, double place[2],
                         double extent[2]) {
  const double focal[2] = {view->camera->fx, view->camera->fy};
  const double square = view->rules->disc_cutoff * view->rules->disc_cutoff;
  double rows[3][3], weight;
  for (int k = 0; k < 3; k++) {
    for (int axis = 0; axis < 3; axis++)
      rows[axis][k] = k < 2 ? p->unit[k][axis] * p->scale[k] : p->mean[axis];
    for (int axis = 0; axis < 2; axis++)
      rows[axis][k] = focal[axis] * rows[axis][k] + view->center_px[axis] * rows[2][k];
  }
  weight = square * (rows[2][0] * rows[2][0] + rows[2][1] * rows[2][1]) - rows[2][2] * rows[2][2];
  if (weight == 0.0 || !is_number(weight))
    return 0;
  for (int axis = 0; axis < 2; axis++) {
    const double *r = rows[axis], *z = rows[2];
    place[axis] = (square * (r[0] * z[0] + r[1] * z[1]) - r[2] * z[2]) / weight;
    double apart = place[axis] * place[axis] - (square * (r[0] * r[0] + r[1] * r[1]) - r[2] * r[2]) / weight;
    extent[axis] = sqrt(apart > 1e-4 ? apart : 1e-4);
  }
  return is_number(place[0]) && is_number(place[1]);
}

static conic_gaussian_fate set_up_disc(const conic_gaussian_view *view, conic_gaussian_placed *p,
                                       conic_gaussian_footprint *f, conic_gaussian_ray *ray) {
  const conic_profile_row *rules = view->rules;
  const double reach = reach_of(rules, p->opacity);
  double place[2], extent[2], least[2], most[2], unit_of;
  if (!(reach > 0.0) || !find_disc_box(view, p, place, extent) || !conic_gaussian_project(view, p, reach, least, most))
    return CONIC_GAUSSIAN_CULLED;
  for (int axis = 0; axis < 2; axis++) { /* or the dot, whose variance is ½ px² */
    double dot = sqrt(0.5 * reach) + CONIC_GAUSSIAN_SLACK_PX;
    least[axis] = least[axis] < place[axis] - dot ? least[axis] : place[axis] - dot;
    most[axis] = most[axis] > place[axis] + dot ? most[axis] : place[axis] + dot;
  }
  if (rules->coverage == CONIC_COVERAGE_TILES)
    cover_square(view, place,
                 round_up(conic_limited(extent[0] > extent[1] ? extent[0] : extent[1], 3.0 * 0.707106, 1e15)), least,
                 most);
  for (int axis = 0; axis < 2; axis++)
    extent[axis] *= rules->disc_extent;
  if (rules->coverage == CONIC_COVERAGE_BOX && !cover_box(view, place, extent, least, most))
    return CONIC_GAUSSIAN_CULLED;
  if (!conic_gaussian_limit_box(view, least, most, f))
    return CONIC_GAUSSIAN_CULLED;
  take_reference(view, place[0], place[1], f);
  f->half_reach = half_reach_of(reach);
  return find_ray(view, p, f, ray, NULL, &unit_of) ? CONIC_GAUSSIAN_DRAWN : CONIC_GAUSSIAN_CULLED;
}

static void choose_normal(const conic_gaussian_view *view, const conic_gaussian_placed *p, float normal[3]) {
  int axis = 2;
  for (int k = 1; k >= 0 && !p->is_flat; k--)
    axis = p->scale[k] < p->scale[axis] ? k : axis;
  double side = (view->is_parallel ? p->unit[axis][2] : conic_dot(p->unit[axis], p->mean)) > 0.0 ? -1.0 : 1.0;
  for (int row = 0; row < 3; row++)
    normal[row] = (float)(side * p->world[row][axis]);
}

static void limit_color(const conic_profile_row *rules, double fade, float color[3]) {
  for (int c = 0; c < 3; c++) {
    color[c] = rules->color_most > 0.0 && color[c] > (float)rules->color_most ? (float)rules->color_most : color[c];
    color[c] = (float)(fade * (double)color[c]);
  }
}

conic_gaussian_fate conic_gaussian_set_up(const conic_gaussian_view *view, const conic_gaussians *gaussians, size_t i,
                                          conic_gaussian_footprint *f, float *key, conic_gaussian_ray *ray,
                                          conic_gaussian_filter *filter, conic_gaussian_sight *sight, float normal[3]) {
  const conic_profile_row *rules = view->rules;
  conic_gaussian_placed p;
  double from_eye[3], q[4], squares;
  if (!place_in_camera(view, gaussians, i, &p, from_eye) || !((squares = read_shape(gaussians, i, q, &p)) > 0.0))
    return CONIC_GAUSSIAN_SKIPPED;
  double z = p.mean[2];
  if (rules->shape != CONIC_SHAPE_RAY &&
      (z < rules->near_z || (rules->is_beyond_near && z == rules->near_z) || z <= 0.0))
    return CONIC_GAUSSIAN_CULLED;
  const double fade = conic_profile_fade(rules, z);
  p.opacity *= fade;
  if (is_far_beside(view, &p))
    return CONIC_GAUSSIAN_CULLED;
  place_axes(view, q, squares, &p);
  if (rules->shape == CONIC_SHAPE_RAY && !p.is_flat && p.scale[2] == 0.0)
    p.is_flat = 1;
  if (rules->shape != CONIC_SHAPE_ELLIPSE && !(p.scale[0] > 0.0 && p.scale[1] > 0.0))
    return CONIC_GAUSSIAN_CULLED;
  if (p.is_flat)
    p.scale[2] = 0.0;
  f->form[0] = f->form[1] = f->form[2] = f->z = 0.0f;
  conic_gaussian_fate fate = rules->shape == CONIC_SHAPE_SOLID     ? set_up_solid(view, &p, f, ray, sight)
                             : view->rays                          ? set_up_sight(view, &p, f, sight)
                             : rules->shape == CONIC_SHAPE_ELLIPSE ? set_up_ellipse(view, &p, f)
                             : rules->shape == CONIC_SHAPE_RAY     ? set_up_ray(view, &p, f, ray, filter)
                                                                   : set_up_disc(view, &p, f, ray);
  if (fate != CONIC_GAUSSIAN_DRAWN)
    return fate;
  int is_by_distance = view->rays && view->camera->kind != CONIC_CAMERA_PERSPECTIVE && rules->shape == CONIC_SHAPE_RAY;
  f->opacity = (float)p.opacity;
  if (rules->shape != CONIC_SHAPE_RAY)
    f->z = (float)z;
  *key = (float)(rules->orders_by_distance || is_by_distance ? conic_length(p.mean) : z);
  f->index = (uint32_t)i;
  if (normal)
    choose_normal(view, &p, normal);
  if (view->is_parallel) /* from an eye that is infinitely far */
    memcpy(from_eye, view->camera->cam_from_world[2], sizeof from_eye);
  if (!conic_harmonic_color(gaussians, i, rules->has_plain_color, from_eye, f->color))
    return CONIC_GAUSSIAN_SKIPPED;
  limit_color(rules, fade, f->color);
  return CONIC_GAUSSIAN_DRAWN;
}

/* --- what lanes have begun --- */

int conic_gaussian_has_ellipses(const conic_gaussian_view *view) {
  return view->rules->shape == CONIC_SHAPE_ELLIPSE && !view->rays && !view->is_parallel &&
         !conic_profile_limits_axes(view->rules) && view->rules->fade_z == 0.0 && view->rules->clip == 0.0 &&
         view->rules->takes_rotation_as_is <= 1;
}

conic_gaussian_fate conic_gaussian_take_ellipse(const conic_gaussian_view *view, const conic_gaussians *gaussians,
                                                const conic_gaussian_ellipses *e, size_t first, size_t at,
                                                conic_gaussian_footprint *f, float *key) {
  const conic_profile_row *rules = view->rules;
  const double place[2] = {e->place[0][at], e->place[1][at]};
  double least[2], most[2];
  if (!(e->is_drawn >> at & 1))
    return CONIC_GAUSSIAN_CULLED;
  for (int axis = 0; axis < 2; axis++) {
    least[axis] = place[axis] - e->half[axis][at];
    most[axis] = place[axis] + e->half[axis][at];
  }
  if (rules->coverage == CONIC_COVERAGE_TILES)
    cover_square(view, place, round_up(e->spread[at]), least, most);
  if (!conic_gaussian_limit_box(view, least, most, f))
    return CONIC_GAUSSIAN_CULLED;
  if (!conic_harmonic_sum(gaussians, first + at, rules->has_plain_color, &e->harmonics[0][at], CONIC_ELLIPSES,
                          f->color))
    return CONIC_GAUSSIAN_SKIPPED;
  limit_color(rules, 1.0, f->color);
  take_reference(view, place[0], place[1], f);
  f->half_reach = half_reach_of(e->reach[at]);
  for (int k = 0; k < 3; k++)
    f->form[k] = (float)e->form[k][at];
  f->opacity = (float)e->opacity[at];
  f->z = (float)e->z[at];
  *key = (float)e->key[at];
  f->index = (uint32_t)(first + at);
  return CONIC_GAUSSIAN_DRAWN;
}
