#include "raster/project/projected.h"

#include <math.h>
#include <string.h>

#include "core/base/vectors.h"
#include "raster/view/method.h"
#include "raster/view/slips.h"

/* A splat in camera space, divided by p_z: x and y then are on the image plane at distance 1. */
typedef struct tangents {
  float ux, uy, uz, vx, vy, vz;
} tangents;

/* What the stages of setting up one splat hand to each other. */
typedef struct splat_setup {
  const conic_view *view;
  const conic_splats *splats;
  size_t i;
  double p[3]; /* camera space */
  double inverse_z;
  float reach;             /* F_g·h_z / p_z */
  float nearest, farthest; /* 1 - reach and 1 + reach, rounded from double: the difference may nearly vanish */
  float extent_px[2];      /* how far from where p projects to it may cover pixels, in x and y; infinite if unknown */
  float along_ray;         /* p·(t_u × t_v), up to a positive factor: below 0 the splat faces the viewer */
  conic_footprint *footprint;
  conic_box *box;
  conic_ray *ray;
  conic_projected_surface *surface;
} splat_setup;

static float finite_or(float value, float otherwise) {
  return value * 0.0f == 0.0f ? value : otherwise;
}

static void rotate(const float m[3][3], const float *const v[3], size_t i, float result[3]) {
  for (int row = 0; row < 3; row++)
    result[row] = (m[row][0] * v[0][i] + m[row][1] * v[1][i]) + m[row][2] * v[2][i];
}

static double row_times(const double m[3], const float *const v[3], size_t i) {
  return (m[0] * (double)v[0][i] + m[1] * (double)v[1][i]) + m[2] * (double)v[2][i];
}

static void move_center(const conic_view *view, const conic_splats *splats, size_t i, double p[3]) {
  for (int row = 0; row < 3; row++)
    p[row] = row_times(view->rotation[row], (const float *const *)splats->position, i) + view->translation[row];
}

conic_disc conic_disc_of(const conic_view *view, const conic_splats *splats, size_t i) {
  conic_disc disc;
  move_center(view, splats, i, disc.p);
  for (int row = 0; row < 3; row++) {
    disc.tu[row] = row_times(view->rotation[row], (const float *const *)splats->tangent_u, i);
    disc.tv[row] = row_times(view->rotation[row], (const float *const *)splats->tangent_v, i);
  }
  conic_cross(disc.tu, disc.tv, disc.n);
  disc.determinant = (disc.p[0] * disc.n[0] + disc.p[1] * disc.n[1]) + disc.p[2] * disc.n[2];
  return disc;
}

/* Pixels [begin, end) of [0, size) whose centres lie within reach of the centre. */
static void pixel_range(double center, double reach, int size, uint16_t *begin, uint16_t *end) {
  double low = center - reach + 0.5, high = center + reach + 0.5;
  low = low > 0.0 ? low : 0.0;
  high = high < (double)size ? high : (double)size;
  *begin = *end = 0;
  if (low < high) {
    *begin = (uint16_t)low;
    *end = (uint16_t)high;
  }
}

/* The variance of the projected kernel about its centre, and what else the dual conic gives (PAS §4 in dual form,
 * shifted so that p projects to the origin; docs/reference/picture.md has the derivation). */
typedef struct projected_kernel {
  float rxx, rxy, ryy;    /* px² */
  float root_determinant; /* √|R'|, not by rxx·ryy - rxy²: that cancels when edge-on */
  float shift_x, shift_y; /* from the projected p to the footprint's centre, px */
  float bx, by;           /* t'_u·t_u.z + t'_v·t_v.z, over p_z² */
  float inverse_w;        /* p_z² / (p_z² - F_g²·h_z²) */
} projected_kernel;

