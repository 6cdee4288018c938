/* From a model to splats. Points with good axes keep them, vertices get theirs from their faces, and the rest from the
 * neighbours. Everything is computed beside the model, which changes only when nothing can fail any more. */
#include "core/estimate/estimate.h"
#include "core/splats/columns.h"
#include "core/splats/degrees.h"

#include <stdatomic.h>

#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/estimate/features.h"
#include "core/splats/clip.h"

CONIC_DEFINE_OPTIONS(conic_estimate_options, .n_neighbours = 20, .cutoff = 1.5f)

int conic_unit_vector(float *const arrays[3], size_t i, double unit[3]) {
  conic_vector_at(arrays, i, unit);
  return conic_normalize(unit);
}

/* The unit normal of tangent axes; 0 where they span no ellipse. */
static int axes_normal(float *const tangent_u[3], float *const tangent_v[3], size_t point, double normal[3]) {
  double u[3], v[3];
  if (!conic_unit_vector(tangent_u, point, u) || !conic_unit_vector(tangent_v, point, v))
    return 0;
  conic_cross(u, v, normal);
  return conic_normalize(normal);
}

/* Axes that span no ellipse but are not zero, such as two parallel ones, are the file's own and kept: the renderer
 * draws them as far as it can. */
static int has_good_axes(const conic_splats *points, size_t point) {
  double u[3], v[3];
  if (!points->tangent_u[0])
    return 0;
  conic_vector_at(points->tangent_u, point, u);
  conic_vector_at(points->tangent_v, point, v);
  double square_u = conic_dot(u, u), square_v = conic_dot(v, v);
  return square_u > 0.0 && square_v > 0.0 && square_u - square_u == 0.0 && square_v - square_v == 0.0;
}

static int has_bad_color(const conic_splats *points, size_t point) {
  return points->color[0] && !(conic_is_finite(points->color[0][point]) && conic_is_finite(points->color[1][point]) &&
                               conic_is_finite(points->color[2][point]));
}

/* An invalid colour becomes white, as a missing one is. */
static void whiten_bad_colors(void *data, size_t begin, size_t end) {
  const conic_splats *points = data;
  for (size_t i = begin; i < end; i++)
    if (has_bad_color(points, i))
      for (int channel = 0; channel < 3; channel++)
        points->color[channel][i] = 1.0f;
}

static conic_point_state classify_point(const conic_splats *points, size_t i) {
  int is_somewhere = conic_is_finite(points->position[0][i]) && conic_is_finite(points->position[1][i]) &&
                     conic_is_finite(points->position[2][i]);
  return !is_somewhere ? CONIC_POINT_NOWHERE : has_good_axes(points, i) ? CONIC_POINT_KEPT : CONIC_POINT_RAW;
}

static void classify_points(void *data, size_t begin, size_t end) {
  conic_estimate *estimate = data;
  for (size_t i = begin; i < end; i++)
    estimate->states[i] = (uint8_t)classify_point(&estimate->model->points, i);
}

/* The normal that a point has before any is guessed: its axes', else the file's. */
static int known_normal(const conic_estimate *estimate, size_t point, double normal[3]) {
  const conic_splats *points = &estimate->model->points;
  int state = estimate->states[point];
  if (state == CONIC_POINT_KEPT)
    return axes_normal(points->tangent_u, points->tangent_v, point, normal);
  if (state == CONIC_POINT_FACED)
    return axes_normal(estimate->tangent_u, estimate->tangent_v, point, normal);
  return points->normal[0] && conic_unit_vector(points->normal, point, normal);
}

/* Marks the slots that the raw points need, and takes their normals from the first of their points that has one.
 * Returns whether normals must be guessed. */
