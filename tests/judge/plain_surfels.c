#include "tests/judge/plain_surfels.h"

#include <string.h>

/* A surfel as pixels need it. */
typedef struct plain_ellipse {
  uint32_t index;
  float place[2], form[3], amplitude, color[3];
  float iz, iz_gradient[2], plane_gradient[2]; /* at the place: the inverse depth and how it grows */
  float iz_plane, iz_range[2];
  float epsilon, distance; /* of the centre from the eye, */
  int is_wide;             /* which will not do for all of it */
  int box[2][2];           /* pixels: first, and behind the last */
} plain_ellipse;

typedef struct plain_stage {
  const plain_camera *camera;
  const plain_surfel_settings *settings;
  plain_floats floats;
  float center[2], near, median;
  int is_affine;
} plain_stage;

static float plain_length(plain_floats *f, const float v[3]) {
  return plain_root(f, plain_dot(f, v, v));
}

/* The tangents of a circle whose normal is known. */
static void plain_span_circle(const float n[3], float sigma, float u[3], float v[3]) {
  const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  const float x = n[0] / length, y = n[1] / length, z = n[2] / length, s = z < 0.0f ? -1.0f : 1.0f;
  const float k = -1.0f / (s + z);
  const float tangents[2][3] = {{1.0f + s * x * x * k, s * x * y * k, -s * x}, {x * y * k, s + y * y * k, -y}};
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = sigma * tangents[0][axis];
    v[axis] = sigma * tangents[1][axis];
  }
}

static float plain_linear_of_code(float code) {
  const float v = code / 255.0f;
  return v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
}

plain_surfels plain_surfels_read(const char *path, float cutoff, unsigned faults) {
  static const char *const names[16] = {"x",     "y",    "z",    "nx",   "ny",   "nz",   "radius", "red",
                                        "green", "blue", "tu_x", "tu_y", "tu_z", "tv_x", "tv_y",   "tv_z"};
  plain_table t = plain_table_read(path);
  plain_surfels s = {.count = t.n_rows};
  int at[16];
  for (int k = 0; k < 16; k++)
    at[k] = plain_table_find(&t, names[k]);
  if (at[0] < 0 || at[7] < 0 || (at[6] < 0 && at[10] < 0))
    plain_give_up(path, "has no surfels");
  float **const arrays[4] = {&s.center, &s.axes[0], &s.axes[1], &s.color};
  for (int k = 0; k < 4; k++)
    if (!(*arrays[k] = calloc(s.count + 1, 3 * sizeof(float))))
      plain_give_up("memory", "there is not enough");
  for (size_t i = 0; i < s.count; i++) {
    const double *row = t.values + i * (size_t)t.n_columns;
    float n[3];
    for (int k = 0; k < 3; k++) {
      s.center[3 * i + (size_t)k] = (float)row[at[k]];
      s.color[3 * i + (size_t)k] = plain_linear_of_code((float)row[at[7 + k]]);
      n[k] = at[3] < 0 ? 0.0f : (float)row[at[3 + k]];
      if (at[10] < 0)
        continue;
      s.axes[0][3 * i + (size_t)k] = (float)row[at[10 + k]];
      s.axes[1][3 * i + (size_t)k] = (float)row[at[13 + k]];
    }
    const float over = plain_has(faults, PLAIN_RADIUS_AS_SIGMA) ? 1.0f : cutoff;
    if (at[10] < 0)
      plain_span_circle(n, (float)row[at[6]] / over, s.axes[0] + 3 * i, s.axes[1] + 3 * i);
  }
  free(t.values);
  return s;
}

void plain_surfels_release(plain_surfels *s) {
  free(s->center);
  free(s->axes[0]);
  free(s->axes[1]);
  free(s->color);
}

static float plain_greater(float a, float b) {
  return a > b ? a : b;
}

static float plain_reach_of_axes(plain_floats *f, const plain_surfels *s, size_t i) {
  return plain_greater(plain_length(f, s->axes[0] + 3 * i), plain_length(f, s->axes[1] + 3 * i));
}

static int plain_compare_floats(const void *a, const void *b) {
  const float *x = a, *y = b;
  return (*x > *y) - (*x < *y);
}

