#include "cli/commands/mls_sizes.h"

#include "core/base/vectors.h"
#include "core/estimate/features.h"
#include "core/estimate/neighbours.h"
#include "core/splats/splats_gather.h"

/* Dense points are so even that few neighbours bound their cells. */
enum { CHUNK = 256, N_DIRECTIONS = 6, N_NEIGHBOURS = 12 };

/* Where a point's old outline is tested: this share of the way to its rim. */
static const double TO_RIM = 0.9;

/* How far a tested place may be above the surface, as a share of its distance from the point. */
static const double MOST_LIFT = 0.7;

/* The cosine of 30°. */
static const double CREASE_COSINE = 0.86602540378443865;

typedef struct outline_keeping {
  const conic_splats *from; /* the old points with their old ellipses */
  conic_splats *dense;
  conic_neighbours tree; /* of the dense points */
  double cutoff;
  uint8_t *is_kept; /* by old point */
} outline_keeping;

static double outline_radius(const outline_keeping *work, size_t i) {
  double u2 = 0.0, v2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double u = (double)work->dense->tangent_u[axis][i], v = (double)work->dense->tangent_v[axis][i];
    u2 += u * u;
    v2 += v * v;
  }
  return work->cutoff * sqrt(u2 > v2 ? u2 : v2);
}

/* Whether another dense point covers the place, which may be off that point's plane by up to `most`: the old outline is
 * a flat disc, which leaves a bent surface. */
static int is_covered(const outline_keeping *work, const double place[3], double most, uint32_t own_slot) {
  uint32_t slot;
  double distance2, u[3], v[3], normal[3], offset[3];
  if (!conic_neighbours_nearest(&work->tree, place, own_slot, 1, HUGE_VAL, &slot, &distance2))
    return 0;
  size_t i = work->tree.point_of_slot[slot];
  double radius = outline_radius(work, i);
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)work->dense->tangent_u[axis][i];
    v[axis] = (double)work->dense->tangent_v[axis][i];
    offset[axis] = place[axis] - (double)work->dense->position[axis][i];
  }
  conic_cross(u, v, normal);
  if (!conic_normalize(normal))
    return 0;
  double up = conic_dot(offset, normal);
  return fabs(up) <= most && distance2 - up * up <= radius * radius;
}

/* An old point keeps its ellipse if that covers a place that no point covers now, as at a border or beside a slit. */
static int keeps_outline(const outline_keeping *work, size_t i) {
  static const double turns[N_DIRECTIONS][2] = {{1.0, 0.0},  {0.5, 0.8660254037844386},   {-0.5, 0.8660254037844386},
                                                {-1.0, 0.0}, {-0.5, -0.8660254037844386}, {0.5, -0.8660254037844386}};
  const conic_splats *from = work->from;
  uint32_t slot = work->tree.slot_of_point[i];
  for (int k = 0; k < N_DIRECTIONS && slot != CONIC_NO_SLOT; k++) {
    double place[3], to_rim[3];
    for (int axis = 0; axis < 3; axis++) {
      to_rim[axis] = TO_RIM * work->cutoff *
                     (turns[k][0] * (double)from->tangent_u[axis][i] + turns[k][1] * (double)from->tangent_v[axis][i]);
      place[axis] = (double)from->position[axis][i] + to_rim[axis];
    }
    if (place[0] + place[1] + place[2] - (place[0] + place[1] + place[2]) != 0.0)
      return 0; /* it had no ellipse */
    if (!is_covered(work, place, MOST_LIFT * conic_length(to_rim), slot))
      return 1;
  }
  return 0;
}

static void keep_chunk(void *data, size_t i_item) {
  outline_keeping *work = data;
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < work->from->count; i++)
    work->is_kept[i] = (uint8_t)keeps_outline(work, i);
}

static void hand_over_outlines(const outline_keeping *work) {
  for (size_t i = 0; i < work->from->count; i++)
    for (int axis = 0; axis < 3 && work->is_kept[i]; axis++) {
      work->dense->tangent_u[axis][i] = work->from->tangent_u[axis][i];
      work->dense->tangent_v[axis][i] = work->from->tangent_v[axis][i];
    }
  for (size_t i = 0; i < work->from->count && work->from->dot; i++)
    work->dense->dot[i] = work->is_kept[i] ? work->from->dot[i] : 0.0f;
}

static conic_status keep_outlines(conic_context *context, const conic_splats *from, double cutoff,
                                  conic_splats *dense) {
  outline_keeping work = {.from = from, .dense = dense, .cutoff = cutoff};
  conic_status status = CONIC_OK;
  if (conic_splats_count_dots(from))
    status = conic_splats_resize(context, dense, dense->count, conic_splats_fields(dense) | CONIC_SPLATS_DOTS);
  if (status == CONIC_OK)
    status = conic_neighbours_build(context, (const float *const *)dense->position, dense->count, &work.tree);
  if (status != CONIC_OK)
    return status;
  work.is_kept = conic_memory_allocate(context, from->count, 1);
  if (work.is_kept) {
    conic_parallel_for(context, (from->count + CHUNK - 1) / CHUNK, keep_chunk, &work);
    hand_over_outlines(&work);
  }
  status = work.is_kept ? CONIC_OK : CONIC_ERROR_MEMORY;
  conic_memory_release(context, work.is_kept);
  conic_neighbours_release(context, &work.tree);
  return status;
}

conic_status cli_mls_size_dense(conic_context *context, const conic_model *from, conic_splats *dense) {
  conic_estimate_options options;
  conic_model made = {.points = *dense}, sparse = {.n_triangles = 0};
  conic_estimate_options_init(&options);
  int n_usual = options.n_neighbours;
  options.n_neighbours = N_NEIGHBOURS;
  conic_status status = conic_model_to_splats(context, &options, &made, NULL);
  *dense = made.points;
  if (status != CONIC_OK || from->n_triangles)
    return status;
  options.n_neighbours = n_usual;
  options.finds_dots = 1;
  memcpy(sparse.points.origin, from->points.origin, sizeof sparse.points.origin);
  status = conic_splats_append(context, &sparse.points, &from->points);
  if (status == CONIC_OK)
    status = conic_model_to_splats(context, &options, &sparse, NULL);
  if (status == CONIC_OK)
    status = keep_outlines(context, &sparse.points, (double)options.cutoff, dense);
  conic_model_release(context, &sparse);
  return status;
}

conic_status cli_mls_size_sharp(conic_context *context, conic_splats *points) {
  conic_estimate_options options;
  conic_model made = {.points = *points};
  conic_estimate_options_init(&options);
  conic_status status = conic_model_to_splats(context, &options, &made, NULL);
  if (status == CONIC_OK)
    status = conic_features_in_points(context, CREASE_COSINE, 1, &options, &made.points);
  *points = made.points;
  return status;
}
