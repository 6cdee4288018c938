#include "oracle/oracle_scene.h"

#include "core/splats/clip.h"

/* An axis is turned into camera space and sheared in single precision, so that each of its components may be off by a
 * rounding of the whole. */
oracle_placed conic_oracle_disturb(const oracle_view *view, const oracle_placed *placed, int i) {
  oracle_placed disturbed = *placed;
  if (i < 3)
    disturbed.tu[i] += view->floats.axis * oracle_length(placed->tu);
  else if (i < 6)
    disturbed.tv[i - 3] += view->floats.axis * oracle_length(placed->tv);
  else
    disturbed.p[i - 6] += placed->p_error[i - 6];
  return disturbed;
}

int conic_oracle_n_inputs(const oracle_view *view) {
  return view->floats.is_setup_in_float ? ORACLE_N_INPUTS : 6;
}

/* A place on the screen that is off is a centre that is. */
static void bound_centre(const oracle_view *view, const double world[3], oracle_placed *placed) {
  const conic_camera *c = &view->camera;
  const double px[3] = {(double)c->width / c->fx, (double)c->height / c->fy, 0.0};
  for (int i = 0; i < 3; i++) {
    double terms = fabs(c->cam_from_world[i][3]);
    for (int k = 0; k < 3; k++)
      terms += fabs(c->cam_from_world[i][k] * world[k]);
    placed->p_error[i] = view->floats.centre * terms + view->floats.place * px[i] * fabs(placed->p[2]);
  }
}

static void read_axis(float *const components[3], size_t i, double axis[3]) {
  for (int c = 0; c < 3; c++)
    axis[c] = (double)components[c][i];
}

static void rotate_to_camera(const conic_camera *camera, const double v[3], double result[3]) {
  for (int i = 0; i < 3; i++)
    result[i] = oracle_dot(camera->cam_from_world[i], v);
}

/* The splat's inputs in the world; 0 where one is not finite, or past what picture.md allows. */
static int read_splat(const conic_splats *splats, size_t i, oracle_placed *world, oracle_splat *splat) {
  read_axis(splats->position, i, world->p);
  read_axis(splats->tangent_u, i, world->tu);
  read_axis(splats->tangent_v, i, world->tv);
  splat->index = (uint32_t)i;
  splat->opacity = splats->opacity ? (double)splats->opacity[i] : 1.0;
  double sum = splat->opacity;
  for (int c = 0; c < 3; c++) {
    splat->color[c] = splats->color[0] ? (double)splats->color[c][i] : 1.0;
    sum += world->p[c] + world->tu[c] + world->tv[c] + splat->color[c];
  }
  for (int c = 0; c < 3; c++)
    if (fabs(splat->color[c]) > 1e18)
      return 0;
  return oracle_is_finite(sum) && splat->opacity <= 1e6;
}

/* 1e-4 × the diagonal of the box of the finite centres, as if that were 1 where it is 0. */
static double default_near(const conic_splats *splats) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, extent[3];
  for (size_t i = 0; i < splats->count; i++) {
    double p[3];
    read_axis(splats->position, i, p);
    if (!oracle_is_finite(p[0] + p[1] + p[2]))
      continue;
    for (int c = 0; c < 3; c++) {
      low[c] = oracle_min(low[c], p[c]);
      high[c] = oracle_max(high[c], p[c]);
    }
  }
  for (int c = 0; c < 3; c++)
    extent[c] = low[0] <= high[0] ? high[c] - low[c] : 0.0;
  double diagonal = oracle_length(extent);
  return 1e-4 * (diagonal > 0.0 ? diagonal : 1.0);
}

static double longer_axis(const oracle_placed *placed) {
  return oracle_max(oracle_length(placed->tu), oracle_length(placed->tv));
}

/* The lower median of the longer axes of the usable splats, which caps the automatic ε; 0 without any. */
static conic_status median_length(conic_context *context, const conic_splats *splats, double *median) {
  double *lengths = conic_memory_allocate(context, splats->count, sizeof *lengths);
  size_t n = 0;
  if (!lengths)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < splats->count; i++) {
    oracle_placed placed;
    read_axis(splats->position, i, placed.p);
    read_axis(splats->tangent_u, i, placed.tu);
    read_axis(splats->tangent_v, i, placed.tv);
    double u = oracle_length(placed.tu), v = oracle_length(placed.tv);
    if (oracle_is_finite(placed.p[0] + placed.p[1] + placed.p[2] + u + v) && u > 0.0 && v > 0.0)
      lengths[n++] = longer_axis(&placed);
  }
  *median = n ? conic_oracle_select(lengths, n, (n - 1) / 2) : 0.0;
  conic_memory_release(context, lengths);
  return CONIC_OK;
}