/* The near plane by the box of all centres, and the median of the radii, which caps the tolerance. */
static plain_stage plain_set_stage(const plain_surfels *s, const plain_camera *camera,
                                   const plain_surfel_settings *settings) {
  plain_stage v = {camera, settings, settings->floats, {camera->cx, camera->cy}, 0.0f, 0.0f, settings->is_affine};
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, diagonal[3];
  float *radii = calloc(s->count + 1, sizeof *radii);
  if (!radii)
    plain_give_up("memory", "there is not enough");
  for (size_t i = 0; i < s->count; i++) {
    for (size_t k = 0; k < 3; k++) {
      low[k] = fminf(low[k], s->center[3 * i + k]);
      high[k] = fmaxf(high[k], s->center[3 * i + k]);
    }
    radii[i] = plain_reach_of_axes(&v.floats, s, i);
  }
  qsort(radii, s->count, sizeof *radii, plain_compare_floats);
  v.median = s->count ? radii[(s->count - 1) / 2] : 0.0f;
  free(radii);
  for (int k = 0; k < 3; k++)
    diagonal[k] = high[k] - low[k];
  v.near = 1e-4f * plain_length(&v.floats, diagonal);
  if (plain_has(settings->faults, PLAIN_NEAR))
    v.near *= 1e4f;
  if (plain_has(settings->faults, PLAIN_AFFINE))
    v.is_affine = 1;
  if (plain_has(settings->faults, PLAIN_CENTRE_IGNORED)) {
    v.center[0] = 0.5f * (float)camera->width;
    v.center[1] = 0.5f * (float)camera->height;
  }
  return v;
}

/* The ellipse of a disc on the screen (Perspective Accurate Splatting), or by the Jacobian at its centre. */
static int plain_project_disc(plain_stage *v, const float p[3], float t[2][3], float reach, plain_ellipse *e) {
  plain_floats *f = &v->floats;
  const float F = v->is_affine ? 0.0f : v->settings->cutoff, h = v->settings->prefilter;
  const float focal[2] = {v->camera->fx, v->camera->fy}, iz = plain_divide(f, 1.0f, p[2]);
  const float slope[2] = {p[0] * iz, p[1] * iz};
  float s[2][3]; /* the axes on the screen, and their share of depth */
  for (int k = 0; k < 2; k++) {
    s[k][2] = t[k][2] * iz;
    for (int axis = 0; axis < 2; axis++)
      s[k][axis] = focal[axis] * plain_mad(f, t[k][axis], iz, -(slope[axis] * s[k][2]));
  }
  const float kappa = plain_mad(f, s[0][0], s[1][1], -(s[0][1] * s[1][0]));
  const float slant = v->is_affine ? 0.0f : reach * iz;
  const float W = plain_divide(f, 1.0f, (1.0f - slant) * (1.0f + slant));
  float b[2], variance[3];
  for (int axis = 0; axis < 2; axis++)
    b[axis] = plain_mad(f, s[0][axis], s[0][2], s[1][axis] * s[1][2]);
  for (int k = 0; k < 3; k++) { /* xx, xy, yy */
    const int i = k == 2, j = k > 0;
    variance[k] = plain_mad(f, plain_mad(f, s[0][i], s[0][j], s[1][i] * s[1][j]), W, F * F * W * W * (b[i] * b[j]));
  }
  const float root_of_bare = fabsf(kappa) * (W * sqrtf(W)), bare = root_of_bare * root_of_bare;
  const float det = plain_mad(f, h, variance[0] + variance[2], plain_mad(f, h, h, bare));
  if (!(det > 0.0f))
    return 0;
  e->amplitude = plain_has(v->settings->faults, PLAIN_NO_AMPLITUDE) ? 1.0f : plain_divide(f, root_of_bare, sqrtf(det));
  const float wide[3] = {variance[0] + h, variance[1], variance[2] + h};
  for (int k = 0; k < 3; k++)
    e->form[k] = plain_divide(f, k == 1 ? -wide[1] : wide[2 - k], det);
  const float shift = -F * F * W, step = -iz * W * W;
  for (int axis = 0; axis < 2; axis++) {
    e->place[axis] = plain_mad(f, focal[axis], slope[axis], v->center[axis]) + shift * b[axis];
    const float half = v->settings->cutoff * sqrtf(wide[2 * axis]) + 1.0f;
    const int size = axis ? v->camera->height : v->camera->width;
    e->box[0][axis] = (int)fminf(fmaxf(e->place[axis] - half - 1.0f, 0.0f), (float)size);
    e->box[1][axis] = (int)fminf(fmaxf(e->place[axis] + half + 1.0f, 0.0f), (float)size);
  }
  e->iz = e->iz_plane = iz * W;
  e->iz_gradient[0] = step * plain_mad(f, e->form[0], b[0], e->form[1] * b[1]);
  e->iz_gradient[1] = step * plain_mad(f, e->form[1], b[0], e->form[2] * b[1]);
  const float over = plain_divide(f, -iz, kappa);
  const float gradient[2] = {over * plain_mad(f, s[0][2], s[1][1], -(s[0][1] * s[1][2])),
                             over * plain_mad(f, s[0][0], s[1][2], -(s[1][0] * s[0][2]))};
  for (int axis = 0; axis < 2; axis++)
    e->plane_gradient[axis] = isfinite(gradient[axis]) ? gradient[axis] : 0.0f;
  return 1;
}

