#include <math.h>

#include "core/base/vectors.h"
#include "raster/project/clip_disc.h"

/* The functions here take the few splats that come near the camera (or all of method `ray`), so they compute in double:
 * p may be behind the eye, and M's adjugate has to hold. */

static double length_z(const conic_disc *disc) {
  return sqrt(disc->tu[2] * disc->tu[2] + disc->tv[2] * disc->tv[2]);
}

/* The splat's own range of inverse depth. */
static void set_range(const conic_view *view, const conic_disc *disc, conic_footprint *footprint) {
  double reach = (double)view->cutoff * length_z(disc);
  double nearest = disc->p[2] - reach;
  footprint->iz_far = (float)(1.0 / (disc->p[2] + reach));
  footprint->iz_near = (float)(1.0 / (nearest > view->near_z ? nearest : view->near_z));
}

/* Pixels whose centres lie in [low, high], as begin and end within [0, size). */
static void pixels_between(double low, double high, int size, uint16_t *begin, uint16_t *end) {
  double first = ceil(low - 0.5), last = floor(high - 0.5);
  first = first > 0.0 ? first : 0.0;
  last = last < (double)(size - 1) ? last : (double)(size - 1);
  *begin = *end = 0;
  if (first <= last) {
    *begin = (uint16_t)first;
    *end = (uint16_t)(last + 1.0);
  }
}

/* The clipped disc's box, widened by what the prefilter adds; its middle becomes the reference pixel. */
static conic_outcome set_box(const conic_view *view, const conic_disc *disc, conic_footprint *footprint,
                             conic_box *box) {
  const double along_x[2] = {1.0, 0.0}, along_y[2] = {0.0, 1.0};
  conic_screen_point left, right, top, bottom;
  if (!conic_clip_disc(view, disc, along_x, &left, &right) || !conic_clip_disc(view, disc, along_y, &top, &bottom))
    return CONIC_CULLED;
  double growth = (double)view->growth_px;
  pixels_between(left.x_px - growth, right.x_px + growth, view->width, &box->x_begin, &box->x_end);
  pixels_between(top.y_px - growth, bottom.y_px + growth, view->height, &box->y_begin, &box->y_end);
  if (conic_box_is_empty(box))
    return CONIC_CULLED;
  int x = (box->x_begin + box->x_end) / 2, y = (box->y_begin + box->y_end) / 2;
  footprint->x = (float)x;
  footprint->y = (float)y;
  footprint->dx0 = footprint->dy0 = 0.0f;
  return CONIC_DRAWN_RAY;
}

/* The affine function d·m/determinant on the screen: its value at the reference pixel and its gradient. */
static void set_affine(const conic_view *view, const conic_footprint *footprint, const double m[3], double determinant,
                       float *value, float *by_x, float *by_y) {
  double dx = ((double)footprint->x + 0.5 - view->cx) / view->fx;
  double dy = ((double)footprint->y + 0.5 - view->cy) / view->fy;
  *value = (float)((dx * m[0] + dy * m[1] + m[2]) / determinant);
  *by_x = (float)(m[0] / (view->fx * determinant));
  *by_y = (float)(m[1] / (view->fy * determinant));
}

/* The screen gradient of the plane's inverse depth, times |determinant|. */
static double gradient_length(const conic_view *view, const conic_disc *disc) {
  double gx = disc->n[0] / view->fx, gy = disc->n[1] / view->fy;
  return sqrt(gx * gx + gy * gy);
}

conic_outcome conic_project_ray(const conic_view *view, const conic_disc *disc, conic_footprint *footprint,
                                conic_box *box, conic_ray *ray) {
  double m_u[3], m_v[3];
  if (disc->determinant == 0.0)
    return CONIC_SKIPPED;
  conic_outcome outcome = set_box(view, disc, footprint, box);
  if (outcome != CONIC_DRAWN_RAY)
    return outcome;
  set_range(view, disc, footprint);
  /* M⁻¹ has the columns t_v × p, p × t_u, t_u × t_v over the determinant. */
  conic_cross(disc->tv, disc->p, m_u);
  conic_cross(disc->p, disc->tu, m_v);
  set_affine(view, footprint, m_u, disc->determinant, &ray->u0, &ray->u_dx, &ray->u_dy);
  set_affine(view, footprint, m_v, disc->determinant, &ray->v0, &ray->v_dx, &ray->v_dy);
  set_affine(view, footprint, disc->n, disc->determinant, &footprint->iz0, &footprint->iz_dx, &footprint->iz_dy);
  ray->dx_low = (float)box->x_begin - footprint->x;
  ray->dx_high = (float)(box->x_end - 1) - footprint->x;
  ray->dy_low = (float)box->y_begin - footprint->y;
  ray->dy_high = (float)(box->y_end - 1) - footprint->y;
  footprint->s2 = footprint->s3 = 0.0f;
  footprint->plane_dx = footprint->iz_dx;
  footprint->plane_dy = footprint->iz_dy;

  /* A hair more than the range: across the line of sight it is narrower than a rounding of iz. */
  const double hair = 0x1p-20;
  double widening = gradient_length(view, disc) / fabs(disc->determinant) * (double)view->growth_px;
  double high = (double)footprint->iz_near + widening, highest = 1.0 / view->near_z;
  double low = (double)footprint->iz_far - widening - hair * (double)footprint->iz_far;
  ray->iz_high = (float)((high < highest ? high : highest) + hair * (double)footprint->iz_near);
  ray->iz_low = (float)(low > 0.0 ? low : 0.0);
  return CONIC_DRAWN_RAY;
}