/* How far off an answer may be in single precision: what the rounded inputs make of it, and its own roundings. */
static void answer_errors(const oracle_view *view, const oracle_placed *placed,
                          const double answers[ORACLE_N_QUESTIONS], double errors[ORACLE_N_QUESTIONS]) {
  const double unit = view->floats.unit;
  double reach = view->cutoff * (fabs(placed->tu[2]) + fabs(placed->tv[2]));
  for (int i = 0; i < ORACLE_N_QUESTIONS; i++)
    errors[i] = 0.0;
  errors[ORACLE_IS_BEHIND] = errors[ORACLE_REACHES_NEAR] = unit * (fabs(placed->p[2]) + reach + view->near_z);
  errors[ORACLE_IS_BAND_NARROW] = unit * view->cutoff;
  errors[ORACLE_IS_CLOSE] = unit;
  errors[ORACLE_IS_STEEP] = 2.0 * unit * (1.0 + fabs(answers[ORACLE_IS_STEEP]));
  errors[ORACLE_IS_COARSE] = 2.0 * unit * (1.0 + fabs(answers[ORACLE_IS_COARSE]));
  oracle_shape shape;
  if (conic_oracle_shape(view, placed, ORACLE_CONIC, &shape)) {
    double sigma = oracle_max(view->thin_px - answers[ORACLE_IS_THIN], 0.5 * view->thin_px);
    errors[ORACLE_IS_THIN] = unit * oracle_greater_eigenvalue(shape.variance) / sigma;
  }
  for (int i = 0; i < conic_oracle_n_inputs(view); i++) {
    double disturbed[ORACLE_N_QUESTIONS];
    oracle_placed moved = conic_oracle_disturb(view, placed, i);
    conic_oracle_ask(view, &moved, disturbed);
    for (int j = 0; j < ORACLE_N_QUESTIONS; j++)
      errors[j] += fabs(disturbed[j] - answers[j]);
  }
}

/* Whether single precision may overflow, or lose what it needs to nothing, on the way. */
static int may_overflow(const oracle_view *view, const oracle_placed *placed) {
  const double high = 1e36, low = 1e-34;
  double p = oracle_length(placed->p), u = oracle_length(placed->tu), v = oracle_length(placed->tv);
  double focal = oracle_max(view->camera.fx, view->camera.fy), z = oracle_max(fabs(placed->p[2]), view->near_z);
  double longer = oracle_max(u, v), shorter = oracle_min(u, v);
  double pixels = longer * focal * p / (z * z);
  int is_dot =
      view->method == CONIC_METHOD_DISC || view->method == CONIC_METHOD_POINT; /* without an area to be formed */
  double area = is_dot ? 1.0 : pixels * pixels * pixels * pixels, volume = is_dot ? 1.0 : p * u * v;
  double large[] = {p * p, longer * longer, volume, area, 1.0 / (z * z), pixels};
  double small[] = {shorter * shorter, volume, is_dot ? 1.0 : u * v, z * z};
  for (size_t i = 0; i < sizeof large / sizeof large[0]; i++)
    if (!(large[i] < high))
      return 1;
  for (size_t i = 0; i < sizeof small / sizeof small[0]; i++)
    if (!(small[i] > low))
      return 1;
  return 0;
}

static void add_other(oracle_splat *splat, oracle_formula formula) {
  for (int i = 0; i < splat->n_others; i++)
    if (splat->others[i] == formula)
      return;
  if (formula != splat->formula && splat->n_others < ORACLE_MAX_OTHERS)
    splat->others[splat->n_others++] = formula;
}

