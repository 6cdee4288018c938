/* From splats to a hybrid model: triangles where they lie as a surface does, and all others as what they are. */

#include "core/splats/columns.h"
#include "lod/hybrid/build/hybrid_build.h"
#include "surface/skin/skin.h"

typedef struct points_job {
  conic_context *context;
  const conic_splats *splats;
  double cutoff;
  conic_skin skin;
  uint32_t *place; /* of each splat that is a corner: its vertex */
  conic_triangles mesh;
  conic_kept_splats kept;
} points_job;

/* What no picture shows is left out: splats that are not finite, or span no plane. */
static int has_to_stay(const points_job *job, size_t i) {
  const conic_splats *s = job->splats;
  double sum = 0.0, u[3], v[3], across[3];
  if (job->skin.is_inner[i])
    return 0;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)s->tangent_u[axis][i];
    v[axis] = (double)s->tangent_v[axis][i];
    sum += (double)s->position[axis][i] + (s->color[0] ? (double)s->color[axis][i] : 0.0);
  }
  conic_cross(u, v, across);
  double area = conic_length(across);
  return sum - sum == 0.0 && area > 0.0 && area - area == 0.0 && !(s->opacity && !(s->opacity[i] > 0.0f));
}

/* --- the surface --- */

static void put_skin_vertex(points_job *job, size_t vertex, size_t splat) {
  const conic_splats *s = job->splats;
  for (int axis = 0; axis < 3; axis++) {
    job->mesh.position[axis][vertex] = s->position[axis][splat] + job->skin.lift[splat] * job->skin.normal[splat][axis];
    job->mesh.normal[axis][vertex] = job->skin.normal[splat][axis];
    if (s->color[0])
      job->mesh.color[axis][vertex] = job->skin.color[splat][axis];
  }
}

/* --- splats that stay --- */

static void keep_splat(points_job *job, size_t splat) {
  const conic_splats *s = job->splats;
  conic_surfel *to = &job->kept.items[job->kept.n++];
  memset(to, 0, sizeof *to);
  for (int axis = 0; axis < 3; axis++) {
    to->position[axis] = s->position[axis][splat];
    to->tangent_u[axis] = s->tangent_u[axis][splat];
    to->tangent_v[axis] = s->tangent_v[axis][splat];
    to->color[axis] = s->color[0] ? s->color[axis][splat] : 1.0f;
  }
}

/* The rectangle about a splat's ellipse, as two faces. */
static void put_rectangle(points_job *job, size_t i, size_t first_vertex) {
  static const double signs[4][2] = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
  conic_surfel *splat = &job->kept.items[i];
  size_t vertex = first_vertex + 4 * i, face = job->kept.n_surface + 2 * i;
  double u[3], v[3], normal[3];
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = job->cutoff * (double)splat->tangent_u[axis];
    v[axis] = job->cutoff * (double)splat->tangent_v[axis];
  }
  conic_cross(u, v, normal);
  conic_normalize(normal);
  for (size_t k = 0; k < 4; k++)
    for (int axis = 0; axis < 3; axis++) {
      job->mesh.position[axis][vertex + k] =
          (float)((double)splat->position[axis] + signs[k][0] * u[axis] + signs[k][1] * v[axis]);
      job->mesh.normal[axis][vertex + k] = (float)normal[axis];
      if (job->mesh.color[0])
        job->mesh.color[axis][vertex + k] = splat->color[axis];
    }
  for (uint32_t k = 0; k < 2; k++) {
    uint32_t *corners = job->mesh.corners[face + k];
    corners[0] = (uint32_t)vertex;
    corners[1] = (uint32_t)vertex + 1 + k;
    corners[2] = (uint32_t)vertex + 2 + k;
  }
  splat->face = (uint32_t)face;
}

/* --- all --- */

static size_t number_corners(points_job *job) {
  size_t n = 0;
  memset(job->place, 0xFF, job->splats->count * sizeof *job->place);
  for (size_t i = 0; i < job->skin.n_triangles; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t *place = &job->place[job->skin.corners[i][k]];
      if (*place == UINT32_MAX)
        *place = (uint32_t)n++;
    }
  return n;
}

