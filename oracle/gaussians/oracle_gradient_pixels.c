/* A pixel's part of the derivative. With v the derivative by a weight, and B that by the light from behind, which is
 * α·v + (1 − α)·B one Gaussian further to the front, dL/dα = T·(v − B): nothing is divided by 1 − α. */

#include "oracle/gaussians/oracle_gradient.h"
#include "oracle/oracle_math.h"

/* --- what a pixel may see --- */

static void limit_pixels(const oracle_gaussian_view *view, const oracle_gaussian *g, const double low[2],
                         const double high[2], oracle_shown *shown) {
  const double size[2] = {view->camera->width, view->camera->height};
  for (int axis = 0; axis < 2; axis++) {
    double first = ceil(oracle_max(oracle_max(low[axis], g->box_px[0][axis]) - 0.5, 0.0));
    double last = floor(oracle_min(oracle_min(high[axis], g->box_px[1][axis]) - 0.5, size[axis] - 1.0));
    int is_empty = !(first <= last);
    shown->first[axis] = (uint16_t)(is_empty ? 1.0 : first);
    shown->last[axis] = (uint16_t)(is_empty ? 0.0 : last);
  }
}

/* Amply where q is at its most: a variance is the other diagonal number of the form, over its determinant. */
static void reach_ellipse(const oracle_gaussian_view *view, const oracle_gaussian *g, oracle_shown *shown) {
  const double focal[2] = {view->camera->fx, view->camera->fy}, size[2] = {view->camera->width, view->camera->height};
  double low[2], high[2];
  for (int axis = 0; axis < 2; axis++) { /* a slope that is clamped lies within 1.3 of the picture's own */
    double slope = fabs(g->mean[axis] / g->mean[2]), variance = view->rules->dilation;
    if (view->rules->slope_margin >= 0.0)
      slope = oracle_min(slope, 2.0 * (size[axis] + fabs(view->center_px[axis])) / focal[axis]);
    for (int k = 0; k < 3; k++) {
      double row = focal[axis] / g->mean[2] * (fabs(g->axes[k][axis]) + slope * fabs(g->axes[k][2]));
      variance += row * row;
    }
    double half = sqrt(shown->most_q * variance) * (1.0 + 1e-6) + 1.0;
    low[axis] = g->place_px[axis] - half;
    high[axis] = g->place_px[axis] + half;
  }
  limit_pixels(view, g, low, high, shown);
}

/* Planes through the eye touch the ellipsoid of q where (p_a − s·p_z)² = q·Σ(A_a − s·A_z)². */
static void reach_ray(const oracle_gaussian_view *view, const oracle_gaussian *g, oracle_shown *shown) {
  const double focal[2] = {view->camera->fx, view->camera->fy}, z = g->mean[2];
  double low[2] = {-INFINITY, -INFINITY}, high[2] = {INFINITY, INFINITY}, along = z * z;
  for (int k = 0; k < 3; k++)
    along -= shown->most_q * g->axes[k][2] * g->axes[k][2] * (1.0 + 1e-6);
  for (int axis = 0; axis < 2 && along > 1e-6 * z * z && z > 0.0; axis++) {
    double across = g->mean[axis] * g->mean[axis], mixed = g->mean[axis] * z;
    for (int k = 0; k < 3; k++) {
      across -= shown->most_q * g->axes[k][axis] * g->axes[k][axis];
      mixed -= shown->most_q * g->axes[k][axis] * g->axes[k][2];
    }
    double half = sqrt(oracle_max(mixed * mixed - along * across, 0.0)) / along * (1.0 + 1e-3);
    low[axis] = focal[axis] * (mixed / along - half) + view->center_px[axis] - 1.0;
    high[axis] = focal[axis] * (mixed / along + half) + view->center_px[axis] + 1.0;
  }
  limit_pixels(view, g, low, high, shown);
}

static void map_to_ball(const oracle_gaussian *g, oracle_shown *shown) {
  shown->is_flat = g->is_flat || g->scale[2] == 0.0;
  for (int k = 0; k < 3; k++) {
    const double scale = shown->is_flat && k == 2 ? 1.0 : g->scale[k];
    for (int axis = 0; axis < 3; axis++)
      shown->ball[k][axis] = g->unit[k][axis] / scale;
    shown->middle[k] = oracle_dot(shown->ball[k], g->mean);
  }
}

