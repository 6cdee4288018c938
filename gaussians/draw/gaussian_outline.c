#include "gaussians/draw/gaussian_outline.h"

#include "core/base/vectors.h"

int conic_gaussian_limit_box(const conic_gaussian_view *view, const double least[2], const double most[2],
                             conic_gaussian_footprint *f) {
  const int size[2] = {view->camera->width, view->camera->height};
  for (int axis = 0; axis < 2; axis++) {
    double first = conic_limited(least[axis] - 0.5, 0.0, 65536.0);
    double last = conic_limited(most[axis] - 0.5, -1.0, size[axis] - 1);
    int whole = (int)first;
    whole += (double)whole < first;
    if (!(last >= (double)whole) || whole >= size[axis])
      return 0;
    f->box[0][axis] = (uint16_t)whole;
    f->box[1][axis] = (uint16_t)(int)last;
  }
  return 1;
}

/* Its dual conic, ρ²Σ − ppᵀ, cut by the planes through the eye that are upright or level. */
int conic_gaussian_project(const conic_gaussian_view *view, conic_gaussian_placed *p, double reach, double least[2],
                           double most[2]) {
  const double focal[2] = {view->camera->fx, view->camera->fy};
  const double growth_px = view->prefilter > 0.0 ? sqrt(reach * view->prefilter) : CONIC_GAUSSIAN_SLACK_PX;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double sum = 0.0;
      for (int k = 0; k < 3; k++)
        sum += p->unit[k][i] * p->scale[k] * (p->unit[k][j] * p->scale[k]);
      p->variance[i][j] = sum;
    }
  double depth = reach * p->variance[2][2] * (1.0 + 1e-9) - p->mean[2] * p->mean[2];
  if (depth < 0.0 && p->mean[2] < 0.0)
    return 0;
  for (int axis = 0; axis < 2; axis++) {
    double half = sqrt(reach * p->variance[axis][axis]), c = view->center_px[axis];
    least[axis] = view->is_parallel ? focal[axis] * (p->mean[axis] - half) + c - growth_px : -1e9;
    most[axis] = view->is_parallel ? focal[axis] * (p->mean[axis] + half) + c + growth_px : 1e9;
  }
  for (int axis = 0; axis < 2 && !view->is_parallel; axis++) {
    double a = reach * p->variance[axis][axis] - p->mean[axis] * p->mean[axis];
    double b = reach * p->variance[axis][2] - p->mean[axis] * p->mean[2], root = b * b - a * depth;
    if (!(depth < -1e-9 * p->mean[2] * p->mean[2]) || !(root >= 0.0))
      continue;
    double middle = b / depth, half = sqrt(root) / -depth * (1.0 + 1e-9), c = view->center_px[axis];
    least[axis] = conic_limited(focal[axis] * (middle - half) + c - growth_px, -1e9, 1e9);
    most[axis] = conic_limited(focal[axis] * (middle + half) + c + growth_px, -1e9, 1e9);
  }
  return 1;
}

/* The largest that a sum a₀ + a₁·x + a₂·y of vectors can be, term by term, where x and y are no more than `far`. */
static double greatest_terms(const float of[3][3], const double far[2]) {
  double sum = 0.0;
  for (int k = 0; k < 3; k++)
    sum += fabs((double)of[0][k]) + fabs((double)of[1][k]) * far[0] + fabs((double)of[2][k]) * far[1];
  return sum;
}

typedef struct certainty {
  double of_q; /* by how much of it q is wrong at most, wherever it is above reach */
  double of_e; /* by how much e is */
  double least_g;
} certainty;

/* |g| is at least 1 / (the largest scale · unit_of), since a ray's direction is not shorter than 1. Each term of g, c
 * and e is rounded four times by 2⁻²⁴ of it, and where q is above reach, |c| is above √reach·|g|. */
static certainty find_certainty(const conic_gaussian_placed *p, double reach, const conic_gaussian_ray *ray,
                                double unit_of, const conic_gaussian_footprint *f) {
  double far[2], largest = 0.0;
  for (int axis = 0; axis < 2; axis++) {
    double reference = axis == 0 ? f->x : f->y, first = fabs((double)f->box[0][axis] - reference);
    double last = fabs((double)f->box[1][axis] - reference);
    far[axis] = first > last ? first : last;
  }
  for (int k = 0; k < 3; k++)
    largest = largest > p->scale[k] ? largest : p->scale[k];
  certainty is = {.least_g = 1.0 / (largest * unit_of)};
  double of_g = 0x1p-20 * greatest_terms(ray->g, far), of_c = 0x1p-20 * greatest_terms(ray->c, far);
  is.of_q = 2.0 * (of_g + of_c / sqrt(reach)) / is.least_g + 1e-5;
  is.of_e = 0x1p-20 * (fabs((double)ray->e[0]) + fabs((double)ray->e[1]) * far[0] + fabs((double)ray->e[2]) * far[1]);
  return is;
}

