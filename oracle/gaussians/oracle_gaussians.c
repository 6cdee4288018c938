/* A picture of Gaussians by the oracle: every pixel by itself, over all of them. */

#include "core/base/real.h"
#include "core/image/view_arguments.h"
#include "oracle/gaussians/oracle_gaussian.h"
#include "oracle/gaussians/oracle_lens.h"
#include "oracle/oracle_math.h"

/* --- emission and absorption along a pixel's ray: docs/reference/gaussians.md, Truth --- */

/* A Gaussian on the ray: its optical depth, spread as a normal density about z. */
typedef struct oracle_cloud {
  double depth, z, width, color[3];
} oracle_cloud;

enum { ORACLE_PLACES = 17 };

#define ROOT_OF_TWO 1.4142135623730950488
#define ONE_OVER_ROOT_OF_TWO_PI 0.39894228040143267794
#define TWO_OVER_ROOT_OF_PI 1.1283791670955125739

enum { REACH = 8, MOST_HALVINGS = 6 };

/* The error function; absolute error under 1e-15. */
/* Its series in e^(−x²), all of whose terms have one sign; from 6 on it is 1 to the last bit. */
static double oracle_erf(double x) {
  double size = fabs(x), term = size, sum = size;
  if (size >= 6.0)
    return x < 0.0 ? -1.0 : 1.0;
  for (int n = 1; term > 1e-18 * sum; n++) {
    term *= 2.0 * size * size / (2 * n + 1);
    sum += term;
  }
  double value = sum > 0.0 ? TWO_OVER_ROOT_OF_PI * conic_oracle_exp(-size * size) * sum : 0.0;
  return x < 0.0 ? -value : value;
}

/* What is emitted at z and comes to the eye. */
static void emitted(const oracle_cloud *clouds, size_t n, double z, double color[3]) {
  double depth = 0.0, sum[3] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < n; i++) {
    double u = (z - clouds[i].z) / clouds[i].width;
    if (u < -(REACH + 1.0))
      continue;
    depth += clouds[i].depth * 0.5 * (1.0 + oracle_erf(u / ROOT_OF_TWO));
    if (u > REACH + 1.0)
      continue;
    double density = clouds[i].depth * ONE_OVER_ROOT_OF_TWO_PI / clouds[i].width * conic_oracle_exp(-0.5 * u * u);
    for (int c = 0; c < 3; c++)
      sum[c] += density * clouds[i].color[c];
  }
  double seen = conic_oracle_exp(-depth);
  for (int c = 0; c < 3; c++)
    color[c] = sum[c] * seen;
}

static void add_interval(const oracle_cloud *clouds, size_t n, double from, double to, double color[3]) {
  static const double at[3] = {0.23861918608319690863, 0.66120938646626451366, 0.93246951420315202781};
  static const double weight[3] = {0.46791393457269104739, 0.36076157304813860757, 0.17132449237917034504};
  double middle = 0.5 * (from + to), half = 0.5 * (to - from), here[3];
  for (int k = 0; k < 6; k++) {
    emitted(clouds, n, middle + (k & 1 ? half : -half) * at[k / 2], here);
    for (int c = 0; c < 3; c++)
      color[c] += here[c] * weight[k / 2] * half;
  }
}

/* ∫ Σ color_i·density_i·exp(−depth up to there) dz over all of the ray. `places` has room for 2·n·ORACLE_PLACES
 * numbers. Returns the change that the last halving of the steps made. */
static double oracle_integrate(const oracle_cloud *clouds, size_t n, double *places, double color[3]) {
  size_t n_places = 0;
  enum { MIDDLE = ORACLE_PLACES / 2 };
  double change = 0.0, before[3] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < ORACLE_PLACES; k++)
      places[n_places++] = clouds[i].z + (k - MIDDLE) * (2.0 * REACH / (ORACLE_PLACES - 1)) * clouds[i].width;
  qsort(places, n_places, sizeof *places, conic_compare_doubles);
  for (int halving = 0; halving < MOST_HALVINGS; halving++) {
    int n_steps = 1 << halving;
    color[0] = color[1] = color[2] = 0.0;
    for (size_t i = 0; i + 1 < n_places; i++)
      for (int k = 0; k < n_steps; k++) {
        double width = places[i + 1] - places[i];
        if (width > 0.0)
          add_interval(clouds, n, places[i] + width * k / n_steps, places[i] + width * (k + 1) / n_steps, color);
      }
    change = 0.0;
    for (int c = 0; c < 3; c++) {
      change = oracle_max(change, fabs(color[c] - before[c]));
      before[c] = color[c];
    }
    if (halving > 0 && change < 1e-10)
      break;
  }
  return change;
}

