/* The derivative as it is asked for and handed out. */

#include "oracle/gaussians/oracle_gradient_job.h"

enum { CHAIN_RUN = 1024 };

const char *conic_gradient_doubt_name(int doubt) {
  static const char *const clamps[] = {"color", "slope", "compensation"};
  if (doubt >= CONIC_DOUBT_COLOR && doubt < CONIC_N_GRADIENT_DOUBTS)
    return clamps[doubt - CONIC_DOUBT_COLOR];
  return doubt >= 0 ? conic_gaussian_doubt_name((conic_gaussian_doubt)doubt) : NULL;
}

CONIC_DEFINE_ZERO_OPTIONS(conic_gradient_options)

CONIC_DEFINE_NAMES(conic_gradient_kind_name, conic_gradient_kind, CONIC_N_GRADIENT_KINDS, "mean", "scale", "rotation",
                   "opacity", "sh", "place")

int conic_gradient_has_profile(conic_gaussian_profile profile) {
  const conic_profile_row *rules = conic_profile_row_of(profile);
  return rules && rules->shape != CONIC_SHAPE_DISC && rules->shape != CONIC_SHAPE_SOLID &&
         !conic_profile_limits_axes(rules) && rules->compensation_slack == 0.0 && rules->fall_end == 0.0;
}

void conic_gaussian_gradient_release(conic_context *context, conic_gaussian_gradient *gradient) {
  conic_memory_release(context, gradient->mean[0]); /* the first of all */
  conic_memory_release(context, gradient->doubt);
  memset(gradient, 0, sizeof *gradient);
}

/* One block for all columns. */
conic_status conic_oracle_gradient_room(conic_context *context, size_t n, int sh_degree, int has_third_scale,
                                        conic_gaussian_gradient *g) {
  const size_t n_sh = 3 * (size_t)(sh_degree + 1) * (size_t)(sh_degree + 1);
  double **const columns[] = {&g->mean[0],     &g->mean[1],     &g->mean[2],     &g->scale[0],    &g->scale[1],
                              &g->rotation[0], &g->rotation[1], &g->rotation[2], &g->rotation[3], &g->opacity,
                              &g->place[0],    &g->place[1],    &g->scale[2]};
  const size_t n_columns = sizeof columns / sizeof *columns - !has_third_scale;
  memset(g, 0, sizeof *g);
  double *block = conic_memory_allocate_zeroed(context, n, (n_columns + n_sh) * sizeof *block);
  g->doubt = conic_memory_allocate_zeroed(context, n, sizeof *g->doubt);
  g->mean[0] = block;
  if (!block || !g->doubt) {
    conic_gaussian_gradient_release(context, g);
    return CONIC_ERROR_MEMORY;
  }
  for (size_t k = 0; k < n_columns; k++)
    *columns[k] = block + k * n;
  g->sh = block + n_columns * n;
  g->count = n;
  g->sh_degree = sh_degree;
  return CONIC_OK;
}

/* --- from the screen to the parameters --- */

static void hand_out(const oracle_gradient_job *j, size_t i, const oracle_parameters *p) {
  conic_gaussian_gradient *g = j->gradient;
  const conic_gaussians *set = j->set;
  const size_t n_sh = 3 * (size_t)(g->sh_degree + 1) * (size_t)(g->sh_degree + 1);
  for (int k = 0; k < 3; k++) {
    g->mean[k][i] = p->mean[k];
    if (g->scale[k])
      g->scale[k][i] = p->scale[k] * (g->is_raw ? (double)set->scale[k][i] : 1.0);
  }
  for (int k = 0; k < 4; k++)
    g->rotation[k][i] = p->rotation[k];
  const double o = (double)set->opacity[i];
  g->opacity[i] = p->opacity * (g->is_raw ? o * (1.0 - o) : 1.0);
  memcpy(g->sh + i * n_sh, p->sh, n_sh * sizeof *p->sh);
  for (int axis = 0; axis < 2 && j->view.rules->shape == CONIC_SHAPE_ELLIPSE; axis++)
    g->place[axis][i] = j->totals[i][BY_PLACE + axis];
  g->doubt[i] |= p->doubts;
}

