/* Ellipses of points chosen from more. Each covers, in its plane, the outlines of all points that it stands for, so
 * that the chosen points cover what all points did, and end where those do. */

#include "cli/commands/mls_sizes.h"
#include "core/base/vectors.h"
#include "core/estimate/estimate.h"
#include "core/splats/ellipse.h"
#include "core/splats/splats_gather.h"

enum { CHUNK = 256, N_DIRECTIONS = 6, N_OWNERS = 8 };

/* A point can stand for another that is less than 60° off its plane, if their normals differ by less than 78°. */
static const double GREATEST_SLOPE = 0.866, LEAST_COSINE = 0.2;

/* The ellipse of an even cluster reaches at most so many times as far as its farthest place. */
static const double GREATEST_REACH = 1.1;

/* The part of the way to a point's rim that must be covered: outlines overlap. */
static const double TO_RIM = 0.8;

typedef struct thin_sizing {
  const conic_splats *whole; /* with ellipses */
  conic_splats *thinned;
  conic_neighbours tree; /* of the thinned points */
  double cutoff;
  uint32_t *origins; /* by thinned point: its number in the whole set */
  uint32_t *owners;  /* by point of the whole set: the thinned point that stands for it; CONIC_NO_SLOT: none */
  uint32_t *starts;  /* by thinned point: where its points begin in `owned` */
  uint32_t *owned;
  double (*places)[2]; /* for each thread: the outlines of the largest cluster */
  size_t n_largest;
} thin_sizing;

static int stands_as_dot(const conic_splats *splats, size_t i) {
  return splats->dot && splats->dot[i] != 0.0f;
}

/* A splat's axes and unit normal; returns 0 where they span no ellipse. */
static int axes_of(const conic_splats *splats, size_t i, double u[3], double v[3], double normal[3]) {
  conic_vector_at(splats->tangent_u, i, u);
  conic_vector_at(splats->tangent_v, i, v);
  conic_cross(u, v, normal);
  return conic_normalize(normal);
}

static void vector_between(const conic_splats *splats, size_t from, size_t to, double d[3]) {
  for (int axis = 0; axis < 3; axis++)
    d[axis] = (double)splats->position[axis][to] - (double)splats->position[axis][from];
}

/* The thinned points are some of the whole set, in its order. */
static void find_origins(thin_sizing *work) {
  const conic_splats *whole = work->whole, *thinned = work->thinned;
  for (size_t i = 0, j = 0; i < thinned->count; i++, j++) {
    while (j < whole->count &&
           !(whole->position[0][j] == thinned->position[0][i] && whole->position[1][j] == thinned->position[1][i] &&
             whole->position[2][j] == thinned->position[2][i]))
      j++;
    work->origins[i] = j < whole->count ? (uint32_t)j : CONIC_NO_SLOT;
  }
}

/* Whether a thinned point is on the same sheet as this point, or both are dots. */
static int can_own(const conic_splats *whole, size_t origin, size_t i, const double normal[3]) {
  double u[3], v[3], own[3], d[3];
  if (stands_as_dot(whole, i) || stands_as_dot(whole, origin))
    return stands_as_dot(whole, i) && stands_as_dot(whole, origin);
  vector_between(whole, origin, i, d);
  if (!axes_of(whole, origin, u, v, own) || conic_dot(own, normal) < LEAST_COSINE)
    return 0;
  double height = conic_dot(d, own);
  return height * height <= GREATEST_SLOPE * GREATEST_SLOPE * conic_dot(d, d);
}

/* The nearest thinned point on the same sheet, else the very nearest. */
static uint32_t owner_of(const thin_sizing *work, size_t i) {
  const conic_splats *whole = work->whole;
  uint32_t slots[N_OWNERS];
  double u[3], v[3], normal[3], distances2[N_OWNERS];
  const double place[3] = {(double)whole->position[0][i], (double)whole->position[1][i], (double)whole->position[2][i]};
  if (!axes_of(whole, i, u, v, normal) || !(conic_dot(place, place) < HUGE_VAL))
    return CONIC_NO_SLOT;
  size_t n = conic_neighbours_nearest(&work->tree, place, CONIC_NO_SLOT, N_OWNERS, HUGE_VAL, slots, distances2);
  for (size_t k = 0; k < n; k++) {
    uint32_t owner = work->tree.point_of_slot[slots[k]];
    if (distances2[k] == 0.0 ||
        (work->origins[owner] != CONIC_NO_SLOT && can_own(whole, work->origins[owner], i, normal)))
      return owner;
  }
  return n && !stands_as_dot(whole, i) ? work->tree.point_of_slot[slots[0]] : CONIC_NO_SLOT;
}