/* --- pictures --- */

enum { SET_UP_RUN = 1024 };

/* What covers a pixel. */
typedef struct covering {
  const oracle_gaussian *gaussian;
  float key;
  double alpha, z;
} covering;

typedef struct gaussian_worker {
  covering *coverings;
  oracle_cloud *clouds;
  double *places, quadrature;
} gaussian_worker;

typedef struct job {
  conic_context *context;
  const conic_gaussians *set;
  const conic_gaussian_options *options;
  conic_gaussian_question question;
  oracle_gaussian_view view;
  oracle_gaussian *gaussians;
  size_t n;
  gaussian_worker *workers;
  conic_gaussian_reference *reference;
} job;

CONIC_DEFINE_ORDER_BY_TWO(compare_gaussians, oracle_gaussian, key, index)
CONIC_DEFINE_ORDER_BY_TWO(compare_coverings, covering, key, gaussian->index)

static void place_gaussians(void *data, size_t i_run) {
  job *j = data;
  for (size_t i = i_run * SET_UP_RUN; i < (i_run + 1) * SET_UP_RUN && i < j->set->count; i++)
    conic_oracle_gaussian_place(&j->view, j->set, i, &j->gaussians[i]);
}

/* Composites what covers the pixel, nearest first. */
static void composite(const job *j, const covering *coverings, size_t n, size_t pixel) {
  const conic_profile_row *rules = j->view.rules;
  conic_gaussian_reference *r = j->reference;
  double T = 1.0, heaviest = 0.0, sum_of_z = 0.0, sum = 0.0, *rgb = &r->rgb[3 * pixel];
  for (size_t i = 0; i < n; i++) {
    const oracle_gaussian *g = coverings[i].gaussian;
    double alpha = coverings[i].alpha, z = coverings[i].z, w = alpha * T, rest = T * (1.0 - alpha);
    if (rest < rules->stop || (rules->is_beyond_stop && rest == rules->stop))
      break;
    for (int c = 0; c < 3; c++) {
      rgb[c] += w * g->color[c];
      r->normal[3 * pixel + (size_t)c] += w * g->normal[c];
    }
    sum += w;
    sum_of_z += w * z;
    r->inverse_z[pixel] += w / z;
    if (T > 0.5 && (rules->has_late_median || rest <= 0.5))
      r->median_z[pixel] = z;
    if (w > heaviest) {
      heaviest = w;
      r->id[pixel] = g->index;
    }
    r->last[pixel] = g->index;
    r->count[pixel]++;
    T = rest;
  }
  r->z[pixel] = sum > 0.0 ? sum_of_z / sum : 0.0;
  r->transparency[pixel] = T;
}

/* The profile's picture at a pixel. */
static void composite_pixel(const job *j, gaussian_worker *w, double x, double y, size_t pixel) {
  size_t n = 0;
  for (size_t i = 0; i < j->n; i++) {
    covering *c = &w->coverings[n];
    c->gaussian = &j->gaussians[i];
    c->alpha = conic_oracle_gaussian_alpha(&j->view, c->gaussian, x, y, &c->z);
    c->key = (float)c->z;
    n += c->alpha > 0.0;
  }
  if (j->view.rules->shape == CONIC_SHAPE_RAY)
    qsort(w->coverings, n, sizeof *w->coverings, compare_coverings);
  composite(j, w->coverings, n, pixel);
}

/* A Gaussian's optical depth along the ray; docs/reference/gaussians.md, Truth. */
static double optical_depth(const job *j, const oracle_gaussian *g, double q, double width, double x, double y) {
  const conic_camera *camera = j->view.camera;
  double response = conic_oracle_exp(-0.5 * q);
  if (j->question == CONIC_GAUSSIAN_OVERLAP)
    return -conic_oracle_log(1.0 - oracle_min(g->opacity * response, 0.99));
  double origin[3], ray[3];
  conic_oracle_pixel_ray(camera, x, y, origin, ray);
  double length = oracle_length(ray);
  double radius = conic_oracle_exp(conic_oracle_log(g->scale[0] * g->scale[1] * g->scale[2]) / 3.0);
  return -conic_oracle_log(1.0 - oracle_min(g->opacity, 1.0 - 1e-12)) * width * length / radius * response;
}