int conic_oracle_show(const oracle_gaussian_view *view, const conic_gaussians *set, size_t i, oracle_shown *shown) {
  const conic_profile_row *rules = view->rules;
  oracle_gaussian g;
  conic_oracle_gaussian_place(view, set, i, &g);
  *shown = (oracle_shown){.index = (uint32_t)i, .key = g.key, .opacity = g.opacity, .z = g.mean[2]};
  shown->most_q = rules->greatest_half_q > 0.0 ? 2.0 * rules->greatest_half_q : -1.0;
  if (rules->alpha_least > 0.0 && g.opacity >= 0.99 * rules->alpha_least)
    shown->most_q = 2.0 * conic_oracle_log(g.opacity / rules->alpha_least) + 0.03;
  if (!g.is_drawn || !(shown->most_q >= 0.0))
    return 0;
  memcpy(shown->color, g.color, sizeof shown->color);
  memcpy(shown->place, g.place_px, sizeof shown->place);
  memcpy(shown->form, g.form, sizeof shown->form);
  if (rules->shape == CONIC_SHAPE_RAY) {
    map_to_ball(&g, shown);
    reach_ray(view, &g, shown);
  } else
    reach_ellipse(view, &g, shown);
  return shown->first[0] <= shown->last[0] && shown->first[1] <= shown->last[1];
}

/* --- what it sees --- */

/* Through a pixel of a pinhole, where the Gaussian is a unit ball. */
static void ray_in_ball(const oracle_gaussian_view *view, const oracle_shown *shown, double x, double y, double ray[3],
                        double g[3]) {
  ray[0] = (x - view->center_px[0]) / view->camera->fx;
  ray[1] = (y - view->center_px[1]) / view->camera->fy;
  ray[2] = 1.0;
  for (int k = 0; k < 3; k++)
    g[k] = oracle_dot(shown->ball[k], ray);
}

static double meet_shown_ray(const oracle_gaussian_view *view, const oracle_shown *shown, double x, double y,
                             double *z) {
  const double *m = shown->middle;
  double ray[3], g[3], cross[3];
  ray_in_ball(view, shown, x, y, ray, g);
  if (shown->is_flat) {
    *z = m[2] / g[2];
    double u = *z * g[0] - m[0], v = *z * g[1] - m[1];
    return u * u + v * v;
  }
  const double square = oracle_dot(g, g);
  oracle_cross(g, m, cross);
  *z = oracle_dot(g, m) / square;
  return oracle_dot(cross, cross) / square;
}

int conic_oracle_meet_shown(const oracle_gaussian_view *view, const oracle_shown *shown, double x, double y,
                            oracle_met *met) {
  const conic_profile_row *rules = view->rules;
  double q;
  met->z = shown->z;
  if (rules->shape == CONIC_SHAPE_RAY) {
    q = meet_shown_ray(view, shown, x, y, &met->z);
    if (!(met->z > 0.0) || !oracle_is_finite(met->z))
      return 0;
  } else {
    double dx = shown->place[0] - x, dy = shown->place[1] - y;
    q = shown->form[0] * dx * dx + 2.0 * shown->form[1] * dx * dy + shown->form[2] * dy * dy;
  }
  if (!(q >= 0.0) || q > shown->most_q)
    return 0;
  met->response = conic_oracle_exp(-0.5 * q);
  const double alpha = shown->opacity * met->response;
  met->is_most = alpha > rules->alpha_most;
  met->alpha = met->is_most ? rules->alpha_most : alpha;
  met->index = shown->index;
  met->key = rules->shape == CONIC_SHAPE_RAY ? (float)met->z : shown->key;
  return met->alpha >= rules->alpha_least ? ORACLE_COVERS : met->alpha >= 0.99 * rules->alpha_least ? ORACLE_NEARLY : 0;
}