static void find_owners(void *data, size_t i_item) {
  thin_sizing *work = data;
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < work->whole->count; i++)
    work->owners[i] = owner_of(work, i);
}

/* Lists the points that each owns, in the order of the whole set. */
static void list_owned(thin_sizing *work) {
  size_t n = work->thinned->count;
  for (size_t i = 0; i < work->whole->count; i++)
    if (work->owners[i] != CONIC_NO_SLOT)
      work->starts[work->owners[i]]++;
  for (size_t i = 0; i <= n; i++) { /* first where each list ends; then, going backwards, where it begins */
    work->n_largest = work->starts[i] > work->n_largest ? work->starts[i] : work->n_largest;
    work->starts[i] += i ? work->starts[i - 1] : 0;
  }
  for (size_t i = work->whole->count; i-- > 0;)
    if (work->owners[i] != CONIC_NO_SLOT)
      work->owned[--work->starts[work->owners[i]]] = (uint32_t)i;
}

/* A point's outline, projected along the normal onto the plane of (u, v) about the origin. */
static size_t lay_outline(const thin_sizing *work, size_t origin, size_t i, const double u[3], const double v[3],
                          double (*places)[2]) {
  static const double turns[N_DIRECTIONS][2] = {{1.0, 0.0},  {0.5, 0.8660254037844386},   {-0.5, 0.8660254037844386},
                                                {-1.0, 0.0}, {-0.5, -0.8660254037844386}, {0.5, -0.8660254037844386}};
  double own_u[3], own_v[3], normal[3], to[3];
  axes_of(work->whole, i, own_u, own_v, normal);
  vector_between(work->whole, origin, i, to);
  for (int k = 0; k < N_DIRECTIONS; k++) {
    double d[3], reach = TO_RIM * work->cutoff;
    for (int axis = 0; axis < 3; axis++)
      d[axis] = to[axis] + reach * (turns[k][0] * own_u[axis] + turns[k][1] * own_v[axis]);
    places[k][0] = conic_dot(d, u);
    places[k][1] = conic_dot(d, v);
  }
  return N_DIRECTIONS;
}

static void size_dot(const thin_sizing *work, size_t i, const conic_splats *whole, size_t origin) {
  double own = 0.0, sum = 0.0;
  for (uint32_t k = work->starts[i]; k < work->starts[i + 1]; k++) {
    double u[3], v[3], normal[3];
    axes_of(whole, work->owned[k], u, v, normal);
    sum += stands_as_dot(whole, work->owned[k]) ? conic_dot(u, u) : 0.0;
    own = work->owned[k] == origin ? conic_dot(u, u) : own;
  }
  for (int axis = 0; axis < 3 && own > 0.0 && sum > own; axis++) {
    work->thinned->tangent_u[axis][i] = (float)(sqrt(sum / own) * (double)work->thinned->tangent_u[axis][i]);
    work->thinned->tangent_v[axis][i] = (float)(sqrt(sum / own) * (double)work->thinned->tangent_v[axis][i]);
  }
}

