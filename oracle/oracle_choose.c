/* Which formula draws a splat: "Which splats" and "Which formula, in this order" of docs/reference/picture.md. */
#include "oracle/oracle_splat.h"

/* Of another program nothing is known but that it computes in floats. It projects centres in them, through sums of four
 * products whose factors are rounded, too, and has places on the screen as floats; its axes come of sums of three, and
 * what it does at a pixel may take three times as many roundings as conic's. */
oracle_floats conic_oracle_floats(conic_float_kind kind) {
  const double own = ORACLE_ROUNDINGS * ORACLE_UNIT;
  if (kind == CONIC_FLOATS_OWN)
    return (oracle_floats){.unit = own, .axis = ORACLE_UNIT};
  return (oracle_floats){.unit = 3.0 * own,
                         .axis = 4.0 * ORACLE_UNIT,
                         .centre = 5.0 * ORACLE_UNIT,
                         .place = 3.0 * ORACLE_UNIT,
                         .kernel = kind == CONIC_FLOATS_FAST ? 0x1p-20 : 0x1p-22,
                         .is_setup_in_float = 1};
}

/* Of a kernel that is no Gaussian, by the steepest of its 1024 rings; what is flat up to its rim is right with its
 * outline. */
static double steepness_of(const conic_kernel *kernel) {
  const oracle_kernel_facts facts = conic_oracle_kernel_facts(kernel);
  const double step = oracle_min(facts.end, 4.0 * (double)kernel->cutoff) / 1024.0;
  double most = 0.0;
  if (facts.is_gaussian || facts.is_flat)
    return facts.is_flat ? 0.0 : ORACLE_AUTO_STEEPNESS;
  for (double r = 0.0, end = 1024.0 * step; r < end; r += step)
    most = oracle_max(most, conic_oracle_kernel(kernel, r * r) - conic_oracle_kernel(kernel, (r + step) * (r + step)));
  return ORACLE_AUTO_BY_SLOPE * most / step;
}

oracle_view conic_oracle_view(const conic_camera *camera, const conic_render_options *options, double near_z,
                              conic_float_kind floats) {
  oracle_view view = {*camera, near_z, options->kernel};
  view.floats = conic_oracle_floats(floats);
  view.cutoff = (double)options->kernel.cutoff;
  const oracle_kernel_facts facts = conic_oracle_kernel_facts(&options->kernel);
  const int is_profiled = !facts.is_gaussian && options->prefilter > 0.0f;
  double limit = oracle_min(view.cutoff, facts.end);
  view.support = limit * limit;
  view.prefilter = (double)options->prefilter;
  view.steepness = steepness_of(&options->kernel);
  view.reach_px = view.cutoff * sqrt(view.prefilter);
  view.method = (int)options->method;
  view.thin_px = 0.5;
  if (options->method == CONIC_METHOD_AUTO)
    view.thin_px = (is_profiled ? 1.0 / 256.0 : 0.125) * sqrt(oracle_max(view.prefilter, 1.0));
  view.cull_back = options->cull_back;
  view.profile = NULL;
  return view;
}

/* How many pixels the plane's inverse depth needs from the disc's far end to its near (or the near plane's). */
static double band_px(const oracle_view *view, const oracle_placed *s, double reach, const double normal[3]) {
  double far_iz = 1.0 / (s->p[2] + reach), near_iz = 1.0 / oracle_max(view->near_z, s->p[2] - reach);
  double gx = normal[0] / view->camera.fx, gy = normal[1] / view->camera.fy;
  double steepness = sqrt(gx * gx + gy * gy);
  return steepness > 0.0 ? (near_iz - far_iz) * fabs(oracle_dot(normal, s->p)) / steepness : INFINITY;
}

/* The bound of conic's error: its amplitude, times how far its centre is from p's place in standard deviations. */
static double conic_error(const oracle_view *view, const oracle_placed *s, const oracle_shape *shape) {
  const conic_camera *c = &view->camera;
  double offset[2] = {c->fx * s->p[0] / s->p[2] + c->cx - shape->center[0],
                      c->fy * s->p[1] / s->p[2] + c->cy - shape->center[1]};
  return view->steepness * shape->amplitude * sqrt(oracle_max(oracle_form(shape->inverse, offset), 0.0));
}