static projected_kernel dual_conic(const tangents *t, float cutoff, float w) {
  projected_kernel k;
  float inverse_w = 1.0f / w;
  float cutoff_squared = cutoff * cutoff, tilt = cutoff_squared * (inverse_w * inverse_w);
  k.bx = t->ux * t->uz + t->vx * t->vz;
  k.by = t->uy * t->uz + t->vy * t->vz;
  k.rxx = (t->ux * t->ux + t->vx * t->vx) * inverse_w + tilt * (k.bx * k.bx);
  k.rxy = (t->ux * t->uy + t->vx * t->vy) * inverse_w + tilt * (k.bx * k.by);
  k.ryy = (t->uy * t->uy + t->vy * t->vy) * inverse_w + tilt * (k.by * k.by);
  k.root_determinant = fabsf(t->ux * t->vy - t->uy * t->vx) * (inverse_w * sqrtf(inverse_w));
  k.shift_x = -(cutoff_squared * inverse_w) * k.bx;
  k.shift_y = -(cutoff_squared * inverse_w) * k.by;
  k.inverse_w = inverse_w;
  return k;
}

/* The Jacobian at the centre (HQP §3.4 with its Eq. 3.27 corrected): what the dual conic becomes for a vanishing
 * outline, F_g = 0 and w = 1. */
static projected_kernel jacobian_at_center(const tangents *t) {
  return dual_conic(t, 0.0f, 1.0f);
}

/* The smaller eigenvalue of R' is below the limit, ¼ px² for most methods: edge-on or tiny. */
static int is_thin(const conic_view *view, const projected_kernel *k) {
  float trace = k->rxx + k->ryy, difference = k->rxx - k->ryy;
  float spread = sqrtf(difference * difference + 4.0f * (k->rxy * k->rxy));
  float smaller = 2.0f * (k->root_determinant * k->root_determinant) / (trace + spread);
  return !(smaller >= view->thin);
}

/* Whether conic's weights may be off by more than `auto` allows. Its centre is that of the outline and not the
 * projected p: A·√(δᵀV⁻¹δ) bounds what that does. δᵀ adj(R') δ is (F_g·reach)²·|R'|, without the cancellation. */
static int is_coarse(const splat_setup *s, const projected_kernel *k) {
  const conic_view *view = s->view;
  float h = view->prefilter, square = k->root_determinant * k->root_determinant;
  float determinant = (square + h * (k->rxx + k->ryy)) + h * h, inverse = 1.0f / determinant;
  float along = view->cutoff * s->reach;
  float moved = (along * along) * square + h * (k->shift_x * k->shift_x + k->shift_y * k->shift_y);
  return (square * inverse) * (moved * inverse) > view->auto_limit;
}

static int wants_ray(const splat_setup *s, const projected_kernel *k) {
  conic_method method = s->view->method;
  if (is_thin(s->view, k))
    return 0;
  return method == CONIC_METHOD_RAY || (method == CONIC_METHOD_AUTO ? is_coarse(s, k) : s->reach >= 0.25f);
}

static void set_depth(const splat_setup *s, const projected_kernel *k, float vxx, float vyy, float determinant) {
  conic_footprint *footprint = s->footprint;
  float inverse_z = (float)s->inverse_z;
  /* R'g = -b·iz/w², without the cancellation of R' times g; then the gradient shrunk by the dilation, V⁻¹R'g. */
  float factor = -inverse_z * (k->inverse_w * k->inverse_w);
  float rgx = factor * k->bx, rgy = factor * k->by;
  footprint->iz0 = inverse_z * k->inverse_w;
  footprint->iz_dx = (vyy * rgx - k->rxy * rgy) / determinant;
  footprint->iz_dy = (vxx * rgy - k->rxy * rgx) / determinant;
  footprint->iz_far = inverse_z / s->farthest;
  footprint->iz_near = inverse_z / s->nearest;
}

/* Of a box half so wide and high, with its centre so far from where p projects to. */
static void set_extent(splat_setup *s, float half_x, float half_y, float shift_x, float shift_y) {
  s->extent_px[0] = half_x + fabsf(shift_x);
  s->extent_px[1] = half_y + fabsf(shift_y);
}

