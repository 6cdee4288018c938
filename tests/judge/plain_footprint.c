/* The profiles of other programs, and what they make of a Gaussian before any pixel is looked at. */
#include "tests/judge/plain_footprint.h"

#include <string.h>

#define THIRD_OF_A_PIXEL 0.3f
#define LEAST_ALPHA (1.0f / 255.0f)
#define AS_GSPLAT .near = 0.01f, .least_alpha = LEAST_ALPHA, .stop = 1e-4f, .stops_at = 1
#define AS_INRIA .near = 0.2f, .most_alpha = 0.99f, .least_alpha = LEAST_ALPHA, .stop = 1e-4f, .is_inria = 1

static const plain_profile plain_profiles[] = {
    {.name = "inria-2023", AS_INRIA, .dilation = THIRD_OF_A_PIXEL, .least_compensation = -1.0f},
    {.name = "gsplat-1.5",
     AS_GSPLAT,
     .near_is_in = 1,
     .most_alpha = 0.999f,
     .dilation = THIRD_OF_A_PIXEL,
     .least_compensation = -1.0f},
    {.name = "gsplat-1.5-aa",
     AS_GSPLAT,
     .near_is_in = 1,
     .most_alpha = 0.999f,
     .dilation = THIRD_OF_A_PIXEL,
     .least_compensation = 0.0f},
    {.name = "gsplat-1.6",
     AS_GSPLAT,
     .near_is_in = 1,
     .most_alpha = 0.99f,
     .dilation = THIRD_OF_A_PIXEL,
     .least_compensation = -1.0f},
    {.name = "gsplat-1.6-aa",
     AS_GSPLAT,
     .near_is_in = 1,
     .most_alpha = 0.99f,
     .dilation = THIRD_OF_A_PIXEL,
     .least_compensation = 2.5e-5f},
    {.name = "exact", .is_ray = 1, .near = -INFINITY, .most_alpha = 0.99f, .least_alpha = LEAST_ALPHA, .stop = 1e-4f},
    {.name = "khr-2026", .most_alpha = 1.0f, .least_compensation = -1.0f, .cutoff = 9.0f, .is_by_distance = 1},
    {.name = "2dgs-2024", AS_INRIA, .is_disc = 1, .disc_cutoff = 3.0f, .disc_near = 0.2f},
    {.name = "2dgs-gsplat", AS_GSPLAT, .most_alpha = 0.99f, .is_disc = 1, .disc_cutoff = 1.0f},
};

const plain_profile *plain_profile_find(const char *name) {
  for (size_t k = 0; k < sizeof plain_profiles / sizeof *plain_profiles; k++)
    if (strcmp(plain_profiles[k].name, name) == 0)
      return &plain_profiles[k];
  return NULL;
}

static void plain_spoil_profile(unsigned faults, plain_profile *p) {
  if (plain_has(faults, PLAIN_DILATION_0))
    p->dilation = 0.0f;
  if (plain_has(faults, PLAIN_DILATION_0_1))
    p->dilation = 0.1f;
  if (plain_has(faults, PLAIN_ALPHA_MAX_0_999))
    p->most_alpha = 0.999f;
  if (plain_has(faults, PLAIN_ALPHA_MAX_0_99))
    p->most_alpha = 0.99f;
  if (plain_has(faults, PLAIN_ORDER_DISTANCE))
    p->is_by_distance = 1;
  if (plain_has(faults, PLAIN_NEAR))
    p->near = faults & PLAIN_OTHERWISE ? 1.0f : p->near < 0.1f ? 0.2f : 0.01f;
  if (plain_has(faults, PLAIN_EXTENT_3_SIGMA) && (p->is_disc || p->is_ray || !(faults & PLAIN_OTHERWISE)))
    p->cutoff = 9.0f;
}

plain_frame plain_look(const plain_scene *scene, const plain_camera *camera, const plain_settings *settings) {
  plain_frame v = {scene, camera, settings, settings->floats, *settings->profile, {camera->cx, camera->cy}, {0.0f}};
  plain_spoil_profile(settings->faults, &v.profile);
  if (v.profile.is_inria || plain_has(settings->faults, PLAIN_CENTRE_IGNORED)) {
    v.center[0] = 0.5f * (float)camera->width;
    v.center[1] = 0.5f * (float)camera->height;
  }
  for (int axis = 0; axis < 3; axis++) { /* −Wᵀt */
    const float column[3] = {camera->view[0][axis], camera->view[1][axis], camera->view[2][axis]};
    const float back[3] = {-camera->view[0][3], -camera->view[1][3], -camera->view[2][3]};
    v.eye[axis] = plain_dot(&v.floats, column, back);
  }
  return v;
}