/* The clipped disc seen from its own plane: a segment, whose variance is that of a splat with its ends on the outline.
 */
static conic_outcome project_segment(const conic_view *view, const conic_disc *disc, conic_footprint *footprint,
                                     conic_box *box) {
  conic_screen_point a, b;
  double gx = disc->n[0] / view->fx, gy = disc->n[1] / view->fy, g = sqrt(gx * gx + gy * gy);
  const double along_line[2] = {g > 0.0 ? -gy / g : 1.0, g > 0.0 ? gx / g : 0.0};
  double h = (double)view->prefilter, cutoff = (double)view->cutoff;
  if (!(h > 0.0))
    return CONIC_SKIPPED;
  if (!conic_clip_disc(view, disc, along_line, &a, &b))
    return CONIC_CULLED;
  double ex = b.x_px - a.x_px, ey = b.y_px - a.y_px, length = sqrt(ex * ex + ey * ey);
  if (length > 0.0) {
    ex /= length;
    ey /= length;
  }
  double variance = 0.25 * length * length / (cutoff * cutoff);
  double rxx = variance * ex * ex, rxy = variance * ex * ey, ryy = variance * ey * ey;
  double determinant = h * (variance + h), vyy = ryy + h;
  double x_t = 0.5 * (a.x_px + b.x_px), y_t = 0.5 * (a.y_px + b.y_px);
  double half_x = cutoff * sqrt(rxx + h), half_y = cutoff * sqrt(vyy);
  pixels_between(x_t - half_x - 1.0, x_t + half_x + 1.0, view->width, &box->x_begin, &box->x_end);
  pixels_between(y_t - half_y - 1.0, y_t + half_y + 1.0, view->height, &box->y_begin, &box->y_end);
  if (conic_box_is_empty(box))
    return CONIC_CULLED;
  /* The reference is the pixel of the image nearest the middle, which may be far outside. */
  double x = floor(x_t), y = floor(y_t);
  footprint->x = (float)(int32_t)(x < -1e6 ? -1e6 : x > 1e6 ? 1e6 : x);
  footprint->y = (float)(int32_t)(y < -1e6 ? -1e6 : y > 1e6 ? 1e6 : y);
  footprint->dx0 = (float)((double)footprint->x + 0.5 - x_t);
  footprint->dy0 = (float)((double)footprint->y + 0.5 - y_t);
  footprint->s1 = (float)sqrt(vyy / determinant);
  footprint->s2 = (float)(-rxy / sqrt(vyy * determinant));
  footprint->s3 = (float)(1.0 / sqrt(vyy));
  if (!(footprint->s3 > 0.0f)) /* 0 would mean a ray */
    return CONIC_SKIPPED;
  double slope = length > 0.0 ? (1.0 / b.z - 1.0 / a.z) / length : 0.0;
  double shrunk = slope * variance / (variance + h);
  footprint->iz0 = (float)(0.5 / a.z + 0.5 / b.z);
  footprint->iz_dx = (float)(shrunk * ex);
  footprint->iz_dy = (float)(shrunk * ey);
  set_range(view, disc, footprint);
  footprint->plane_dx = (float)(slope * ex);
  footprint->plane_dy = (float)(slope * ey);
  return CONIC_DRAWN_SEGMENT;
}

conic_outcome conic_project_near(const conic_view *view, const conic_disc *disc, conic_footprint *footprint,
                                 conic_box *box, conic_ray *ray) {
  /* Edge-on is, as elsewhere, less than half a pixel per standard deviation: here, of the band on the screen in which
   * the plane's inverse depth runs from the disc's far to its near end. */
  set_range(view, disc, footprint);
  double range = (double)footprint->iz_near - (double)footprint->iz_far;
  if (range * fabs(disc->determinant) < (double)view->cutoff * gradient_length(view, disc))
    return project_segment(view, disc, footprint, box);
  return conic_project_ray(view, disc, footprint, box, ray);
}