/* The gradient of the plane's inverse depth. */
static void set_slope(const splat_setup *s, const tangents *t) {
  float inverse_z = (float)s->inverse_z, area = t->ux * t->vy - t->uy * t->vx;
  s->footprint->plane_dx = finite_or(-inverse_z * (t->uz * t->vy - t->uy * t->vz) / area, 0.0f);
  s->footprint->plane_dy = finite_or(-inverse_z * (t->ux * t->vz - t->vx * t->uz) / area, 0.0f);
}

/* In double, for what float cannot hold. */
static conic_outcome project_by_ray(const splat_setup *s) {
  conic_disc disc = conic_disc_of(s->view, s->splats, s->i);
  return conic_project_ray(s->view, &disc, s->footprint, s->box, s->ray);
}

/* The pixel that a place on the screen is in, and the fraction. One that is off the screen by more than 1e9 has lost
 * its fraction anyway. */
static void set_reference(double x, double y, conic_footprint *footprint) {
  x = x > -1e9 ? x < 1e9 ? x : 1e9 : -1e9;
  y = y > -1e9 ? y < 1e9 ? y : 1e9 : -1e9;
  footprint->x = (float)(int32_t)x;
  footprint->y = (float)(int32_t)y;
  footprint->dx0 = (float)(((double)footprint->x + 0.5) - x);
  footprint->dy0 = (float)(((double)footprint->y + 0.5) - y);
}

/* A ray's limits: its box, and what its disc reaches, with a hair more, since across the line of sight that is narrower
 * than a rounding. */
static void set_limits(const conic_view *view, const conic_footprint *footprint, const conic_box *box, conic_ray *ray) {
  const float hair = 0x1p-20f;
  float slope = sqrtf(footprint->plane_dx * footprint->plane_dx + footprint->plane_dy * footprint->plane_dy);
  float widening = slope * view->growth_px, highest = (float)(1.0 / view->near_z);
  float high = footprint->iz_near + widening;
  float low = (footprint->iz_far - widening) - hair * footprint->iz_far;
  ray->iz_high = (high < highest ? high : highest) + hair * footprint->iz_near;
  ray->iz_low = low > 0.0f ? low : 0.0f;
  ray->dx_low = ((float)box->x_begin - footprint->x) + footprint->dx0;
  ray->dx_high = ((float)(box->x_end - 1) - footprint->x) + footprint->dx0;
  ray->dy_low = ((float)box->y_begin - footprint->y) + footprint->dy0;
  ray->dy_high = ((float)(box->y_end - 1) - footprint->y) + footprint->dy0;
}

/* Whether the perspective changes within one pixel's filter: |g|·√h·p_z above `auto`'s limit. */
static int is_steep(const conic_view *view, const tangents *t) {
  float limit = CONIC_AUTO_CHANGE * CONIC_AUTO_CHANGE, area = t->ux * t->vy - t->uy * t->vx;
  float nx = t->uz * t->vy - t->uy * t->vz, ny = t->ux * t->vz - t->vx * t->uz;
  return view->prefilter * (nx * nx + ny * ny) > limit * (area * area);
}

/* h·V⁻¹ of the Jacobian at p, for raster/project/laplace.h. */
static void set_laplace(const conic_view *view, const tangents *t, conic_footprint *footprint, conic_ray *ray) {
  float h = view->prefilter, area = t->ux * t->vy - t->uy * t->vx;
  float rxx = t->ux * t->ux + t->vx * t->vx, rxy = t->ux * t->uy + t->vx * t->vy, ryy = t->uy * t->uy + t->vy * t->vy;
  float scale = h / ((area * area + h * (rxx + ryy)) + h * h);
  footprint->s2 = 1.0f;
  ray->pull_xx = scale * (ryy + h);
  ray->pull_xy = -(scale * rxy);
  ray->pull_yy = scale * (rxx + h);
}