/* The matrix of a quaternion w, x, y, z. */
static void plain_rotation(plain_frame *v, const float *given, float r[3][3]) {
  plain_floats *f = &v->floats;
  const float square = plain_mad(f, given[3], given[3], plain_dot(f, given, given));
  float q[4], two = 2.0f;
  for (int k = 0; k < 4; k++) {
    q[k] = given[k];
    if (plain_has(v->settings->faults, PLAIN_QUATERNION_NOT_NORMALISED))
      continue;
    if (v->settings->manner.normalises_rotation == 0)
      q[k] = plain_divide(f, q[k], plain_root(f, square));
    if (v->settings->manner.normalises_rotation == 1)
      q[k] *= plain_inverse_root(f, square);
    if (v->settings->manner.normalises_rotation == 2)
      two = plain_divide(f, 2.0f, square);
  }
  const float w = q[0], x = q[1], y = q[2], z = q[3];
  r[0][0] = 1.0f - two * plain_mad(f, y, y, z * z);
  r[1][1] = 1.0f - two * plain_mad(f, x, x, z * z);
  r[2][2] = 1.0f - two * plain_mad(f, x, x, y * y);
  r[0][1] = two * plain_mad(f, x, y, -(w * z));
  r[0][2] = two * plain_mad(f, x, z, w * y);
  r[1][0] = two * plain_mad(f, x, y, w * z);
  r[1][2] = two * plain_mad(f, y, z, -(w * x));
  r[2][0] = two * plain_mad(f, x, z, -(w * y));
  r[2][1] = two * plain_mad(f, y, z, w * x);
}

/* a·b, or a·bᵀ */
static void plain_multiply(plain_floats *f, int n_rows, const float a[][3], const float b[][3], int n_columns,
                           int is_transposed, float product[][3]) {
  for (int i = 0; i < n_rows; i++)
    for (int j = 0; j < n_columns; j++) {
      const float column[3] = {is_transposed ? b[j][0] : b[0][j], is_transposed ? b[j][1] : b[1][j],
                               is_transposed ? b[j][2] : b[2][j]};
      product[i][j] = plain_dot(f, a[i], column);
    }
}

/* The harmonics' polynomials of 3D Gaussian splatting, of a direction of unit length. */
static int plain_harmonics(int degree, const float d[3], float y[16]) {
  const float x = d[0], v = d[1], z = d[2], xx = x * x, yy = v * v, zz = z * z;
  y[0] = 0.28209479177387814f;
  y[1] = -0.4886025119029199f * v;
  y[2] = 0.4886025119029199f * z;
  y[3] = -0.4886025119029199f * x;
  y[4] = 1.0925484305920792f * (x * v);
  y[5] = -1.0925484305920792f * (v * z);
  y[6] = 0.31539156525252005f * (2.0f * zz - xx - yy);
  y[7] = -1.0925484305920792f * (x * z);
  y[8] = 0.5462742152960396f * (xx - yy);
  y[9] = -0.5900435899266435f * v * (3.0f * xx - yy);
  y[10] = 2.890611442640554f * (x * v) * z;
  y[11] = -0.4570457994644658f * v * (4.0f * zz - xx - yy);
  y[12] = 0.3731763325901154f * z * (2.0f * zz - 3.0f * xx - 3.0f * yy);
  y[13] = -0.4570457994644658f * x * (4.0f * zz - xx - yy);
  y[14] = 1.445305721320277f * z * (xx - yy);
  y[15] = -0.5900435899266435f * x * (xx - 3.0f * yy);
  return degree >= 3 ? 16 : (degree + 1) * (degree + 1);
}