double conic_oracle_gradient_forth(const oracle_gaussian_view *view, const oracle_gradient_pixel *pixel,
                                   const oracle_shown *const *shown, oracle_met *met, size_t *n, double *behind) {
  const conic_profile_row *rules = view->rules;
  const double *w = pixel->weights;
  double T = 1.0, sum = 0.0, sum_of_z = 0.0, loss = 0.0;
  size_t n_met = 0;
  for (; n_met < *n; n_met++) {
    oracle_met *m = &met[n_met];
    const double rest = T * (1.0 - m->alpha);
    if (!pixel->goes_on && (rest < rules->stop || (rules->is_beyond_stop && rest == rules->stop)))
      break;
    m->before = T;
    sum += m->alpha * T;
    sum_of_z += m->alpha * T * m->z;
    T = rest;
  }
  *n = n_met;
  const oracle_surface *surface = pixel->surface;
  const double z = !surface && sum > 0.0 ? sum_of_z / sum : 0.0;
  *behind = surface ? w[4] * surface->z : -w[3]; /* a surface makes A = 1, and Z = Σ w·z + T·Z_S */
  for (int c = 0; c < 3; c++)
    *behind += w[c] * (surface ? surface->color[c] : (double)pixel->background[c]);
  sum = surface ? 1.0 : sum;
  for (size_t i = 0; i < n_met; i++) {
    const double *color = shown[met[i].entry]->color;
    double by_weight = w[0] * color[0] + w[1] * color[1] + w[2] * color[2];
    loss += by_weight * met[i].alpha * met[i].before;
    met[i].by_weight = by_weight + (sum > 0.0 ? w[4] * (met[i].z - z) / sum : 0.0);
    met[i].by_z = sum > 0.0 ? w[4] * met[i].alpha * met[i].before / sum : 0.0;
  }
  return loss + w[3] + *behind * T + w[4] * (surface ? sum_of_z : z);
}

/* q = |g × m|²/|g|² and z = g·m/|g|²; of a flat one, what they come to. */
static void ray_met_back(const oracle_gaussian_view *view, const oracle_gradient_pixel *pixel,
                         const oracle_shown *shown, const oracle_met *met, double by_q, double *sums) {
  const double *m = shown->middle, z = met->z;
  double ray[3], g[3], cross[3], by_g[3] = {0.0}, by_m[3] = {0.0};
  ray_in_ball(view, shown, pixel->x, pixel->y, ray, g);
  if (shown->is_flat) {
    double by_depth = met->by_z;
    for (int k = 0; k < 2; k++) {
      double by_u = 2.0 * by_q * (z * g[k] - m[k]);
      by_g[k] = by_u * z;
      by_m[k] = -by_u;
      by_depth += by_u * g[k];
    }
    by_m[2] = by_depth / g[2];
    by_g[2] = -by_depth * z / g[2];
  } else {
    const double square = oracle_dot(g, g);
    double along[3];
    oracle_cross(g, m, cross);
    const double q = oracle_dot(cross, cross) / square;
    for (int k = 0; k < 3; k++) {
      by_g[k] = met->by_z / square * m[k] - 2.0 * (by_q * q + met->by_z * z) / square * g[k];
      by_m[k] = met->by_z / square * g[k];
      cross[k] *= 2.0 * by_q / square;
    }
    oracle_cross(m, cross, along);
    for (int k = 0; k < 3; k++)
      by_g[k] += along[k];
    oracle_cross(cross, g, along);
    for (int k = 0; k < 3; k++)
      by_m[k] += along[k];
  }
  for (int k = 0; k < 3; k++) {
    for (int axis = 0; axis < 3; axis++)
      sums[BY_BALL + 3 * k + axis] += by_g[k] * ray[axis];
    sums[BY_MIDDLE + k] += by_m[k];
  }
}

void conic_oracle_gradient_back(const oracle_gaussian_view *view, const oracle_gradient_pixel *pixel,
                                const oracle_shown *shown, const oracle_met *met, double by_alpha, double *sums) {
  const double weight = met->alpha * met->before;
  const int is_held = met->is_most && !pixel->passes_most;
  const double by_q = is_held ? 0.0 : -0.5 * (met->is_most ? shown->opacity * met->response : met->alpha) * by_alpha;
  sums[BY_OPACITY] += is_held ? 0.0 : by_alpha * met->response;
  for (int c = 0; c < 3; c++)
    sums[BY_COLOR + c] += pixel->weights[c] * weight;
  if (view->rules->shape == CONIC_SHAPE_RAY) {
    ray_met_back(view, pixel, shown, met, by_q, sums);
    return;
  }
  const double dx = shown->place[0] - pixel->x, dy = shown->place[1] - pixel->y;
  sums[BY_Z] += met->by_z;
  sums[BY_PLACE] += by_q * 2.0 * (shown->form[0] * dx + shown->form[1] * dy);
  sums[BY_PLACE + 1] += by_q * 2.0 * (shown->form[1] * dx + shown->form[2] * dy);
  sums[BY_FORM] += by_q * dx * dx;
  sums[BY_FORM + 1] += by_q * 2.0 * dx * dy;
  sums[BY_FORM + 2] += by_q * dy * dy;
}