/* About the projected p, U, V and iz are made of what shearing to it gave: no cancellation, so that float will do
 * (docs/reference/picture.md). The box is the projected outline's, widened. */
static conic_outcome project_ray_before_near(splat_setup *s, const tangents *t, const projected_kernel *k) {
  const conic_view *view = s->view;
  conic_footprint *footprint = s->footprint;
  conic_ray *ray = s->ray;
  double x_p = view->cx + view->fx * (s->p[0] * s->inverse_z);
  double y_p = view->cy + view->fy * (s->p[1] * s->inverse_z);
  float half_x = view->cutoff * sqrtf(k->rxx) + view->growth_px;
  float half_y = view->cutoff * sqrtf(k->ryy) + view->growth_px;
  pixel_range(x_p + (double)k->shift_x, (double)half_x, view->width, &s->box->x_begin, &s->box->x_end);
  pixel_range(y_p + (double)k->shift_y, (double)half_y, view->height, &s->box->y_begin, &s->box->y_end);
  set_extent(s, half_x, half_y, k->shift_x, k->shift_y);
  if (conic_box_is_empty(s->box))
    return CONIC_CULLED;
  set_reference(x_p, y_p, footprint);
  set_depth(s, k, 1.0f, 1.0f, 1.0f);
  set_slope(s, t);
  float inverse_z = (float)s->inverse_z, scale = inverse_z / (t->ux * t->vy - t->uy * t->vx);
  footprint->s2 = footprint->s3 = 0.0f;
  footprint->iz0 = inverse_z;
  footprint->iz_dx = footprint->plane_dx;
  footprint->iz_dy = footprint->plane_dy;
  ray->u0 = ray->v0 = 0.0f;
  ray->u_dx = scale * t->vy;
  ray->u_dy = -(scale * t->vx);
  ray->v_dx = -(scale * t->uy);
  ray->v_dy = scale * t->ux;
  set_limits(view, footprint, s->box, ray);
  if (view->method == CONIC_METHOD_AUTO && is_steep(view, t))
    set_laplace(view, t, footprint, ray);
  return CONIC_DRAWN_RAY;
}

/* Of a box in which the pixel's own q decides. */
static double a_hair_more(float half_width) {
  return (double)half_width * 1.0001 + 0.01;
}

static conic_outcome project_variance(splat_setup *s, const tangents *t, const projected_kernel *k) {
  const conic_view *view = s->view;
  conic_footprint *footprint = s->footprint;
  conic_box *box = s->box;
  float h = view->prefilter;
  float vxx = k->rxx + h, vyy = k->ryy + h;
  float determinant = (k->root_determinant * k->root_determinant + h * (k->rxx + k->ryy)) + h * h;
  if (!(determinant > 0.0f))
    return CONIC_SKIPPED;
  if (!(determinant * 0.0f == 0.0f)) /* wider than float can square: in double, where both formulas agree */
    return project_by_ray(s);
  double x_t = (view->cx + view->fx * (s->p[0] * s->inverse_z)) + (double)k->shift_x;
  double y_t = (view->cy + view->fy * (s->p[1] * s->inverse_z)) + (double)k->shift_y;
  float half_x = view->cutoff * sqrtf(vxx), half_y = view->cutoff * sqrtf(vyy);
  pixel_range(x_t, a_hair_more(half_x), view->width, &box->x_begin, &box->x_end);
  pixel_range(y_t, a_hair_more(half_y), view->height, &box->y_begin, &box->y_end);
  set_extent(s, half_x, half_y, k->shift_x, k->shift_y);
  if (conic_box_is_empty(box))
    return CONIC_CULLED;
  set_reference(x_t, y_t, footprint);
  footprint->s1 = sqrtf(vyy / determinant);
  footprint->s2 = -(k->rxy / vyy) * footprint->s1;
  footprint->s3 = 1.0f / sqrtf(vyy);
  footprint->amplitude = k->root_determinant / sqrtf(determinant);
  set_depth(s, k, vxx, vyy, determinant);
  footprint->plane_dx = footprint->plane_dy = 0.0f;
  if (view->needs_slope)
    set_slope(s, t);
  return CONIC_DRAWN_VARIANCE;
}