static void integrate_pixel(const job *j, gaussian_worker *w, double x, double y, size_t pixel) {
  conic_gaussian_reference *r = j->reference;
  size_t n = 0;
  double q, z, width, depth = 0.0, greatest = 0.0;
  for (size_t i = 0; i < j->n; i++) {
    const oracle_gaussian *g = &j->gaussians[i];
    if (!conic_oracle_gaussian_along(&j->view, g, x, y, &q, &z, &width))
      continue;
    double own = optical_depth(j, g, q, width, x, y);
    if (!(own > 1e-15))
      continue;
    w->clouds[n++] = (oracle_cloud){own, z, oracle_max(width, z * 1e-9), {g->color[0], g->color[1], g->color[2]}};
    depth += own;
    if (own > greatest) {
      greatest = own;
      r->id[pixel] = g->index;
    }
  }
  double change = oracle_integrate(w->clouds, n, w->places, &r->rgb[3 * pixel]);
  w->quadrature = oracle_max(w->quadrature, change);
  r->transparency[pixel] = conic_oracle_exp(-depth);
  r->count[pixel] = (uint32_t)n;
}

static void draw_row_again(void *data, size_t row, int i_thread) {
  job *j = data;
  conic_gaussian_reference *r = j->reference;
  for (int column = 0; column < r->width; column++) {
    size_t pixel = row * (size_t)r->width + (size_t)column;
    double x = column + 0.5, y = (double)row + 0.5;
    r->id[pixel] = r->last[pixel] = CONIC_NO_ID;
    if (j->question == CONIC_GAUSSIAN_PROFILE)
      composite_pixel(j, &j->workers[i_thread], x, y, pixel);
    else
      integrate_pixel(j, &j->workers[i_thread], x, y, pixel);
    for (int c = 0; c < 3; c++)
      r->rgb[3 * pixel + (size_t)c] += r->transparency[pixel] * (double)j->options->background[c];
  }
}

static void find_rays_of_row(void *data, size_t row) {
  const job *j = data;
  conic_oracle_ray_row(&j->view, row, j->view.rays + row * (size_t)j->view.camera->width);
}

static conic_status allocate_job(job *j, int width, int height) {
  conic_gaussian_reference *r = j->reference;
  const size_t n = (size_t)width * (size_t)height, threads = (size_t)conic_context_threads(j->context);
  r->width = width;
  r->height = height;
  conic_status status = conic_memory_allocate_these(
      j->context, CONIC_ZEROED(r->transparency, n), CONIC_ZEROED(r->z, n), CONIC_ZEROED(r->median_z, n),
      CONIC_ZEROED(r->inverse_z, n), CONIC_ZEROED(r->count, n), CONIC_ZEROED(r->id, n), CONIC_ZEROED(r->last, n),
      CONIC_ZEROED(r->rgb, 3 * n), CONIC_ZEROED(r->normal, 3 * n), CONIC_ROOM(j->gaussians, j->set->count),
      CONIC_ZEROED(j->workers, threads));
  for (size_t k = 0; status == CONIC_OK && k < threads; k++) {
    gaussian_worker *w = &j->workers[k];
    status = j->question == CONIC_GAUSSIAN_PROFILE
                 ? conic_memory_allocate_these(j->context, CONIC_ROOM(w->coverings, j->set->count + 1))
                 : conic_memory_allocate_these(j->context, CONIC_ROOM(w->clouds, j->set->count),
                                               CONIC_ROOM(w->places, ORACLE_PLACES * j->set->count));
  }
  return status;
}

/* The eye is −RᵀT; a profile that is named after a program has it in floats, as those programs do. */
void conic_oracle_gaussian_look(const conic_camera *camera, conic_gaussian_profile profile,
                                oracle_gaussian_view *view) {
  view->camera = camera;
  view->rules = conic_profile_row_of(profile);
  view->most_angle = conic_oracle_most_angle(camera);
  for (int axis = 0; axis < 3; axis++) {
    double eye = 0.0;
    for (int row = 0; row < 3; row++)
      eye -= camera->cam_from_world[row][axis] * camera->cam_from_world[row][3];
    view->eye[axis] = view->rules->has_float_eye ? (double)(float)eye : eye;
  }
  view->center_px[0] = view->rules->takes_middle ? 0.5 * camera->width : camera->cx;
  view->center_px[1] = view->rules->takes_middle ? 0.5 * camera->height : camera->cy;
}