static void chain_run(void *data, size_t i_run) {
  const oracle_gradient_job *j = data;
  for (size_t i = i_run * CHAIN_RUN; i < (i_run + 1) * CHAIN_RUN && i < j->set->count; i++) {
    oracle_parameters p;
    if (!j->is_shown[i])
      continue;
    conic_oracle_gradient_chain(&j->view, &j->eye, j->set, i, j->model, NULL, j->totals[i], &p, &j->cameras[i_run]);
    hand_out(j, i, &p);
  }
}

conic_status conic_oracle_gradient_chain_all(oracle_gradient_job *j) {
  conic_gaussian_gradient *g = j->gradient;
  const size_t n_runs = (j->set->count + CHAIN_RUN - 1) / CHAIN_RUN;
  j->cameras = conic_memory_allocate_zeroed(j->context, n_runs, sizeof *j->cameras);
  if (!j->cameras)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(j->context, n_runs, chain_run, j);
  for (size_t i = 0; i < n_runs; i++) {
    for (int k = 0; k < 12; k++)
      g->cam_from_world[k / 4][k % 4] += j->cameras[i].cam_from_world[k / 4][k % 4];
    g->fx += j->cameras[i].focal[0];
    g->fy += j->cameras[i].focal[1];
    g->cx += j->cameras[i].center[0];
    g->cy += j->cameras[i].center[1];
  }
  for (size_t i = 0; i < g->count; i++) {
    g->n_shown += j->is_shown[i] != 0;
    g->n_doubtful += g->doubt[i] != 0;
    for (int k = 0; k < CONIC_N_GRADIENT_DOUBTS; k++)
      g->doubtful[k] += g->doubt[i] >> k & 1;
  }
  return CONIC_OK;
}

/* --- doubts --- */

/* An order in doubt is told of the later one, and is of both. */
static void note_doubts(void *data, size_t pixel, const oracle_meeting *meetings, size_t n, int i_thread) {
  const oracle_gradient_job *j = data;
  uint16_t *doubts = j->doubts + (size_t)i_thread * j->set->count;
  const unsigned open = 1u << CONIC_DOUBT_EDGE | 1u << CONIC_DOUBT_NEAR | 1u << CONIC_DOUBT_SIGN;
  for (size_t i = 0; i < n; i++) {
    if (j->judging && meetings[i].noted & open)
      j->judging->is_open_pixel[pixel] = 1;
    doubts[meetings[i].g->index] |= (uint16_t)meetings[i].noted;
    for (size_t k = i; meetings[i].noted >> CONIC_DOUBT_ORDER & 1 && k > 0 && !meetings[k].is_cut; k--)
      if (!conic_oracle_is_before(&meetings[k - 1], &meetings[i]))
        doubts[meetings[k - 1].g->index] |= 1u << CONIC_DOUBT_ORDER;
  }
}

/* Of all pixels that have a weight. */
conic_status conic_oracle_gradient_doubts(oracle_gradient_job *j, oracle_entry *e) {
  const size_t n = e->bounding.n_pixels, threads = (size_t)conic_context_threads(j->context);
  uint32_t *pixels = conic_memory_allocate(j->context, n, sizeof *pixels);
  double weights[N_WEIGHTS];
  j->doubts = conic_memory_allocate_zeroed(j->context, threads * j->set->count, sizeof *j->doubts);
  conic_status status = pixels && j->doubts ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    e->bounding.n_pixels = 0;
    for (size_t i = 0; i < n; i++)
      if (conic_oracle_pixel_weights(j->weights, i, weights))
        pixels[e->bounding.n_pixels++] = (uint32_t)i;
    e->bounding.pixels = pixels;
    e->bounding.note = note_doubts;
    e->bounding.surfaces = j->surfaces;
    e->bounding.data = j;
    e->bounding.task = "doubts";
    status = conic_oracle_bound_all(&e->bounding);
  }
  for (size_t i = 0; i < threads * j->set->count && status == CONIC_OK; i++)
    j->gradient->doubt[i % j->set->count] |= j->doubts[i];
  conic_memory_release(j->context, pixels);
  return status;
}

/* --- the entry --- */