/* Methods `disc` and `point`: a circle about the projected p, without tilt or depth of its own; or the pixel that holds
 * p, which is the circle that just fits into it. */
static conic_outcome project_dot(splat_setup *s, const float tu[3], const float tv[3]) {
  const conic_view *view = s->view;
  conic_footprint *footprint = s->footprint;
  int is_point = view->method == CONIC_METHOD_POINT;
  float inverse_z = (float)s->inverse_z;
  float u_length = sqrtf((tu[0] * tu[0] + tu[1] * tu[1]) + tu[2] * tu[2]);
  float v_length = sqrtf((tv[0] * tv[0] + tv[1] * tv[1]) + tv[2] * tv[2]);
  float radius = view->cutoff * ((u_length > v_length ? u_length : v_length) * (view->focal_px * inverse_z));
  radius = is_point ? 0.5f : radius > 0.5f ? radius : 0.5f;
  double x_p = view->cx + view->fx * (s->p[0] * s->inverse_z);
  double y_p = view->cy + view->fy * (s->p[1] * s->inverse_z);
  double reach = is_point ? 0.5 : a_hair_more(radius);
  pixel_range(x_p, reach, view->width, &s->box->x_begin, &s->box->x_end);
  pixel_range(y_p, reach, view->height, &s->box->y_begin, &s->box->y_end);
  set_extent(s, radius, radius, 0.0f, 0.0f);
  if (conic_box_is_empty(s->box))
    return CONIC_CULLED;
  set_reference(x_p, y_p, footprint);
  if (is_point)
    footprint->dx0 = footprint->dy0 = 0.0f;
  footprint->s1 = footprint->s3 = view->cutoff / radius;
  if (!(footprint->s3 > 0.0f)) /* 0 would mean a ray */
    return CONIC_SKIPPED;
  footprint->iz0 = footprint->iz_far = footprint->iz_near = inverse_z;
  footprint->s2 = footprint->iz_dx = footprint->iz_dy = footprint->plane_dx = footprint->plane_dy = 0.0f;
  return CONIC_DRAWN_DOT;
}

/* Wholly before near: the usual path, in float. */
static conic_outcome project_before_near(splat_setup *s, const float tu[3], const float tv[3]) {
  const conic_view *view = s->view;
  float inverse_z = (float)s->inverse_z, fx = (float)view->fx, fy = (float)view->fy;
  float x = (float)(s->p[0] * s->inverse_z), y = (float)(s->p[1] * s->inverse_z);
  tangents t;
  t.uz = tu[2] * inverse_z;
  t.vz = tv[2] * inverse_z;
  t.ux = fx * (tu[0] * inverse_z - x * t.uz);
  t.uy = fy * (tu[1] * inverse_z - y * t.uz);
  t.vx = fx * (tv[0] * inverse_z - x * t.vz);
  t.vy = fy * (tv[1] * inverse_z - y * t.vz);
  s->along_ray = t.ux * t.vy - t.uy * t.vx;
  if (view->cull_back && s->along_ray > 0.0f)
    return CONIC_CULLED;
  if (conic_method_is_dot(view->method))
    return project_dot(s, tu, tv);
  if (view->method == CONIC_METHOD_AFFINE) {
    projected_kernel affine = jacobian_at_center(&t);
    return project_variance(s, &t, &affine);
  }
  projected_kernel k = dual_conic(&t, view->cutoff, s->nearest * s->farthest);
  if (wants_ray(s, &k))
    return project_ray_before_near(s, &t, &k);
  return project_variance(s, &t, &k);
}