static int mark_slots(const conic_estimate *estimate, conic_neighbourhood *neighbourhood) {
  const conic_neighbours *tree = &neighbourhood->tree;
  int is_any_guessed = 0;
  for (size_t i = 0; i < tree->n_points; i++) {
    double normal[3];
    size_t slot = tree->slot_of_point[i];
    if (slot == CONIC_NO_SLOT)
      continue;
    if (estimate->states[i] == CONIC_POINT_RAW)
      neighbourhood->flags[slot] |= CONIC_SLOT_WANTED;
    const float *known = neighbourhood->normals[slot];
    if (known[0] == 0.0f && known[1] == 0.0f && known[2] == 0.0f && known_normal(estimate, i, normal))
      for (int axis = 0; axis < 3; axis++)
        neighbourhood->normals[slot][axis] = (float)normal[axis];
  }
  for (size_t slot = 0; slot < tree->n_slots; slot++) {
    const float *known = neighbourhood->normals[slot];
    if (neighbourhood->flags[slot] & CONIC_SLOT_WANTED && known[0] == 0.0f && known[1] == 0.0f && known[2] == 0.0f) {
      neighbourhood->flags[slot] |= CONIC_SLOT_GUESSED;
      is_any_guessed = 1;
    }
  }
  return is_any_guessed;
}

/* Finds the neighbours of the wanted slots, and of their neighbours, whose spacings are needed, too. */
static conic_status find_neighbours(conic_context *context, conic_neighbourhood *neighbourhood) {
  conic_status status = conic_neighbourhood_list(context, neighbourhood, CONIC_SLOT_WANTED, 0.1, 0.4);
  if (status != CONIC_OK)
    return status;
  conic_neighbourhood_spread(neighbourhood, CONIC_SLOT_WANTED, CONIC_SLOT_NEAR);
  return conic_neighbourhood_list(context, neighbourhood, CONIC_SLOT_NEAR, 0.4, 0.45);
}

static conic_status estimate_in(conic_context *context, conic_estimate *estimate, conic_neighbourhood *neighbourhood,
                                double *spacings) {
  int is_any_guessed = mark_slots(estimate, neighbourhood);
  conic_status status = find_neighbours(context, neighbourhood);
  if (status == CONIC_OK && is_any_guessed)
    status = conic_normals_guess(context, neighbourhood, 0.45, 0.5);
  if (status == CONIC_OK && is_any_guessed && estimate->model->points.sight[0])
    conic_normals_turn_to_sights(neighbourhood, estimate->model->points.sight);
  if (status == CONIC_OK && is_any_guessed)
    status = conic_normals_orient(context, neighbourhood);
  if (status == CONIC_OK && estimate->dot)
    status = conic_scatter_find(context, neighbourhood, 0.55, 0.6);
  if (status == CONIC_OK)
    status = conic_estimate_spacings(context, neighbourhood, spacings);
  return status == CONIC_OK ? conic_estimate_from_neighbours(context, estimate, neighbourhood, spacings) : status;
}

static conic_status estimate_raw(conic_context *context, const conic_estimate_options *options,
                                 conic_estimate *estimate, conic_repairs *repairs) {
  const conic_splats *points = &estimate->model->points;
  const float *const positions[3] = {points->position[0], points->position[1], points->position[2]};
  conic_neighbourhood neighbourhood;
  conic_status status = conic_progress(context, "estimate", 0.0);
  if (status == CONIC_OK)
    status =
        conic_neighbourhood_create(context, positions, points->count, (size_t)options->n_neighbours, &neighbourhood);
  if (status != CONIC_OK)
    return status;
  repairs->duplicate = neighbourhood.tree.n_duplicates;
  double *spacings = conic_memory_allocate_zeroed(context, neighbourhood.tree.n_slots, sizeof *spacings);
  status = spacings ? estimate_in(context, estimate, &neighbourhood, spacings) : CONIC_ERROR_MEMORY;
  conic_memory_release(context, spacings);
  conic_neighbourhood_release(context, &neighbourhood);
  return status;
}

static size_t count_states(const conic_estimate *estimate, conic_point_state state) {
  size_t n = 0;
  for (size_t i = 0; i < estimate->model->points.count; i++)
    n += estimate->states[i] == state;
  return n;
}

/* Points whose file had axes, or normals, but no usable ones. */
static size_t count_zero(const conic_estimate *estimate) {
  const conic_splats *points = &estimate->model->points;
  size_t n = 0;
  for (size_t i = 0; i < points->count; i++) {
    double unit[3];
    if (estimate->states[i] == CONIC_POINT_NOWHERE || estimate->states[i] == CONIC_POINT_KEPT)
      continue;
    n += points->tangent_u[0] || (points->normal[0] && !conic_unit_vector(points->normal, i, unit));
  }
  return n;
}