static conic_status make_skin_mesh(points_job *job) {
  const conic_splats *s = job->splats;
  size_t n_kept = 0, n_vertices = number_corners(job);
  unsigned fields = CONIC_TRIANGLES_NORMALS | (s->color[0] ? CONIC_TRIANGLES_COLORS : 0u);
  for (size_t i = 0; i < s->count; i++)
    n_kept += (size_t)has_to_stay(job, i);
  job->kept.n_surface = job->skin.n_triangles;
  job->kept.items = conic_memory_allocate(job->context, n_kept, sizeof *job->kept.items);
  if (!job->kept.items)
    return CONIC_ERROR_MEMORY;
  if (n_kept + job->skin.n_triangles == 0)
    return conic_fail(job->context, CONIC_ERROR_INPUT, "there is no splat that could be drawn");
  if (n_kept > UINT32_MAX / 16)
    return conic_fail(job->context, CONIC_ERROR_ARGUMENT, "%zu splats are too many", n_kept);
  conic_status status = conic_triangles_allocate(job->context, job->skin.n_triangles + 2 * n_kept,
                                                 n_vertices + 4 * n_kept, fields, &job->mesh);
  if (status != CONIC_OK)
    return status;
  memcpy(job->mesh.origin, s->origin, sizeof s->origin);
  for (size_t i = 0; i < s->count; i++)
    if (job->place[i] != UINT32_MAX)
      put_skin_vertex(job, job->place[i], i);
  for (size_t i = 0; i < job->skin.n_triangles; i++)
    for (int k = 0; k < 3; k++)
      job->mesh.corners[i][k] = job->place[job->skin.corners[i][k]];
  for (int wants_dots = 0; wants_dots < 2; wants_dots++) {
    for (size_t i = 0; i < s->count; i++)
      if ((s->dot && s->dot[i] != 0.0f) == wants_dots && has_to_stay(job, i))
        keep_splat(job, i);
    job->kept.n_discs = wants_dots ? job->kept.n_discs : job->kept.n;
  }
  for (size_t i = 0; i < job->kept.n; i++)
    put_rectangle(job, i, n_vertices);
  return CONIC_OK;
}

static conic_status check_splats(points_job *job, const conic_hybrid_options *given) {
  const conic_splats *s = job->splats;
  conic_hybrid_options options;
  conic_status status = conic_splats_check(job->context, "hybrid", s);
  if (status == CONIC_OK && !s->tangent_u[0])
    status = conic_fail(job->context, CONIC_ERROR_ARGUMENT, "hybrid: the points have no tangent axes");
  conic_hybrid_options_init(&options);
  if (status == CONIC_OK && !conic_options_take(&options, given))
    status = conic_fail(job->context, CONIC_ERROR_ARGUMENT, "an option of the hybrid model is out of range");
  job->cutoff = (double)options.cutoff;
  return status;
}

conic_status conic_hybrid_build_points(conic_context *context, conic_splats *splats,
                                       const conic_hybrid_options *options, conic_hybrid **hybrid,
                                       conic_hybrid_report *report) {
  points_job job = {.context = context, .splats = splats};
  size_t n_points = splats->count;
  *hybrid = NULL;
  conic_status status = check_splats(&job, options);
  if (status == CONIC_OK)
    status = conic_skin_find(context, splats, job.cutoff, &job.skin);
  if (status == CONIC_OK) {
    job.place = conic_memory_allocate(context, splats->count, sizeof *job.place);
    status = job.place ? make_skin_mesh(&job) : CONIC_ERROR_MEMORY;
  }
  conic_memory_release(context, job.place);
  conic_skin_release(context, &job.skin);
  conic_splats_release(context, splats);
  if (status == CONIC_OK)
    status = conic_hybrid_build_with(context, &job.mesh, &job.kept, options, hybrid, report);
  if (status == CONIC_OK && report) {
    report->n_points = n_points;
    report->n_kept = job.kept.n;
  }
  conic_triangles_release(context, &job.mesh);
  conic_memory_release(context, job.kept.items);
  return status;
}