static conic_status draw_gaussians_again(job *j) {
  const conic_camera *camera = j->view.camera;
  conic_status status = allocate_job(j, camera->width, camera->height);
  if (status != CONIC_OK)
    return status;
  if (conic_oracle_is_bent(camera)) {
    j->view.rays =
        conic_memory_allocate(j->context, (size_t)camera->width * (size_t)camera->height, sizeof *j->view.rays);
    if (!j->view.rays)
      return CONIC_ERROR_MEMORY;
    conic_parallel_for(j->context, (size_t)camera->height, find_rays_of_row, j);
  }
  status = conic_parallel_told(j->context, "verify", 0.0, 0.05, (j->set->count + SET_UP_RUN - 1) / SET_UP_RUN,
                               place_gaussians, j);
  if (status != CONIC_OK)
    return status;
  /* In the order that all pixels share, without what is never drawn. */
  j->n = 0;
  for (size_t i = 0; i < j->set->count; i++)
    if (j->gaussians[i].is_drawn)
      j->gaussians[j->n++] = j->gaussians[i];
  qsort(j->gaussians, j->n, sizeof *j->gaussians, compare_gaussians);
  status = conic_parallel_told(j->context, "verify", 0.05, 1.0, (size_t)camera->height, draw_row_again, j);
  for (int k = 0; k < conic_context_threads(j->context); k++)
    j->reference->quadrature = oracle_max(j->reference->quadrature, j->workers[k].quadrature);
  return status;
}

conic_status conic_gaussian_oracle_render(conic_context *context, const conic_gaussians *gaussians,
                                          const conic_camera *camera, const conic_gaussian_options *options,
                                          conic_gaussian_question question, conic_gaussian_reference *reference) {
  conic_gaussian_options own;
  conic_gaussian_options_init(&own);
  memset(reference, 0, sizeof *reference);
  if ((options && !conic_options_take(&own, options)) || (unsigned)question > CONIC_GAUSSIAN_VOLUME ||
      !conic_profile_row_of(own.profile))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "oracle: no such options, profile or question");
  if (!(own.prefilter >= 0.0 && own.prefilter <= 1e4) || (own.prefilter > 0.0 && own.profile != CONIC_PROFILE_EXACT))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "oracle: a prefilter of 0 to 10000 is of the profile exact");
  int is_affine =
      !camera->lens && (camera->kind == CONIC_CAMERA_PERSPECTIVE || camera->kind == CONIC_CAMERA_ORTHOGRAPHIC);
  if (own.prefilter > 0.0 && !is_affine)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "oracle: the prefilter is of pinholes and orthographic cameras");
  const conic_gaussian_profile profile = question == CONIC_GAUSSIAN_PROFILE ? own.profile : CONIC_PROFILE_EXACT;
  if (conic_view_profile_check(context, "oracle", conic_profile_row_of(profile), camera) != CONIC_OK)
    return CONIC_ERROR_ARGUMENT;
  job j = {.context = context, .set = gaussians, .options = &own, .question = question, .reference = reference};
  conic_camera middle;
  conic_oracle_middle(camera, &middle);
  conic_oracle_gaussian_look(&middle, profile, &j.view);
  if (camera->shutter)
    conic_oracle_shutter_eye(camera, j.view.eye);
  j.view.prefilter = question == CONIC_GAUSSIAN_PROFILE ? own.prefilter : 0.0;
  conic_status status = draw_gaussians_again(&j);
  for (int k = 0; j.workers && k < conic_context_threads(j.context); k++)
    conic_memory_release_these(j.context, j.workers[k].coverings, j.workers[k].clouds, j.workers[k].places);
  conic_memory_release_these(j.context, j.view.rays, j.workers, j.gaussians);
  if (status != CONIC_OK)
    conic_gaussian_reference_release(context, reference);
  return status;
}

void conic_gaussian_reference_release(conic_context *context, conic_gaussian_reference *r) {
  double *const doubles[] = {r->rgb, r->transparency, r->z, r->median_z, r->inverse_z, r->normal};
  uint32_t *const words[] = {r->count, r->id, r->last};
  for (size_t k = 0; k < sizeof doubles / sizeof *doubles; k++)
    conic_memory_release(context, doubles[k]);
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    conic_memory_release(context, words[k]);
  memset(r, 0, sizeof *r);
}