static size_t count_dots(const conic_estimate *estimate) {
  size_t n = 0;
  for (size_t i = 0; estimate->dot && i < estimate->model->points.count; i++)
    n += estimate->dot[i] != 0.0f;
  return n;
}

static void count_repairs(const conic_estimate *estimate, conic_repairs *repairs) {
  repairs->nan = count_states(estimate, CONIC_POINT_NOWHERE);
  repairs->isolated = count_states(estimate, CONIC_POINT_ISOLATED);
  repairs->failed = count_states(estimate, CONIC_POINT_FAILED);
  repairs->zero = count_zero(estimate);
  repairs->dots = count_dots(estimate);
}

static int has_new_axes(const void *cookie, uint32_t splat) {
  return ((const conic_estimate *)cookie)->states[splat] != CONIC_POINT_KEPT;
}

/* Lines are in units of the axes, and mean nothing with other axes. Returns how many records were wrong. */
static size_t drop_clips(const conic_estimate *estimate, conic_splats *points) {
  size_t n_wrong = conic_splats_repair_clips(points), n = points->n_clips;
  conic_clip_filter(points, has_new_axes, estimate);
  return n_wrong + n - points->n_clips;
}

/* Says which splats are dots, where any is one. */
static void hand_over_dots(conic_estimate *estimate, conic_model *model) {
  float *own = model->points.dot;
  for (size_t i = 0; own && estimate->dot && i < model->points.count; i++)
    own[i] = estimate->states[i] == CONIC_POINT_KEPT ? own[i] : estimate->dot[i];
  if (!own && count_dots(estimate)) {
    model->points.dot = estimate->dot;
    estimate->dot = NULL;
  }
}

/* Gives the model its axes. Cannot fail: a set with axes gets the new ones among its own, a set without takes the
 * arrays. */
static void hand_over_axes(conic_estimate *estimate, conic_model *model) {
  int keeps_all = model->points.tangent_u[0] && count_states(estimate, CONIC_POINT_KEPT) == model->points.count;
  for (int axis = 0; axis < 3 && !keeps_all; axis++)
    for (int i_tangent = 0; i_tangent < 2; i_tangent++) {
      float **own = i_tangent ? &model->points.tangent_v[axis] : &model->points.tangent_u[axis];
      float **made = i_tangent ? &estimate->tangent_v[axis] : &estimate->tangent_u[axis];
      for (size_t i = 0; i < model->points.count; i++) {
        int state = estimate->states[i];
        if (state == CONIC_POINT_NOWHERE || state == CONIC_POINT_FAILED)
          (*made)[i] = NAN;
        if (*own && state != CONIC_POINT_KEPT)
          (*own)[i] = (*made)[i];
      }
      if (!*own) {
        *own = *made;
        *made = NULL;
      }
    }
  hand_over_dots(estimate, model);
}

int conic_splats_repair_alone(conic_splats *splats, size_t *n_nowhere) {
  for (size_t i = 0; i < splats->count; i++) {
    conic_point_state state = classify_point(splats, i);
    if (state == CONIC_POINT_RAW)
      return 0;
    for (int axis = 0; axis < 3 && state == CONIC_POINT_NOWHERE; axis++)
      splats->tangent_u[axis][i] = splats->tangent_v[axis][i] = NAN;
    *n_nowhere += state == CONIC_POINT_NOWHERE;
  }
  whiten_bad_colors(splats, 0, splats->count);
  return 1;
}