static void plain_color(plain_frame *v, size_t i, float color[3]) {
  plain_floats *f = &v->floats;
  const plain_scene *s = v->scene;
  const size_t stored = (size_t)((s->sh_degree + 1) * (s->sh_degree + 1));
  float d[3], y[16];
  for (size_t k = 0; k < 3; k++)
    d[k] = s->mean[3 * i + k] - v->eye[k];
  const float square = plain_dot(f, d, d);
  const float shrink = v->settings->manner.normalises_rotation ? plain_inverse_root(f, square)
                                                               : plain_divide(f, 1.0f, plain_root(f, square));
  for (int k = 0; k < 3; k++)
    d[k] *= shrink;
  int n = plain_harmonics(plain_has(v->settings->faults, PLAIN_SH_DEGREE_0) ? 0 : s->sh_degree, d, y);
  for (size_t c = 0; c < 3; c++) {
    float sum = 0.0f;
    for (size_t k = 0; k < (size_t)n; k++)
      sum = plain_mad(f, y[k], s->sh[(i * stored + k) * 3 + c], sum);
    color[c] = fmaxf(sum + 0.5f, 0.0f);
  }
}

/* The Jacobian of the projection at a place whose slopes are clamped, since it is of no use far beside the picture. */
static void plain_jacobian(plain_frame *v, const float p[3], float jacobian[2][3]) {
  plain_floats *f = &v->floats;
  const float focal[2] = {v->camera->fx, v->camera->fy};
  const float size[2] = {(float)v->camera->width, (float)v->camera->height};
  const float over_z = plain_divide(f, 1.0f, p[2]);
  memset(jacobian, 0, 6 * sizeof(float));
  for (int axis = 0; axis < 2; axis++) {
    const float half = plain_divide(f, 0.5f * size[axis], focal[axis]);
    float slope = plain_divide(f, p[axis], p[2]), low = -1.3f * half, high = 1.3f * half;
    if (!v->profile.is_inria) {
      low = -plain_mad(f, 0.3f, half, plain_divide(f, v->center[axis], focal[axis]));
      high = plain_mad(f, 0.3f, half, plain_divide(f, size[axis] - v->center[axis], focal[axis]));
    }
    if (v->settings->profile->dilation > 0.0f)
      slope = plain_clamp(slope, low, high);
    jacobian[axis][axis] = focal[axis] * over_z;
    jacobian[axis][2] = -plain_product(f, focal[axis], slope * p[2], over_z * over_z);
  }
}

/* The covariance on the screen: xx, xy, yy. */
static void plain_project_covariance(plain_frame *v, const float r[3][3], const float scale[3],
                                     const float jacobian[2][3], float covariance[3]) {
  plain_floats *f = &v->floats;
  float view[3][3], rs[3][3], sigma[3][3], turned[3][3], half[3][3], screen[2][3];
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 3; k++) {
      view[row][k] = v->camera->view[row][k];
      rs[row][k] = r[row][k] * scale[k];
    }
  plain_multiply(f, 3, rs, rs, 3, 1, sigma);
  switch (v->settings->manner.projects_covariance) {
  case 0:
    plain_multiply(f, 3, view, sigma, 3, 0, half);
    plain_multiply(f, 3, half, view, 3, 1, turned);
    plain_multiply(f, 2, jacobian, turned, 3, 0, half);
    plain_multiply(f, 2, half, jacobian, 2, 1, screen);
    break;
  case 1:
    plain_multiply(f, 2, jacobian, view, 3, 0, turned);
    plain_multiply(f, 2, turned, sigma, 3, 0, half);
    plain_multiply(f, 2, half, turned, 2, 1, screen);
    break;
  default:
    plain_multiply(f, 3, view, rs, 3, 0, half);
    plain_multiply(f, 2, jacobian, half, 3, 0, turned);
    plain_multiply(f, 2, turned, turned, 2, 1, screen);
  }
  covariance[0] = screen[0][0];
  covariance[1] = plain_chance(f, 2) && f->is_shuffled ? screen[1][0] : screen[0][1];
  covariance[2] = screen[1][1];
}

/* The greatest q at which α is not below its least, and some more. */
static float plain_reach(const plain_frame *v, float opacity) {
  if (v->profile.cutoff > 0.0f)
    return v->profile.cutoff * 1.01f;
  return 2.0f * logf(fmaxf(opacity / LEAST_ALPHA, 1.0f)) * 1.01f + 0.1f;
}