/* What z along a ray is not below, as floats have it, 0 being always so. */
static float nearest_in_floats(const conic_gaussian_placed *p, double reach, const certainty *is) {
  double nearest = p->mean[2] - sqrt(reach * p->variance[2][2]);
  nearest = nearest * (1.0 - 1.2 * is->of_q) - 1.2 * is->of_e / (is->least_g * is->least_g);
  return nearest > 0.0 ? (float)(nearest * (1.0 - 1e-6)) : 0.0f;
}

/* The planes through the eye that touch the ellipsoid and are upright, or level, have it on one side: what is before
 * the eye is on that side on the screen, too. That holds only of an ellipsoid without the eye, so far from it that what
 * is behind the eye is so in floats. */
static int shrink_box(const conic_gaussian_view *view, const conic_gaussian_placed *p, double reach,
                      const certainty *is, double unit_of, conic_gaussian_footprint *f) {
  const double focal[2] = {view->camera->fx, view->camera->fy};
  double least[2], most[2], squares = 0.0;
  for (int k = 0; k < 3; k++) {
    double along = conic_dot(p->unit[k], p->mean) / p->scale[k];
    squares += along * along;
  }
  if (!((sqrt(squares) * (1.0 - 1e-9) - sqrt(reach)) * is->least_g > is->of_e * unit_of))
    return 1;
  for (int axis = 0; axis < 2; axis++) {
    double a = reach * p->variance[2][2] - p->mean[2] * p->mean[2];
    double b = reach * p->variance[axis][2] - p->mean[axis] * p->mean[2];
    double c = reach * p->variance[axis][axis] - p->mean[axis] * p->mean[axis], root = b * b - a * c;
    least[axis] = -1e9;
    most[axis] = 1e9;
    if (!(root > 1e-6 * b * b))
      continue;
    b += b > 0.0 ? sqrt(root) : -sqrt(root);
    const double slopes[2] = {b / a, c / b};
    for (int k = 0; k < 2; k++) {
      double side = p->mean[axis] - slopes[k] * p->mean[2], place = focal[axis] * slopes[k] + view->center_px[axis];
      if (side > 0.0 && place - CONIC_GAUSSIAN_SLACK_PX > least[axis])
        least[axis] = conic_limited(place - CONIC_GAUSSIAN_SLACK_PX, -1e9, 1e9);
      else if (side < 0.0 && place + CONIC_GAUSSIAN_SLACK_PX < most[axis])
        most[axis] = conic_limited(place + CONIC_GAUSSIAN_SLACK_PX, -1e9, 1e9);
    }
  }
  conic_gaussian_footprint shrunk;
  if (!conic_gaussian_limit_box(view, least, most, &shrunk))
    return 0;
  for (int axis = 0; axis < 2; axis++) {
    if (shrunk.box[0][axis] > f->box[0][axis])
      f->box[0][axis] = shrunk.box[0][axis];
    if (shrunk.box[1][axis] < f->box[1][axis])
      f->box[1][axis] = shrunk.box[1][axis];
  }
  return f->box[0][0] <= f->box[1][0] && f->box[0][1] <= f->box[1][1];
}

int conic_gaussian_find_outline(const conic_gaussian_view *view, const conic_gaussian_placed *p, double reach,
                                const conic_gaussian_ray *ray, double unit_of, conic_gaussian_footprint *f) {
  const double focal[2] = {view->camera->fx, view->camera->fy}, *mean = p->mean;
  f->z = 0.0f;
  if (p->is_flat || !((double)f->half_reach < 100.0))
    return 1;
  const certainty is = find_certainty(p, reach, ray, unit_of, f);
  if (!(is.of_q < 0.1))
    return 1;
  const double wide = reach * (1.001 + 2.0 * is.of_q), depth = mean[2] * mean[2] - wide * p->variance[2][2];
  f->z = nearest_in_floats(p, wide, &is);
  if (!(depth > 1e-3 * mean[2] * mean[2]))
    return shrink_box(view, p, wide, &is, unit_of, f);
  double slope[2], form[3], n = 1.0;
  for (int axis = 0; axis < 2; axis++) {
    slope[axis] = (mean[axis] * mean[2] - wide * p->variance[axis][2]) / depth;
    n += slope[axis] * slope[axis];
  }
  for (int k = 0; k < 3; k++) { /* xx, xy, yy */
    int i = k / 2, j = (k + 1) / 2;
    form[k] = slope[i] * slope[j] - (mean[i] * mean[j] - wide * p->variance[i][j]) / depth;
  }
  double area = form[0] * form[2] - form[1] * form[1];
  if (!(area > 1e-10 * n * (form[0] + form[2])))
    return 1;
  const double scale = 2.0 * (double)f->half_reach / area;
  f->dx = (float)((double)f->x + 0.5 - (focal[0] * slope[0] + view->center_px[0]));
  f->dy = (float)((double)f->y + 0.5 - (focal[1] * slope[1] + view->center_px[1]));
  f->form[0] = (float)(scale * form[2] / (focal[0] * focal[0]));
  f->form[1] = (float)(-scale * form[1] / (focal[0] * focal[1]));
  f->form[2] = (float)(scale * form[0] / (focal[1] * focal[1]));
  return 1;
}