/* Chooses the formula, and every formula that it would be with one of the answers rounded to the other side. */
static void choose_splats(const oracle_view *view, oracle_splat *splat) {
  double answers[ORACLE_N_QUESTIONS], errors[ORACLE_N_QUESTIONS];
  int is_so[ORACLE_N_QUESTIONS];
  conic_oracle_ask(view, &splat->placed, answers);
  conic_oracle_answer(answers, is_so);
  answer_errors(view, &splat->placed, answers, errors);
  splat->formula = conic_oracle_choose(view, is_so);
  splat->n_others = 0;
  for (int i = 0; i < ORACLE_N_QUESTIONS; i++) {
    if (fabs(answers[i]) > errors[i])
      continue;
    /* What is exactly without a plane is so however it is computed. */
    if (i == ORACLE_HAS_NO_PLANE && answers[i] == 0.0)
      continue;
    is_so[i] = !is_so[i];
    add_other(splat, conic_oracle_choose(view, is_so));
    is_so[i] = !is_so[i];
  }
  splat->is_facing_unsure = !(fabs(answers[ORACLE_IS_BACK]) > errors[ORACLE_IS_BACK]);
  if (splat->formula != ORACLE_NOT_DRAWN && may_overflow(view, &splat->placed))
    add_other(splat, ORACLE_NOT_DRAWN);
}

/* The box of all formulas together; 0 where none of them can be set up. */
static int bound(const oracle_view *view, oracle_splat *splat) {
  int n_set = 0;
  for (int i = -1; i < splat->n_others; i++) {
    oracle_shape shape;
    oracle_formula formula = i < 0 ? splat->formula : splat->others[i];
    if (formula == ORACLE_NOT_DRAWN || !conic_oracle_shape(view, &splat->placed, formula, &shape))
      continue;
    for (int axis = 0; axis < 2; axis++) {
      double margin = 1.0 + 1e-3 * (shape.box[1][axis] - shape.box[0][axis]);
      double low = shape.box[0][axis] - margin, high = shape.box[1][axis] + margin;
      splat->box[0][axis] = n_set ? oracle_min(splat->box[0][axis], low) : low;
      splat->box[1][axis] = n_set ? oracle_max(splat->box[1][axis], high) : high;
    }
    n_set++;
  }
  return n_set > 0;
}

static void set_appearance(const oracle_view *view, const conic_render_options *options, const oracle_placed *world,
                           double longest, oracle_splat *splat) {
  double normal[3], turned[3], length = longer_axis(world);
  oracle_cross(world->tu, world->tv, normal);
  rotate_to_camera(&view->camera, normal, turned);
  double scale = (oracle_dot(splat->placed.p, turned) > 0.0 ? -1.0 : 1.0) / oracle_length(normal);
  for (int c = 0; c < 3; c++) {
    splat->normal[c] = normal[c] * scale;
    double size = fabs(splat->normal[c]);
    splat->normals[0][c] = splat->is_facing_unsure ? -size : splat->normal[c];
    splat->normals[1][c] = splat->is_facing_unsure ? size : splat->normal[c];
  }
  splat->color_error = 0.0;
  splat->epsilon = options->epsilon;
  if (!(splat->epsilon >= 0.0)) /* automatic, with c = 1 */
    splat->epsilon = view->cutoff * oracle_min(length, 4.0 * longest);
  splat->behind = 1.0 / (1.0 + splat->epsilon / oracle_length(splat->placed.p));
}

/* Reads a splat and puts it before the camera; 0 where picture.md leaves it out. */
static int stand(const oracle_scene *scene, size_t i, oracle_placed *world, oracle_splat *splat) {
  const conic_camera *camera = &scene->view.camera;
  if (!read_splat(scene->splats, i, world, splat))
    return 0;
  for (int c = 0; c < 3; c++)
    world->p[c] += scene->splats->origin[c];
  rotate_to_camera(camera, world->p, splat->placed.p);
  for (int c = 0; c < 3; c++)
    splat->placed.p[c] += camera->cam_from_world[c][3];
  rotate_to_camera(camera, world->tu, splat->placed.tu);
  rotate_to_camera(camera, world->tv, splat->placed.tv);
  bound_centre(&scene->view, world->p, &splat->placed);
  return 1;
}

int conic_oracle_scene_place(const oracle_scene *scene, size_t i, oracle_splat *splat) {
  const oracle_view *view = &scene->view;
  const conic_splats *splats = scene->splats;
  oracle_placed world;
  if (!stand(scene, i, &world, splat))
    return 0;
  size_t i_clip = conic_clip_find(splats, i);
  int has_clip = i_clip < splats->n_clips && splats->clips[i_clip].splat == i;
  double extent = oracle_length(world.p);
  for (int c = 0; c < 3; c++)
    extent += fabs(view->camera.cam_from_world[c][3]);
  conic_oracle_clip(view, &splat->placed, has_clip ? &splats->clips[i_clip] : NULL, extent, &splat->clip);
  choose_splats(view, splat);
  if (splat->formula == ORACLE_NOT_DRAWN && !splat->n_others)
    return 0;
  set_appearance(view, scene->options, &world, scene->longest, splat);
  splat->is_anywhere = scene->is_brute;
  return bound(view, splat);
}