static conic_outcome project_across_near(splat_setup *s) {
  conic_disc disc = conic_disc_of(s->view, s->splats, s->i);
  s->along_ray = disc.determinant > 0.0 ? 1.0f : disc.determinant < 0.0 ? -1.0f : 0.0f;
  if (s->view->cull_back && disc.determinant > 0.0)
    return CONIC_CULLED;
  return conic_project_near(s->view, &disc, s->footprint, s->box, s->ray);
}

/* The unit normal in the world, and the length of the longer axis. 0 where there is no normal. */
static int world_normal(const conic_splats *splats, size_t i, float normal[3], float *longer) {
  float ux = splats->tangent_u[0][i], uy = splats->tangent_u[1][i], uz = splats->tangent_u[2][i];
  float vx = splats->tangent_v[0][i], vy = splats->tangent_v[1][i], vz = splats->tangent_v[2][i];
  float uu = (ux * ux + uy * uy) + uz * uz, vv = (vx * vx + vy * vy) + vz * vz;
  float u_length = sqrtf(uu), v_length = sqrtf(vv);
  *longer = u_length > v_length ? u_length : v_length;
  /* Unit axes first: the product of small axes would underflow. */
  float u_scale = 1.0f / u_length, v_scale = 1.0f / v_length;
  ux *= u_scale, uy *= u_scale, uz *= u_scale;
  vx *= v_scale, vy *= v_scale, vz *= v_scale;
  float nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  float scale = 1.0f / sqrtf((nx * nx + ny * ny) + nz * nz);
  normal[0] = nx * scale;
  normal[1] = ny * scale;
  normal[2] = nz * scale;
  return (normal[0] + normal[1] + normal[2]) * 0.0f == 0.0f; /* zero and infinite axes end as NaN */
}

static void set_surface(const splat_setup *s, const float normal[3]) {
  const conic_splats *splats = s->splats;
  conic_projected_surface *surface = s->surface;
  float sign = s->along_ray > 0.0f ? -1.0f : 1.0f;
  for (int axis = 0; axis < 3; axis++) {
    surface->normal[axis] = sign * normal[axis];
    surface->color[axis] = splats->color[axis] ? splats->color[axis][s->i] : 1.0f;
  }
  surface->index = (uint32_t)s->i;
  surface->amplitude = s->footprint->amplitude;
}

/* Whether the distance along the rays may differ from that of p by more than one factor allows, over what the splat
 * covers: by the disc's own depth, by the plane's where the prefilter widens it, and by the rays' length. */
static int is_wide(const splat_setup *s) {
  const conic_view *view = s->view;
  const conic_footprint *footprint = s->footprint;
  float x = fabsf((float)(s->p[0] * s->inverse_z)), y = fabsf((float)(s->p[1] * s->inverse_z));
  float slope = sqrtf(footprint->plane_dx * footprint->plane_dx + footprint->plane_dy * footprint->plane_dy);
  float across_x = s->extent_px[0] * (1.0f / (float)view->fx), across_y = s->extent_px[1] * (1.0f / (float)view->fy);
  float change = (s->reach + slope * view->growth_px * (float)s->p[2]) +
                 ((x * across_x + y * across_y) + 0.5f * (across_x * across_x + across_y * across_y));
  return !(change <= CONIC_NARROW_CHANGE) || conic_is_laplace(footprint);
}

/* The prefilter lowers the weights of the splats that it widens. Takes that back; for a ray as much as at its centre.
 */