static void size_point(const thin_sizing *work, size_t i, double (*places)[2]) {
  const conic_splats *whole = work->whole;
  conic_splats *thinned = work->thinned;
  double u[3], v[3], normal[3], farthest2 = 0.0;
  size_t origin = work->origins[i], n = 0;
  float tangent_u[3], tangent_v[3];
  for (int axis = 0; axis < 3; axis++) {
    thinned->tangent_u[axis][i] = origin != CONIC_NO_SLOT ? whole->tangent_u[axis][origin] : NAN;
    thinned->tangent_v[axis][i] = origin != CONIC_NO_SLOT ? whole->tangent_v[axis][origin] : NAN;
  }
  if (origin == CONIC_NO_SLOT || !axes_of(whole, origin, u, v, normal))
    return;
  if (thinned->dot)
    thinned->dot[i] = stands_as_dot(whole, origin) ? 1.0f : 0.0f;
  if (stands_as_dot(whole, origin)) {
    size_dot(work, i, whole, origin);
    return;
  }
  if (work->starts[i + 1] - work->starts[i] < 2)
    return; /* it stands only for itself */
  conic_tangent_basis(normal, u, v);
  for (uint32_t k = work->starts[i]; k < work->starts[i + 1]; k++)
    n += lay_outline(work, origin, work->owned[k], u, v, places + n);
  for (size_t k = 0; k < n; k++) {
    double distance2 = places[k][0] * places[k][0] + places[k][1] * places[k][1];
    farthest2 = distance2 > farthest2 ? distance2 : farthest2;
  }
  conic_ellipse ellipse = conic_ellipse_bound((const double(*)[2])places, (int)n, CONIC_OUTLINE_RATIO);
  conic_ellipse_retract(&ellipse, (const double(*)[2])places, (int)n, GREATEST_REACH * sqrt(farthest2));
  if (!conic_ellipse_axes(&ellipse, u, v, work->cutoff, tangent_u, tangent_v))
    return;
  for (int axis = 0; axis < 3; axis++) {
    thinned->tangent_u[axis][i] = tangent_u[axis];
    thinned->tangent_v[axis][i] = tangent_v[axis];
  }
}

static void size_points(void *data, size_t i_item, int i_thread) {
  const thin_sizing *work = data;
  double(*places)[2] = work->places + (size_t)i_thread * N_DIRECTIONS * work->n_largest;
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < work->thinned->count; i++)
    size_point(work, i, places);
}

static conic_status size_all(conic_context *context, thin_sizing *work) {
  size_t n = work->thinned->count, n_whole = work->whole->count;
  if (conic_memory_allocate_these(context, CONIC_ROOM(work->origins, n), CONIC_ROOM(work->owners, n_whole),
                                  CONIC_ROOM(work->owned, n_whole), CONIC_ZEROED(work->starts, n + 1)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  find_origins(work);
  conic_parallel_for(context, (n_whole + CHUNK - 1) / CHUNK, find_owners, work);
  list_owned(work);
  size_t n_places = (size_t)conic_context_threads(context) * N_DIRECTIONS * work->n_largest;
  work->places = conic_memory_allocate(context, n_places, sizeof *work->places);
  if (!work->places)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(context, (n + CHUNK - 1) / CHUNK, size_points, work);
  return CONIC_OK;
}

/* Gives the whole set the ellipses of its own picture. */
static conic_status size_whole(conic_context *context, const conic_model *from, const conic_estimate_options *options,
                               conic_model *whole) {
  whole->triangles = from->triangles;
  whole->n_triangles = from->n_triangles;
  memcpy(whole->points.origin, from->points.origin, sizeof whole->points.origin);
  conic_status status = conic_splats_append(context, &whole->points, &from->points);
  return status == CONIC_OK ? conic_model_to_splats(context, options, whole, NULL) : status;
}

conic_status cli_mls_size_thinned(conic_context *context, const conic_model *from, conic_splats *thinned) {
  conic_estimate_options options;
  conic_model whole = {.n_triangles = 0};
  conic_estimate_options_init(&options);
  options.finds_dots = !from->n_triangles;
  thin_sizing work = {.whole = &whole.points, .thinned = thinned, .cutoff = (double)options.cutoff};
  conic_status status = size_whole(context, from, &options, &whole);
  unsigned fields = conic_splats_fields(thinned) | CONIC_SPLATS_TANGENTS;
  if (status == CONIC_OK)
    status = conic_splats_resize(context, thinned, thinned->count,
                                 fields | (conic_splats_count_dots(&whole.points) ? CONIC_SPLATS_DOTS : 0));
  if (status == CONIC_OK)
    status = conic_neighbours_build(context, (const float *const *)thinned->position, thinned->count, &work.tree);
  if (status == CONIC_OK) {
    status = size_all(context, &work);
    conic_neighbours_release(context, &work.tree);
  }
  conic_memory_release_these(context, work.origins, work.owners, work.owned, work.starts, work.places);
  conic_splats_release(context, &whole.points);
  return status;
}