static int plain_place_ellipse(plain_frame *v, const float r[3][3], const float scale[3], const float p[3],
                               plain_footprint *g) {
  plain_floats *f = &v->floats;
  const float h = v->profile.dilation, over_z = plain_divide(f, 1.0f, p[2]), focal[2] = {v->camera->fx, v->camera->fy};
  float jacobian[2][3], c[3];
  plain_jacobian(v, p, jacobian);
  plain_project_covariance(v, r, scale, jacobian, c);
  for (int axis = 0; axis < 2; axis++) {
    if (v->profile.is_inria) { /* by way of normalised device coordinates */
      const float size = axis ? (float)v->camera->height : (float)v->camera->width;
      const float clip = plain_divide(f, p[axis], plain_divide(f, 0.5f * size, focal[axis]));
      const float ndc = clip * plain_divide(f, 1.0f, p[2] + 0.0000001f);
      g->place[axis] = ((ndc + 1.0f) * size - 1.0f) * 0.5f + 0.5f;
    } else
      g->place[axis] = plain_mad(f, focal[axis], p[axis] * over_z, v->center[axis]);
  }
  const float bare = plain_mad(f, c[0], c[2], -(c[1] * c[1]));
  c[0] += h;
  c[2] += h;
  const float det = plain_mad(f, c[0], c[2], -(c[1] * c[1]));
  if (!(det > 0.0f))
    return 0;
  if (v->profile.least_compensation >= 0.0f)
    g->opacity *= plain_root(f, fmaxf(plain_divide(f, bare, det), v->profile.least_compensation));
  const float over_det = plain_divide(f, 1.0f, det);
  for (int k = 0; k < 3; k++) {
    const float entry = k == 1 ? -c[1] : c[2 - k];
    g->form[k] = v->settings->manner.divides_form ? plain_divide(f, entry, det) : entry * over_det;
  }
  const float mean = 0.5f * (c[0] + c[2]);
  const float greatest = mean + plain_root(f, fmaxf(0.1f, plain_mad(f, mean, mean, -det)));
  g->radius = ceilf(3.0f * plain_root(f, greatest));
  const float q = plain_reach(v, g->opacity);
  for (int axis = 0; axis < 2; axis++) {
    const float half = sqrtf(q * c[2 * axis]) + 2.0f;
    g->reach[0][axis] = g->place[axis] - half;
    g->reach[1][axis] = g->place[axis] + half;
  }
  return 1;
}

/* Where the pixels of a disc of so many standard deviations lie: the middle of its box, and half its size. */
static int plain_disc_box(plain_frame *v, const plain_footprint *g, float cutoff, float middle[2], float half[2]) {
  plain_floats *f = &v->floats;
  const float signs[3] = {cutoff * cutoff, cutoff * cutoff, -1.0f};
  const float squares[3] = {g->rows[2][0] * g->rows[2][0], g->rows[2][1] * g->rows[2][1],
                            g->rows[2][2] * g->rows[2][2]};
  const float distance = plain_dot(f, signs, squares);
  float share[3];
  if (distance == 0.0f)
    return 0;
  for (int k = 0; k < 3; k++)
    share[k] = signs[k] * plain_divide(f, 1.0f, distance);
  for (int axis = 0; axis < 2; axis++) {
    float both[3], own[3];
    for (int k = 0; k < 3; k++) {
      both[k] = g->rows[axis][k] * g->rows[2][k];
      own[k] = g->rows[axis][k] * g->rows[axis][k];
    }
    middle[axis] = plain_dot(f, share, both);
    half[axis] = plain_root(f, fmaxf(1e-4f, plain_mad(f, middle[axis], middle[axis], -plain_dot(f, share, own))));
  }
  return distance < 0.0f || cutoff == v->profile.disc_cutoff;
}