static void slip_amplitude(const splat_setup *s, const float tu[3], const float tv[3], conic_outcome outcome) {
  const conic_view *view = s->view;
  const double h = (double)view->prefilter, iz = s->inverse_z, focal[2] = {view->fx, view->fy};
  double u[2], v[2];
  if (outcome == CONIC_DRAWN_VARIANCE)
    s->footprint->amplitude = 1.0f;
  if (outcome != CONIC_DRAWN_RAY)
    return;
  for (int axis = 0; axis < 2; axis++) {
    u[axis] = focal[axis] * iz * ((double)tu[axis] - s->p[axis] * iz * (double)tu[2]);
    v[axis] = focal[axis] * iz * ((double)tv[axis] - s->p[axis] * iz * (double)tv[2]);
  }
  double area = u[0] * v[1] - u[1] * v[0], square = area * area;
  if (square > 0.0)
    s->footprint->amplitude =
        (float)sqrt((square + h * (u[0] * u[0] + u[1] * u[1] + v[0] * v[0] + v[1] * v[1]) + h * h) / square);
}

/* ε-offset along the ray, and the opacity. */
static void set_weighing(const splat_setup *s, float longer) {
  const conic_view *view = s->view;
  s->footprint->nearness = 0.0f;
  if (view->needs_nearness) {
    float epsilon = view->epsilon_scale * (view->cutoff * longer);
    epsilon = epsilon < view->epsilon_cap ? epsilon : view->epsilon_cap;
    float distance = (float)sqrt((s->p[0] * s->p[0] + s->p[1] * s->p[1]) + s->p[2] * s->p[2]);
    s->footprint->nearness = distance > 0.0f ? 1.0f / (1.0f + epsilon / distance) : 0.0f;
    if (epsilon > 0.0f && epsilon < HUGE_VALF && is_wide(s))
      s->footprint->nearness = -epsilon;
    if (view->slips & CONIC_SLIP_EPSILON && epsilon > 0.0f && epsilon < HUGE_VALF && s->p[2] > 0.0)
      s->footprint->nearness = -epsilon * (distance / (float)s->p[2]); /* rays are about as long as the centre's */
  }
  if (s->splats->opacity)
    s->footprint->amplitude *= s->splats->opacity[s->i];
}

/* Opacity and colour within what the sums of a pixel can hold. */
static int is_in_range(const conic_splats *splats, size_t i) {
  if (splats->opacity && !(splats->opacity[i] <= CONIC_GREATEST_OPACITY))
    return 0;
  for (int axis = 0; axis < 3; axis++)
    if (splats->color[axis] && !(fabsf(splats->color[axis][i]) <= CONIC_GREATEST_COLOR))
      return 0;
  return 1;
}

/* Sums of x·0: NaN as soon as one of the record's fields is not finite. */
static int is_finite_record(const conic_footprint *footprint, const conic_ray *ray,
                            const conic_projected_surface *surface) {
  float sum = (footprint->dx0 + footprint->dy0) * 0.0f;
  if (footprint->s3 != 0.0f)
    sum += footprint->s1 * 0.0f + footprint->s2 * 0.0f + footprint->s3 * 0.0f;
  else
    sum += (ray->u0 * 0.0f + ray->u_dx * 0.0f + ray->u_dy * 0.0f) + (ray->v0 * 0.0f + ray->v_dx * 0.0f) +
           (ray->v_dy * 0.0f + ray->iz_low * 0.0f + ray->iz_high * 0.0f);
  sum += footprint->iz0 * 0.0f + footprint->iz_dx * 0.0f + footprint->iz_dy * 0.0f;
  sum += footprint->iz_far * 0.0f + footprint->iz_near * 0.0f;
  sum += footprint->nearness * 0.0f + footprint->amplitude * 0.0f;
  for (int axis = 0; axis < 3; axis++)
    sum += surface->color[axis] * 0.0f + surface->normal[axis] * 0.0f;
  return sum == 0.0f;
}