static conic_status check_gradient_weights(conic_context *context, const conic_gaussian_weights *w,
                                           const conic_camera *camera) {
  if (!w || w->width != camera->width || w->height != camera->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gradient: the weights are not of the camera's size");
  const size_t n = (size_t)w->width * (size_t)w->height;
  const double *const planes[] = {w->rgb, w->rgb ? w->rgb + n : NULL, w->rgb ? w->rgb + 2 * n : NULL, w->alpha, w->z};
  for (size_t k = 0; k < N_WEIGHTS; k++)
    for (size_t i = 0; planes[k] && i < n; i++)
      if (!oracle_is_finite(planes[k][i]))
        return conic_fail(context, CONIC_ERROR_ARGUMENT, "gradient: a weight is not finite");
  return CONIC_OK;
}

static void find_gradient_eye(const conic_camera *camera, oracle_eye *eye) {
  double rotation[3][3];
  for (int row = 0; row < 3; row++)
    memcpy(rotation[row], camera->cam_from_world[row], sizeof rotation[row]);
  conic_oracle_invert(rotation, eye->inverse);
  for (int axis = 0; axis < 3; axis++)
    for (int row = 0; row < 3; row++)
      eye->place[axis] -= eye->inverse[axis][row] * camera->cam_from_world[row][3];
}

static conic_status run_gradient_job(oracle_gradient_job *j, oracle_entry *e) {
  conic_status status = conic_oracle_differentiate(j);
  if (status == CONIC_OK && j->model)
    status = conic_oracle_gradient_doubts(j, e);
  return status == CONIC_OK ? conic_oracle_gradient_chain_all(j) : status;
}

conic_status conic_oracle_gradient_begin(conic_context *context, const conic_gaussians *set, const conic_camera *camera,
                                         const conic_gaussian_options *options, const conic_gaussian_weights *weights,
                                         const conic_gradient_options *how, conic_float_kind kind,
                                         conic_gaussian_gradient *gradient, oracle_entry *e, oracle_gradient_job *j) {
  conic_gradient_options own;
  conic_float_model model;
  memset(j, 0, sizeof *j);
  memset(gradient, 0, sizeof *gradient);
  conic_gradient_options_init(&own);
  conic_float_model_init(&model, kind);
  if (how && !conic_options_take(&own, how))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gradient: no such options");
  conic_status status = conic_oracle_enter(context, set, camera, options, own.model ? own.model : &model, 1, e);
  if (status == CONIC_OK)
    status = check_gradient_weights(context, weights, camera);
  if (status == CONIC_OK && own.surfaces && !conic_oracle_surfaces_fit(own.surfaces, camera->width, camera->height, 0))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gradient: the surfaces are not those of the picture's pixels");
  if (status == CONIC_OK && !conic_gradient_has_profile(e->options.profile))
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "gradient: the profile %s has none yet",
                      conic_gaussian_profile_name(e->options.profile));
  if (status == CONIC_OK)
    status = conic_oracle_gradient_room(context, set->count, set->sh_degree, set->scale[2] != NULL, gradient);
  if (status != CONIC_OK)
    return status;
  gradient->is_raw = own.is_raw != 0;
  *j = (oracle_gradient_job){.context = context,
                             .set = set,
                             .weights = weights,
                             .model = own.leaves_doubts ? NULL : &e->model,
                             .background = e->options.background,
                             .surfaces = own.surfaces,
                             .view = e->view,
                             .gradient = gradient,
                             .wrong_kinds = own.wrong_kinds};
  find_gradient_eye(camera, &j->eye);
  return CONIC_OK;
}

conic_status conic_gaussian_gradient_find(conic_context *context, const conic_gaussians *set,
                                          const conic_camera *camera, const conic_gaussian_options *options,
                                          const conic_gaussian_weights *weights, const conic_gradient_options *how,
                                          conic_gaussian_gradient *gradient) {
  oracle_entry e;
  oracle_gradient_job j;
  conic_status status =
      conic_oracle_gradient_begin(context, set, camera, options, weights, how, CONIC_FLOATS_STRICT, gradient, &e, &j);
  if (status != CONIC_OK)
    return status;
  status = run_gradient_job(&j, &e);
  conic_oracle_gradient_end(&j);
  if (status != CONIC_OK)
    conic_gaussian_gradient_release(context, gradient);
  return status;
}