static conic_status allocate_estimate(conic_context *context, int finds_dots, conic_estimate *estimate) {
  size_t count = estimate->model->points.count;
  int is_good = 1;
  if (finds_dots) {
    estimate->dot = conic_memory_allocate_zeroed(context, count, sizeof(float));
    is_good = estimate->dot != NULL;
  }
  for (int axis = 0; axis < 3; axis++) {
    estimate->tangent_u[axis] = conic_memory_allocate(context, count, sizeof(float));
    estimate->tangent_v[axis] = conic_memory_allocate(context, count, sizeof(float));
    is_good = is_good && estimate->tangent_u[axis] && estimate->tangent_v[axis];
  }
  return is_good ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status estimate_model(conic_context *context, const conic_estimate_options *options,
                                   conic_estimate *estimate, conic_repairs *repairs) {
  conic_status status = conic_slots_for(context, estimate->model->points.count, classify_points, estimate, 0.0, 0.0);
  if (status == CONIC_OK)
    status = allocate_estimate(context, options->finds_dots, estimate);
  if (status == CONIC_OK && estimate->model->n_triangles)
    status = conic_estimate_from_faces(context, estimate);
  if (status == CONIC_OK && count_states(estimate, CONIC_POINT_RAW))
    status = estimate_raw(context, options, estimate, repairs);
  return status;
}

static conic_status estimate_plain(conic_context *context, const conic_estimate_options *options, conic_model *model,
                                   conic_repairs *repairs) {
  conic_repairs counted = {0};
  conic_estimate estimate = {model, (double)options->cutoff, NULL, {NULL}, {NULL}, NULL, options->ellipse, INFINITY};
  if (options->stays_at_mesh || options->feature_angle_deg > 0.0)
    estimate.tolerance = conic_mesh_tolerance(context, &model->points);
  estimate.states = conic_memory_allocate(context, model->points.count, sizeof *estimate.states);
  conic_status status = CONIC_ERROR_MEMORY;
  if (estimate.states)
    status = estimate_model(context, options, &estimate, &counted);
  if (status == CONIC_OK)
    status = conic_slots_for(context, model->points.count, whiten_bad_colors, &model->points, 1.0, 1.0);
  if (status == CONIC_OK) {
    count_repairs(&estimate, &counted);
    counted.clip = drop_clips(&estimate, &model->points);
    hand_over_axes(&estimate, model);
    if (repairs)
      *repairs = counted;
  }
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release_these(context, estimate.tangent_u[axis], estimate.tangent_v[axis]);
  conic_memory_release_these(context, estimate.dot, estimate.states);
  return status;
}

conic_status conic_model_take_axes(conic_context *context, conic_model *model, float *const tangent_u[3],
                                   float *const tangent_v[3], float *dot) {
  conic_estimate estimate = {.model = model};
  estimate.states = conic_memory_allocate_zeroed(context, model->points.count, sizeof *estimate.states);
  if (!estimate.states)
    return CONIC_ERROR_MEMORY;
  memcpy(estimate.tangent_u, tangent_u, sizeof estimate.tangent_u);
  memcpy(estimate.tangent_v, tangent_v, sizeof estimate.tangent_v);
  drop_clips(&estimate, &model->points);
  hand_over_axes(&estimate, model);
  whiten_bad_colors(&model->points, 0, model->points.count);
  model->points.dot = dot ? dot : model->points.dot;
  conic_memory_release(context, estimate.states);
  return CONIC_OK;
}

static int is_dot(const void *cookie, uint32_t splat) {
  return ((const float *)cookie)[splat] != 0.0f;
}

/* Points: their splats are estimated as usual, in a copy, and then sharpened; dots have no edges. */
static conic_status estimate_sharp_points(conic_context *context, const conic_estimate_options *options, double cosine,
                                          conic_model *model, conic_repairs *repairs) {
  conic_model copy = {.kind = model->kind, .triangles = model->triangles, .n_triangles = model->n_triangles};
  memcpy(copy.points.origin, model->points.origin, sizeof copy.points.origin);
  memcpy(copy.up, model->up, sizeof copy.up);
  conic_status status = conic_splats_append(context, &copy.points, &model->points);
  if (status == CONIC_OK)
    status = estimate_plain(context, options, &copy, repairs);
  if (status == CONIC_OK && copy.points.n_clips == 0)
    status = conic_features_in_points(context, cosine, 0, options, &copy.points);
  if (status == CONIC_OK && copy.points.dot)
    conic_clip_filter(&copy.points, is_dot, copy.points.dot);
  conic_splats_release(context, status == CONIC_OK ? &model->points : &copy.points);
  if (status == CONIC_OK)
    model->points = copy.points;
  return status;
}

/* A set, and the findings in it. */
typedef struct sound_search {
  const conic_splats *splats;
  atomic_int is_unsound;
} sound_search;

/* Two floats at once, as bits: this runs for every picture of a caller's arrays. */
static uint64_t two_floats(const float *column, size_t i) {
  uint64_t bits;
  memcpy(&bits, column + i, sizeof bits);
  return bits & UINT64_C(0x7FFFFFFF7FFFFFFF); /* without their signs */
}

/* The uppermost bit of each half says whether that float is infinite or NaN. */
static uint64_t two_not_finite(uint64_t two) {
  return two + UINT64_C(0x0080000000800000);
}

/* The uppermost bit of each half says whether that float is zero. */
static uint64_t two_zeros(uint64_t two) {
  return ~(two + UINT64_C(0x7FFFFFFF7FFFFFFF));
}

static inline uint64_t two_unsound_axes(float *const axes[3], size_t i) {
  uint64_t x = two_floats(axes[0], i), y = two_floats(axes[1], i), z = two_floats(axes[2], i);
  return two_not_finite(x) | two_not_finite(y) | two_not_finite(z) | two_zeros(x | y | z);
}

static inline uint64_t two_unsound_points(float *const columns[3], size_t i) {
  return two_not_finite(two_floats(columns[0], i)) | two_not_finite(two_floats(columns[1], i)) |
         two_not_finite(two_floats(columns[2], i));
}

static inline uint64_t two_unsound(const conic_splats *s, float *const colors[3], size_t i) {
  return two_unsound_axes(s->tangent_u, i) | two_unsound_axes(s->tangent_v, i) | two_unsound_points(s->position, i) |
         two_unsound_points(colors, i);
}

static void look_for_unsound(void *data, size_t begin, size_t end) {
  sound_search *search = data;
  const conic_splats *s = search->splats;
  float *const *colors = s->color[0] ? s->color : s->position;
  uint64_t found = 0;
  for (size_t i = begin; i + 1 < end; i += 2)
    found |= two_unsound(s, colors, i);
  if ((end - begin) % 2)
    found |= two_unsound(s, colors, end - 2); /* of an odd number, the last but one is checked twice */
  if (found & UINT64_C(0x8000000080000000))
    atomic_store(&search->is_unsound, 1);
}

int conic_splats_need_no_repair(conic_context *context, const conic_splats *splats) {
  sound_search search = {.splats = splats};
  return splats->count > 1 && splats->tangent_u[0] && splats->n_clips == 0 &&
         conic_slots_for(context, splats->count, look_for_unsound, &search, 0.0, 0.0) == CONIC_OK &&
         !atomic_load(&search.is_unsound);
}

conic_status conic_model_to_splats(conic_context *context, const conic_estimate_options *given, conic_model *model,
                                   conic_repairs *repairs) {
  conic_estimate_options own, *options = &own;
  conic_estimate_options_init(options);
  if (!model || !conic_options_take(options, given) || options->n_neighbours < 6 ||
      options->n_neighbours > CONIC_MAX_NEIGHBOURS || !(options->cutoff > 0.0f) || !conic_is_finite(options->cutoff) ||
      !(options->feature_angle_deg >= 0.0 && options->feature_angle_deg <= 90.0) ||
      (options->ellipse != CONIC_ELLIPSE_VORONOI && options->ellipse != CONIC_ELLIPSE_BOUNDING))
    return conic_fail(
        context, CONIC_ERROR_ARGUMENT,
        "estimate: wrong options (6 to %d neighbours, a cutoff above 0, a feature angle of 0 to 90, a rule "
        "for ellipses)",
        CONIC_MAX_NEIGHBOURS);
  if (model->n_triangles && !model->triangles)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "estimate: the model has no triangles");
  conic_status status = conic_splats_check_own(context, "estimate", &model->points);
  if (status != CONIC_OK)
    return status;
  if (model->n_triangles == 0 && !model->points.tangent_u[0] && conic_points_are_degrees(&model->points))
    conic_log(context, CONIC_LOG_WARNING,
              "x and y are degrees of longitude and latitude, beside heights in metres: what becomes of them is a "
              "needle; reproject them, as pdal does by filters.reprojection");
  double angle = options->feature_angle_deg, cosine = angle > 0.0 ? conic_cos(conic_radians(angle)) : -1.0;
  int is_mesh = model->n_triangles && !model->points.tangent_u[0];
  if (angle > 0.0 && model->points.count && !is_mesh)
    return estimate_sharp_points(context, options, cosine, model, repairs);
  status = estimate_plain(context, options, model, repairs);
  return status == CONIC_OK && is_mesh && (angle > 0.0 || options->stays_at_mesh)
             ? conic_mesh_bound(context, (double)options->cutoff, cosine, model, repairs)
             : status;
}