/* By how much of itself, as it is at p, the plane's inverse depth changes over the filter's standard deviation. */
static double change(const oracle_view *view, const oracle_placed *s, const double normal[3]) {
  double gx = normal[0] / view->camera.fx, gy = normal[1] / view->camera.fy;
  double distance = fabs(oracle_dot(normal, s->p));
  return sqrt((gx * gx + gy * gy) * view->prefilter) * s->p[2] / oracle_max(distance, 1e-300);
}

void conic_oracle_ask(const oracle_view *view, const oracle_placed *s, double answers[ORACLE_N_QUESTIONS]) {
  double normal[3], reach = view->cutoff * sqrt(s->tu[2] * s->tu[2] + s->tv[2] * s->tv[2]);
  oracle_cross(s->tu, s->tv, normal);
  double facing = oracle_dot(s->p, normal);
  answers[ORACLE_IS_BEHIND] = view->near_z - (s->p[2] + reach);
  answers[ORACLE_IS_BACK] = facing;
  answers[ORACLE_REACHES_NEAR] = reach - (s->p[2] - view->near_z);
  answers[ORACLE_IS_BAND_NARROW] = view->cutoff - band_px(view, s, reach, normal);
  answers[ORACLE_IS_THIN] = answers[ORACLE_IS_CLOSE] = answers[ORACLE_IS_COARSE] = answers[ORACLE_IS_STEEP] = -1.0;
  answers[ORACLE_HAS_NO_PLANE] = -oracle_length(normal);
  int is_dot = view->method == CONIC_METHOD_DISC || view->method == CONIC_METHOD_POINT; /* those have an area always */
  if (view->prefilter == 0.0 && answers[ORACLE_REACHES_NEAR] < 0.0 && !is_dot)
    answers[ORACLE_HAS_NO_PLANE] = -fabs(facing);
  oracle_shape shape;
  if (s->p[2] > reach && conic_oracle_shape(view, s, ORACLE_CONIC, &shape)) {
    oracle_symmetric r = shape.variance;
    r.xx -= view->prefilter;
    r.yy -= view->prefilter;
    answers[ORACLE_IS_COARSE] = conic_error(view, s, &shape) / ORACLE_AUTO_ERROR - 1.0;
    answers[ORACLE_IS_THIN] = view->thin_px - sqrt(oracle_lesser_eigenvalue(r));
    answers[ORACLE_IS_STEEP] = change(view, s, normal) / ORACLE_AUTO_CHANGE - 1.0;
    answers[ORACLE_IS_CLOSE] = reach / s->p[2] - 0.25;
  }
}

void conic_oracle_answer(const double answers[ORACLE_N_QUESTIONS], int is_so[ORACLE_N_QUESTIONS]) {
  for (int i = 0; i < ORACLE_N_QUESTIONS; i++) /* on the very border, as the page has it */
    is_so[i] = i == ORACLE_IS_BACK || i == ORACLE_IS_THIN || i == ORACLE_IS_BAND_NARROW || i == ORACLE_IS_COARSE ||
                       i == ORACLE_IS_STEEP
                   ? answers[i] > 0.0
                   : answers[i] >= 0.0;
}

oracle_formula conic_oracle_choose(const oracle_view *view, const int is_so[ORACLE_N_QUESTIONS]) {
  if (is_so[ORACLE_IS_BEHIND] || is_so[ORACLE_HAS_NO_PLANE] || (view->cull_back && is_so[ORACLE_IS_BACK]))
    return ORACLE_NOT_DRAWN;
  if (is_so[ORACLE_REACHES_NEAR])
    return is_so[ORACLE_IS_BAND_NARROW] ? ORACLE_SEGMENT : ORACLE_RAY;
  if (view->method == CONIC_METHOD_DISC)
    return ORACLE_DISC;
  if (view->method == CONIC_METHOD_POINT)
    return ORACLE_POINT;
  if (view->method == CONIC_METHOD_AFFINE) /* thin or not, the variance of the centre's Jacobian */
    return ORACLE_AFFINE;
  if (is_so[ORACLE_IS_THIN])
    return ORACLE_CONIC;
  if (view->method == CONIC_METHOD_AUTO && is_so[ORACLE_IS_COARSE])
    return is_so[ORACLE_IS_STEEP] ? ORACLE_LAPLACE : ORACLE_RAY;
  if (view->method == CONIC_METHOD_AUTO)
    return ORACLE_CONIC;
  if (view->method == CONIC_METHOD_RAY || is_so[ORACLE_IS_CLOSE])
    return ORACLE_RAY;
  return ORACLE_CONIC;
}