/* Where the distance of the centre stands for none of the rays near it. */
static int plain_is_wide(plain_stage *v, const float p[3], float reach, const plain_ellipse *e) {
  const float F = v->settings->cutoff, h = v->settings->prefilter, iz = 1.0f / p[2];
  const float det = e->form[0] * e->form[2] - e->form[1] * e->form[1];
  const float g = sqrtf(e->plane_gradient[0] * e->plane_gradient[0] + e->plane_gradient[1] * e->plane_gradient[1]);
  float slopes = 0.0f, squares = 0.0f;
  for (int axis = 0; axis < 2; axis++) {
    const float focal = axis ? v->camera->fy : v->camera->fx;
    const float shift = fabsf(e->place[axis] - (focal * p[axis] * iz + v->center[axis]));
    const float around = (F * sqrtf(e->form[2 - 2 * axis] / det) + shift) / focal;
    slopes += fabsf(p[axis] * iz) * around;
    squares += around * around;
  }
  return !(reach * iz + g * F * sqrtf(h) * p[2] + slopes + 0.5f * squares <= 0.0195f);
}

/* Sets up a surfel. 0: none of it is seen; −1: it needs what this renderer lacks. */
static int plain_place_surfel(plain_stage *v, const plain_surfels *s, size_t i, plain_ellipse *e) {
  plain_floats *f = &v->floats;
  float p[3], t[2][3], across[3];
  for (int row = 0; row < 3; row++) {
    const float *turn = v->camera->view[row];
    p[row] = plain_dot_plus(f, turn, s->center + 3 * i, turn[3]);
    t[0][row] = plain_dot(f, turn, s->axes[0] + 3 * i);
    t[1][row] = plain_dot(f, turn, s->axes[1] + 3 * i);
  }
  const float F = v->settings->cutoff, reach = F * plain_root(f, plain_mad(f, t[0][2], t[0][2], t[1][2] * t[1][2]));
  *e = (plain_ellipse){.index = (uint32_t)i, .distance = plain_length(f, p)};
  if (p[2] + reach <= v->near)
    return 0;
  if (reach >= p[2] - v->near || (!v->is_affine && reach >= 0.25f * p[2]))
    return -1;
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    across[k] = plain_mad(f, t[0][l], t[1][m], -(t[0][m] * t[1][l]));
  }
  if (plain_has(v->settings->faults, PLAIN_BACK_FACES) && plain_dot(f, p, across) > 0.0f)
    return 0;
  if (!plain_project_disc(v, p, t, reach, e))
    return 0;
  e->iz_range[0] = plain_divide(f, 1.0f, p[2] + reach);
  e->iz_range[1] = plain_divide(f, 1.0f, p[2] - reach);
  e->epsilon = fminf(F * plain_reach_of_axes(f, s, i), 4.0f * F * v->median);
  e->is_wide = plain_is_wide(v, p, reach, e);
  memcpy(e->color, s->color + 3 * i, sizeof e->color);
  return 1;
}

/* A surfel at a pixel. */
typedef struct plain_sight {
  float weight, nearer, farther, plane; /* inverse depths: it is seen by the nearer, and hides by the farther */
} plain_sight;

static float plain_within(float value, const float range[2]) {
  return fminf(fmaxf(value, range[0]), range[1]);
}

static int plain_see(plain_stage *v, const plain_ellipse *e, int column, int row, plain_sight *sight) {
  plain_floats *f = &v->floats;
  const float half = plain_has(v->settings->faults, PLAIN_HALF_PIXEL) ? 0.0f : 0.5f;
  const float dx = (float)column + half - e->place[0], dy = (float)row + half - e->place[1];
  const float q = plain_mad(f, e->form[0] * dx, dx, plain_mad(f, e->form[2] * dy, dy, 2.0f * e->form[1] * dx * dy));
  if (!(q < v->settings->cutoff * v->settings->cutoff))
    return 0;
  const float iz =
      plain_within(plain_mad(f, e->iz_gradient[1], dy, plain_mad(f, e->iz_gradient[0], dx, e->iz)), e->iz_range);
  sight->plane = plain_mad(f, e->plane_gradient[1], dy, plain_mad(f, e->plane_gradient[0], dx, e->iz_plane));
  sight->weight = plain_greater(e->amplitude * plain_exponential(f, -0.5f * q), 0x1p-60f);
  sight->nearer = plain_greater(iz, sight->plane);
  sight->farther = fminf(iz, sight->plane);
  sight->plane = plain_within(sight->plane, e->iz_range);
  return 1;
}