static int plain_place_disc(plain_frame *v, const float r[3][3], const float scale[3], const float p[3],
                            plain_footprint *g) {
  plain_floats *f = &v->floats;
  const float focal[2] = {v->camera->fx, v->camera->fy};
  float half[2], middle[2], around[2];
  for (int k = 0; k < 3; k++) {
    float axis[3]; /* in camera space */
    for (int row = 0; row < 3; row++) {
      const float column[3] = {r[0][k] * scale[k], r[1][k] * scale[k], r[2][k] * scale[k]};
      axis[row] = k == 2 ? p[row] : plain_dot(f, v->camera->view[row], column);
    }
    g->rows[0][k] = plain_mad(f, focal[0], axis[0], v->center[0] * axis[2]);
    g->rows[1][k] = plain_mad(f, focal[1], axis[1], v->center[1] * axis[2]);
    g->rows[2][k] = axis[2];
  }
  if (!plain_disc_box(v, g, v->profile.disc_cutoff, g->place, half))
    return 0;
  g->radius = ceilf(fmaxf(fmaxf(half[0], half[1]), 3.0f * 0.707106f));
  const int is_bounded = plain_disc_box(v, g, sqrtf(plain_reach(v, g->opacity)), middle, around);
  for (int axis = 0; axis < 2; axis++) { /* the disc's or the dot's, whichever reaches farther */
    g->reach[0][axis] = is_bounded ? fminf(middle[axis] - around[axis], g->place[axis] - 3.0f) - 2.0f : -INFINITY;
    g->reach[1][axis] = is_bounded ? fmaxf(middle[axis] + around[axis], g->place[axis] + 3.0f) + 2.0f : INFINITY;
  }
  if (v->profile.is_inria)
    return 1;
  for (int axis = 0; axis < 2; axis++) { /* gsplat's box */
    const float size = axis ? (float)v->camera->height : (float)v->camera->width;
    const float reach = ceilf(3.33f * half[axis]), at = g->place[axis];
    if (at + reach <= 0.0f || at - reach >= size)
      return 0;
    g->reach[0][axis] = fmaxf(g->reach[0][axis], floorf((at - reach) / TILE) * TILE);
    g->reach[1][axis] = fminf(g->reach[1][axis], ceilf((at + reach) / TILE) * TILE - 0.5f);
  }
  return 1;
}

/* Into the frame where the Gaussian is a unit ball. Any pixel may see it: this is for small scenes. */
static int plain_place_ball(plain_frame *v, const float r[3][3], const float scale[3], const float p[3],
                            plain_footprint *g) {
  plain_floats *f = &v->floats;
  for (int k = 0; k < 3; k++) {
    const float column[3] = {r[0][k], r[1][k], r[2][k]};
    const float over = plain_divide(f, 1.0f, scale[k]);
    float axis[3];
    for (int row = 0; row < 3; row++)
      axis[row] = plain_dot(f, v->camera->view[row], column);
    for (int row = 0; row < 3; row++)
      g->rows[k][row] = axis[row] * over;
    g->ball[k] = v->settings->manner.divides_form ? plain_divide(f, plain_dot(f, axis, p), scale[k])
                                                  : plain_dot(f, g->rows[k], p);
  }
  for (int axis = 0; axis < 2; axis++) {
    g->reach[0][axis] = -INFINITY;
    g->reach[1][axis] = INFINITY;
  }
  return 1;
}

/* The tiles of the square ±radius, cut off towards zero, as integers. */
static void plain_cut_to_tiles(const plain_frame *v, plain_footprint *g) {
  for (int axis = 0; axis < 2; axis++) {
    const float at = g->place[axis] - 0.5f;
    const int n = ((axis ? v->camera->height : v->camera->width) + TILE - 1) / TILE;
    const float first = plain_clamp((at - g->radius) / TILE, 0.0f, (float)n);
    const float behind = plain_clamp((at + g->radius + TILE - 1) / TILE, 0.0f, (float)n);
    g->reach[0][axis] = fmaxf(g->reach[0][axis], (float)((int)first * TILE));
    g->reach[1][axis] = fminf(g->reach[1][axis], (float)((int)behind * TILE) - 0.5f);
  }
}

int plain_place(plain_frame *v, size_t i, plain_footprint *g) {
  plain_floats *f = &v->floats;
  const plain_scene *s = v->scene;
  const float *scale = s->scale + 3 * i;
  float r[3][3], p[3];
  for (int row = 0; row < 3; row++)
    p[row] = plain_dot_plus(f, v->camera->view[row], s->mean + 3 * i, v->camera->view[row][3]);
  if (v->profile.near_is_in ? p[2] < v->profile.near : p[2] <= v->profile.near)
    return 0;
  *g = (plain_footprint){.index = (uint32_t)i, .z = p[2], .opacity = s->opacity[i]};
  g->key = v->profile.is_by_distance ? plain_root(f, plain_dot(f, p, p)) : p[2];
  plain_rotation(v, s->rotation + 4 * i, r);
  plain_color(v, i, g->color);
  if (!(v->profile.is_ray    ? plain_place_ball(v, r, scale, p, g)
        : v->profile.is_disc ? plain_place_disc(v, r, scale, p, g)
                             : plain_place_ellipse(v, r, scale, p, g)))
    return 0;
  const int is_cut = plain_has(v->settings->faults, PLAIN_EXTENT_3_SIGMA) && !(v->profile.cutoff > 0.0f);
  if (v->profile.is_inria || is_cut)
    plain_cut_to_tiles(v, g);
  return 1;
}