static conic_outcome project_splat(splat_setup *s) {
  const conic_view *view = s->view;
  float tu[3], tv[3], normal[3], longer;
  move_center(view, s->splats, s->i, s->p);
  rotate(view->rotation_float, (const float *const *)s->splats->tangent_u, s->i, tu);
  rotate(view->rotation_float, (const float *const *)s->splats->tangent_v, s->i, tv);
  float reach_z = view->cutoff * sqrtf(tu[2] * tu[2] + tv[2] * tv[2]);
  if (!((s->p[0] + s->p[1] + s->p[2] + (double)reach_z) * 0.0 == 0.0))
    return CONIC_SKIPPED;
  if (!(s->p[2] + (double)reach_z > view->near_z))
    return CONIC_CULLED;
  conic_outcome outcome;
  s->footprint->amplitude = 1.0f;
  s->extent_px[0] = s->extent_px[1] = HUGE_VALF;
  s->inverse_z = 1.0 / s->p[2];
  s->reach = (float)((double)reach_z * s->inverse_z);
  s->nearest = (float)((s->p[2] - (double)reach_z) * s->inverse_z);
  s->farthest = (float)((s->p[2] + (double)reach_z) * s->inverse_z);
  if (s->p[2] - (double)reach_z > view->near_z)
    outcome = project_before_near(s, tu, tv);
  else
    outcome = project_across_near(s);
  if (outcome >= CONIC_CULLED)
    return outcome;
  if (!world_normal(s->splats, s->i, normal, &longer) || !is_in_range(s->splats, s->i))
    return CONIC_SKIPPED;
  if (view->slips & CONIC_SLIP_AMPLITUDE)
    slip_amplitude(s, tu, tv, outcome);
  if (outcome == CONIC_DRAWN_SEGMENT)
    s->footprint->amplitude = 0.0f;
  set_weighing(s, longer);
  set_surface(s, normal);
  return is_finite_record(s->footprint, s->ray, s->surface) ? outcome : CONIC_SKIPPED;
}

/* Whether a splat that is drawn is not by its method's own formula. */
static int is_fallback(conic_method method, conic_outcome outcome) {
  return outcome == CONIC_DRAWN_RAY ? !conic_method_has_rays(method)
                                    : outcome == CONIC_DRAWN_SEGMENT || !conic_method_has_ellipses(method);
}

void conic_project_one(const conic_view *view, const conic_splats *splats, size_t i, conic_projected *projected,
                       conic_chunk *chunk) {
  splat_setup s = {.view = view, .splats = splats, .i = i};
  s.footprint = &projected->footprints[chunk->first + chunk->n_drawn];
  s.box = &projected->boxes[chunk->first + chunk->n_drawn];
  s.surface = &projected->surfaces[chunk->first + chunk->n_drawn];
  s.ray = &projected->rays[chunk->first_ray + chunk->n_rays];
  conic_outcome outcome = project_splat(&s);
  if (outcome == CONIC_CULLED) {
    chunk->n_culled++;
  } else if (outcome == CONIC_SKIPPED) {
    chunk->n_skipped++;
  } else {
    chunk->n_laplaces += (size_t)conic_is_laplace(s.footprint);
    if (outcome == CONIC_DRAWN_RAY)
      s.footprint->i_ray = (uint32_t)(chunk->first_ray + chunk->n_rays++);
    chunk->n_fallback += (size_t)is_fallback(view->method, outcome);
    chunk->n_drawn++;
  }
}

void conic_project_range(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                         conic_projected *projected, conic_chunk *chunk) {
  for (size_t i = begin; i < end; i++)
    if (!projected->band || projected->bands[i] & projected->band)
      conic_project_one(view, splats, i, projected, chunk);
}

void conic_project_chunk(const conic_view *view, const conic_splats *splats, size_t i_chunk,
                         conic_projected *projected) {
  size_t n = splats->count, begin = i_chunk * projected->chunk_size, end = begin + projected->chunk_size;
  begin = begin < n ? begin : n;
  conic_chunk *chunk = &projected->chunks[i_chunk];
  *chunk = (conic_chunk){.first = begin, .first_ray = begin};
  conic_project_range(view, splats, begin, end < n ? end : n, projected, chunk);
}