/* The inverse depth below which a surfel hides what else there is: by its tolerance farther along the ray. */
static float plain_hidden_below(plain_stage *v, const plain_ellipse *e, const plain_sight *sight, int column, int row) {
  plain_floats *f = &v->floats;
  float share = plain_divide(f, e->epsilon, e->distance);
  if (plain_has(v->settings->faults, PLAIN_EPSILON_IN_Z))
    share = e->epsilon * plain_greater(sight->farther, 0.0f);
  else if (e->is_wide) {
    const float ray[3] = {((float)column + 0.5f - v->center[0]) / v->camera->fx,
                          ((float)row + 0.5f - v->center[1]) / v->camera->fy, 1.0f};
    share = plain_divide(f, e->epsilon * plain_greater(sight->farther, 0.0f), plain_length(f, ray));
  }
  return plain_divide(f, sight->farther, 1.0f + share);
}

/* What pixels gather, in the order of the file. */
typedef struct plain_gathering {
  float *front; /* the inverse depth below which all is hidden */
  float *sums;  /* of weights and of colours: 4 */
  float *heaviest;
} plain_gathering;

static void plain_gather(plain_stage *v, const plain_ellipse *e, int is_front, const plain_gathering *to,
                         plain_picture *picture) {
  plain_floats *f = &v->floats;
  plain_sight sight;
  for (int y = e->box[0][1]; y < e->box[1][1]; y++)
    for (int x = e->box[0][0]; x < e->box[1][0]; x++) {
      const size_t at = (size_t)y * (size_t)picture->width + (size_t)x;
      if (!plain_see(v, e, x, y, &sight))
        continue;
      if (is_front) {
        to->front[at] = plain_greater(to->front[at], plain_hidden_below(v, e, &sight, x, y));
        continue;
      }
      if (sight.nearer < to->front[at])
        continue;
      for (int c = 0; c < 3; c++)
        to->sums[4 * at + (size_t)c] = plain_mad(f, sight.weight, e->color[c], to->sums[4 * at + (size_t)c]);
      to->sums[4 * at + 3] += sight.weight;
      picture->count[at] += 1.0f;
      if (sight.weight > to->heaviest[at]) {
        to->heaviest[at] = sight.weight;
        picture->z[at] = plain_divide(f, 1.0f, sight.plane);
      }
    }
}

static void plain_resolve(plain_stage *v, const plain_gathering *from, plain_picture *picture) {
  const plain_surfel_settings *s = v->settings;
  const int is_white = plain_has(s->faults, PLAIN_BACKGROUND_WHITE);
  for (size_t i = 0; i < (size_t)picture->width * (size_t)picture->height; i++) {
    const float *sums = from->sums + 4 * i;
    const int is_covered = sums[3] > 0.0f;
    const float over = plain_has(s->faults, PLAIN_NO_NORMALISATION) ? 1.0f
                       : is_covered                                 ? plain_divide(&v->floats, 1.0f, sums[3])
                                                                    : 0.0f;
    for (size_t c = 0; c < 3; c++)
      picture->rgb[3 * i + c] = is_covered ? sums[c] * over : is_white ? 1.0f : s->background[c];
    picture->T[i] = is_covered ? 0.0f : 1.0f;
    picture->alpha[i] = is_covered || s->is_opaque || is_white ? 1.0f : 0.0f;
  }
}

size_t plain_surfels_draw(const plain_surfels *surfels, const plain_camera *camera,
                          const plain_surfel_settings *settings, plain_picture *picture) {
  const size_t n_pixels = (size_t)picture->width * (size_t)picture->height;
  plain_stage v = plain_set_stage(surfels, camera, settings);
  plain_ellipse *all = calloc(surfels->count + 1, sizeof *all);
  plain_gathering to = {calloc(n_pixels, sizeof(float)), calloc(n_pixels, 4 * sizeof(float)),
                        calloc(n_pixels, sizeof(float))};
  size_t n = 0, n_lacking = 0;
  if (!all || !to.front || !to.sums || !to.heaviest)
    plain_give_up("memory", "there is not enough");
  for (size_t i = 0; i < surfels->count; i++) {
    const int is_there = plain_place_surfel(&v, surfels, i, &all[n]);
    n += is_there > 0;
    n_lacking += is_there < 0;
  }
  const plain_floats kept = v.floats;
  for (int is_front = 1; is_front >= 0; is_front--) {
    v.floats = kept; /* a surfel is seen in both passes as the same */
    for (size_t i = 0; i < n; i++)
      plain_gather(&v, &all[i], is_front, &to, picture);
  }
  plain_resolve(&v, &to, picture);
  plain_picture_spoil(picture, settings->faults);
  free(to.front);
  free(to.sums);
  free(to.heaviest);
  free(all);
  return n_lacking;
}