/* A box from the sphere about a disc that is far before the eye, in which all formulas' boxes lie: the sphere's own,
 * that of an axis under the Jacobian at p, and the circle of `disc`. 0 where it is not so far. */
static int reach_of_sphere(const oracle_view *view, const oracle_placed *s, double box[2][2]) {
  const conic_camera *c = &view->camera;
  const double focal[2] = {c->fx, c->fy}, principal[2] = {c->cx, c->cy};
  double z = s->p[2], radius = view->cutoff * sqrt(oracle_dot(s->tu, s->tu) + oracle_dot(s->tv, s->tv));
  if (!(z - 2.0 * radius > view->near_z) || !(z < 1e30))
    return 0;
  double circle = oracle_max(0.5, radius / z * oracle_max(focal[0], focal[1]));
  for (int axis = 0; axis < 2; axis++) {
    double p = s->p[axis], at = focal[axis] * p / z + principal[axis];
    double low = oracle_min((p - radius) / (z - radius), (p - radius) / (z + radius));
    double high = oracle_max((p + radius) / (z - radius), (p + radius) / (z + radius));
    double linear = focal[axis] * radius / z * sqrt(1.0 + p / z * (p / z));
    double half = oracle_max(circle, linear) + view->reach_px;
    box[0][axis] = oracle_min(focal[axis] * low + principal[axis] - view->reach_px, at - half);
    box[1][axis] = oracle_max(focal[axis] * high + principal[axis] + view->reach_px, at + half);
    double margin = 1.0 + 1e-3 * (box[1][axis] - box[0][axis]); /* as that of the splat itself */
    box[0][axis] -= margin;
    box[1][axis] += margin;
  }
  return 1;
}

/* As a float, rounded outwards. */
static float outwards(double x, double sign) {
  x = oracle_min(oracle_max(x, -1e9), 1e9);
  return (float)(x + sign * (0.01 + 1e-6 * fabs(x)));
}

static oracle_reach find_reach(const oracle_scene *scene, size_t i) {
  oracle_reach reach = {{{1.0f, 1.0f}, {-1.0f, -1.0f}}};
  oracle_placed world;
  oracle_splat splat;
  double box[2][2] = {{-INFINITY, -INFINITY}, {INFINITY, INFINITY}};
  if (!stand(scene, i, &world, &splat))
    return reach;
  if (!scene->is_brute && !reach_of_sphere(&scene->view, &splat.placed, box)) {
    if (!conic_oracle_scene_place(scene, i, &splat))
      return reach;
    memcpy(box, splat.box, sizeof box);
  }
  for (int axis = 0; axis < 2; axis++) {
    reach.box[0][axis] = outwards(box[0][axis], -1.0);
    reach.box[1][axis] = outwards(box[1][axis], 1.0);
  }
  return reach;
}

enum { A_RUN = 1024 };

static void find_reaches(void *data, size_t i_item) {
  oracle_scene *scene = data;
  for (size_t i = i_item * A_RUN; i < (i_item + 1) * A_RUN && i < scene->splats->count; i++)
    scene->reaches[i] = find_reach(scene, i);
}

conic_status conic_oracle_scene_create(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                       const conic_render_options *options, conic_float_kind floats, int is_brute,
                                       oracle_scene *scene) {
  scene->longest = options->splat_length; /* of all splats, where these are some that were chosen of them */
  scene->view =
      conic_oracle_view(camera, options, options->near_z > 0.0 ? options->near_z : default_near(splats), floats);
  scene->splats = splats;
  scene->options = options;
  scene->is_brute = is_brute;
  scene->reaches = conic_memory_allocate(context, splats->count, sizeof *scene->reaches);
  conic_status status = scene->reaches ? conic_oracle_profile_create(context, &scene->view) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK && !(scene->longest > 0.0))
    status = median_length(context, splats, &scene->longest);
  if (status == CONIC_OK)
    status = conic_parallel_runs(context, "verify", 0.0, 0.05, (splats->count + A_RUN - 1) / A_RUN, 256, find_reaches,
                                 scene);
  if (status != CONIC_OK)
    conic_oracle_scene_release(context, scene);
  return status;
}

void conic_oracle_scene_release(conic_context *context, oracle_scene *scene) {
  conic_oracle_profile_release(context, &scene->view);
  conic_memory_release(context, scene->reaches);
  scene->reaches = NULL;
}
