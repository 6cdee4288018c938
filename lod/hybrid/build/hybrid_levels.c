/* All ways to draw one cluster. */
#include "lod/hybrid/build/hybrid_build.h"

#include "core/base/radix.h"

void conic_cluster_ways_release(conic_context *context, conic_cluster_ways *ways) {
  conic_cluster_levels_release(context, &ways->triangles);
  for (int i = 0; i < ways->n_surfels; i++)
    conic_surfels_release(context, &ways->surfels[i]);
  ways->n_surfels = 0;
}

/* --- bounds --- */

static void bound_sphere(const conic_clustered_mesh *mesh, uint32_t cluster, conic_hybrid_bound *bound) {
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, farthest2 = 0.0;
  memset(bound->center, 0, sizeof bound->center); /* known in the second pass */
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = mesh->starts[cluster]; i < mesh->starts[cluster + 1]; i++)
      for (int corner = 0; corner < 3; corner++) {
        double at[3], distance2 = 0.0;
        conic_mesh_corner(&mesh->mesh, mesh->faces[i], corner, at);
        conic_widen_box(low, high, at);
        for (int axis = 0; axis < 3; axis++) {
          double d = at[axis] - (double)bound->center[axis];
          distance2 += d * d;
        }
        farthest2 = pass && distance2 > farthest2 ? distance2 : farthest2;
      }
    for (int axis = 0; axis < 3 && !pass; axis++)
      bound->center[axis] = (float)(0.5 * (low[axis] + high[axis]));
  }
  bound->radius = (float)(sqrt(farthest2) * (1.0 + 1e-6));
}

/* The cone of the faces as they are wound, for that is what culling goes by. A face without area faces nowhere. */
static void bound_cone(const conic_clustered_mesh *mesh, uint32_t cluster, conic_hybrid_bound *bound) {
  double axis[3] = {0.0, 0.0, 0.0}, least = 1.0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = mesh->starts[cluster]; i < mesh->starts[cluster + 1]; i++) {
      double normal[3], along;
      conic_cluster_face_normal(mesh, mesh->faces[i], normal);
      for (int k = 0; k < 3; k++) {
        normal[k] *= (double)mesh->adjacency->side[mesh->faces[i]];
        axis[k] += pass ? 0.0 : normal[k];
      }
      along = conic_dot(normal, axis);
      least = pass && conic_dot(normal, normal) > 0.0 && along < least ? along : least;
    }
    double length = conic_length(axis);
    for (int k = 0; k < 3 && !pass; k++)
      axis[k] = length > 0.0 ? axis[k] / length : (double)(k == 2);
  }
  for (int k = 0; k < 3; k++)
    bound->axis[k] = (float)axis[k];
  bound->cone = least > 1e-3 ? (float)(least - 1e-5) : -1.0f;
}

conic_hybrid_bound conic_cluster_bound(const conic_clustered_mesh *mesh, uint32_t cluster) {
  conic_hybrid_bound bound;
  bound_sphere(mesh, cluster, &bound);
  bound_cone(mesh, cluster, &bound);
  if (conic_cluster_are_dots(mesh, cluster))
    bound.cone = -1.0f;
  return bound;
}

static double cluster_area(const conic_clustered_mesh *mesh, uint32_t cluster) {
  double area = 0.0;
  for (size_t i = mesh->starts[cluster]; i < mesh->starts[cluster + 1]; i++) {
    double at[3][3], sides[2][3], cross[3];
    for (int corner = 0; corner < 3; corner++)
      conic_mesh_corner(&mesh->mesh, mesh->faces[i], corner, at[corner]);
    for (int axis = 0; axis < 3; axis++) {
      sides[0][axis] = at[1][axis] - at[0][axis];
      sides[1][axis] = at[2][axis] - at[0][axis];
    }
    conic_cross(sides[0], sides[1], cross);
    area += 0.5 * conic_length(cross);
  }
  return area;
}

/* --- surfels --- */

/* What is triangles as built begins with surfels that are half as many: finer ones would be of no use. */
static double first_spacing(const conic_ways_job *job, uint32_t cluster) {
  const conic_clustered_mesh *mesh = job->mesh;
  double edge = conic_cluster_edge_length(mesh, cluster),
         n_faces = (double)(mesh->starts[cluster + 1] - mesh->starts[cluster]);
  if (mesh->clusters->is_gathered[cluster])
    return edge / job->options->density;
  double sparse = sqrt(1.3 * job->ways[cluster].area / n_faces);
  return sparse > edge ? sparse : edge;
}

/* The error of surfels, in spacings, above which they are laid closer: a pixel where they lie two apart. That goes on
 * as long as there are no more than so many a face: more take longer to draw than the faces. */
static const double tolerance = 0.5;
enum { MOST_A_FACE = 2, MOST_A_FACE_OF_TRIANGLES = 1 };

/* What surfels may stand out as built, as a part of the mesh's diagonal: a pixel where a picture of 1024 shows all of
 * it. */
static const double tolerance_of_mesh = 1e-3;

static double find_most_out(const conic_ways_job *job) {
  const conic_face_box *all = &job->tree.boxes[1];
  double sides[3];
  if (job->options->most_error <= 0.0)
    return HUGE_VAL;
  for (int axis = 0; axis < 3; axis++)
    sides[axis] = (double)all->high[axis] - (double)all->low[axis];
  return tolerance_of_mesh * conic_length(sides);
}

/* The most surfels with which the next level is worth one: a fourth less than the one before has. */
static size_t most_of_next(const conic_cluster_ways *ways) {
  return ways->n_surfels ? 3 * ways->surfels[ways->n_surfels - 1].n / 4 : SIZE_MAX;
}

/* Keeps the level that was sampled last where it is worth one. */
static void keep_level(conic_context *context, conic_cluster_ways *ways) {
  conic_surfels *last = &ways->surfels[ways->n_surfels];
  if (last->n == 0 || last->n > most_of_next(ways))
    conic_surfels_release(context, last);
  else
    ways->n_surfels++;
}

/* Whether a cluster that was gathered is drawn as its finest surfels where no error is asked for. */
static int is_surfels(const conic_hybrid_options *options, const conic_surfels *finest, double spacing) {
  int is_good =
      options->most_error <= 0.0 || (!finest->is_out && finest->refined_error <= options->most_error * spacing);
  return finest->n > 0 && (is_good || options->sampling == CONIC_SAMPLING_BOX);
}

/* Splats that stay are their own finest level. A dot leans so that it is up to twice as long in depth. */
static conic_status keep_splats(conic_ways_job *job, uint32_t cluster) {
  const conic_clustered_mesh *mesh = job->mesh;
  conic_cluster_ways *ways = &job->ways[cluster];
  conic_surfels *surfels = &ways->surfels[0];
  conic_status status = CONIC_OK;
  ways->is_surfels = ways->n_surfels = 1;
  surfels->are_dots = conic_cluster_are_dots(mesh, cluster);
  for (size_t i = mesh->starts[cluster]; i < mesh->starts[cluster + 1] && status == CONIC_OK; i += 2) {
    const conic_surfel *from = &mesh->kept->items[(mesh->faces[i] - mesh->kept->n_surface) / 2];
    double half[2] = {0.0, 0.0};
    status = conic_surfels_reserve(job->context, surfels);
    if (status != CONIC_OK)
      break;
    surfels->items[surfels->n++] = *from;
    for (int axis = 0; axis < 3; axis++) {
      half[0] += (double)from->tangent_u[axis] * (double)from->tangent_u[axis];
      half[1] += (double)from->tangent_v[axis] * (double)from->tangent_v[axis];
    }
    double reach = (double)job->options->cutoff * sqrt(half[0] > half[1] ? half[0] : half[1]);
    reach *= surfels->are_dots ? 2.0 : 1.0;
    surfels->reach = reach > surfels->reach ? reach : surfels->reach;
  }
  return status;
}

/* A cover of the cluster by one kind of sampling, each level twice as wide as the one before, down to a few surfels. */
static conic_status sample_cluster(conic_ways_job *job, conic_sampler *sampler, uint32_t cluster) {
  conic_cluster_ways *ways = &job->ways[cluster];
  size_t n_faces = job->mesh->starts[cluster + 1] - job->mesh->starts[cluster];
  int is_gathered = job->mesh->clusters->is_gathered[cluster], is_single = job->options->has_single_levels;
  conic_sampling_job sampling = {.mesh = job->mesh,
                                 .tree = &job->tree,
                                 .cluster = cluster,
                                 .spacing = first_spacing(job, cluster),
                                 .most = n_faces * (is_gathered ? MOST_A_FACE : MOST_A_FACE_OF_TRIANGLES),
                                 .cutoff = (double)job->options->cutoff};
  conic_status status = CONIC_OK;
  int n_most = is_single ? is_gathered : CONIC_MOST_SURFEL_LEVELS;
  for (int i = 0; i < n_most && status == CONIC_OK && sampling.spacing > 0.0; i++) {
    conic_surfels *surfels = &ways->surfels[ways->n_surfels];
    surfels->error = ways->n_surfels ? surfels[-1].error : 0.0; /* it has no less than what it is coarser than */
    surfels->change = ways->n_surfels ? surfels[-1].change : (conic_seen_change){0.0, 0.0};
    sampling.tolerance = tolerance * sampling.spacing;
    sampling.most_out = i == 0 && is_gathered ? job->most_out : HUGE_VAL;
    sampling.tolerance = sampling.most_out < sampling.tolerance ? sampling.most_out : sampling.tolerance;
    sampling.useful = most_of_next(ways);
    sampling.is_coarser = i > 0;
    if (job->options->sampling == CONIC_SAMPLING_BOX)
      status = conic_cluster_sample_box(job->context, &sampling, surfels);
    else
      status = conic_cluster_sample(sampler, &sampling, surfels);
    if (i == 0)
      ways->is_surfels = is_gathered && is_surfels(job->options, surfels, sampling.spacing);
    int is_last = surfels->n <= 2 || surfels->is_coarsest;
    keep_level(job->context, ways);
    if (is_last)
      break;
    sampling.spacing *= 2.0;
  }
  return status;
}

/* --- all clusters --- */

typedef struct ways_pass {
  conic_ways_job *job;
  uint32_t *order; /* of the clusters, the largest first: none of them is begun when the others are done */
  void **workers;  /* a sampler for each thread */
  conic_status *statuses;
} ways_pass;

static conic_status do_cluster(ways_pass *pass, uint32_t cluster, int i_thread) {
  conic_ways_job *job = pass->job;
  void **worker = &pass->workers[i_thread];
  conic_status status = CONIC_OK;
  conic_sampler *sampler = *worker;
  if (!sampler)
    status = conic_sampler_create(job->context, &sampler);
  *worker = sampler;
  if (conic_cluster_is_kept(job->mesh, cluster))
    return keep_splats(job, cluster);
  return status == CONIC_OK ? sample_cluster(job, sampler, cluster) : status;
}

static void ways_task(void *data, size_t i_task, int i_thread) {
  ways_pass *pass = data;
  if (pass->statuses[i_thread] == CONIC_OK)
    pass->statuses[i_thread] = do_cluster(pass, pass->order[i_task], i_thread);
}

static conic_status run_pass(ways_pass *pass) {
  conic_context *context = pass->job->context;
  size_t n = pass->job->n_clusters;
  conic_status status = conic_parallel_told(context, "sample", 0.0, 0.5, n, ways_task, pass);
  for (int i = 0; i < conic_context_threads(context); i++)
    status = pass->statuses[i] != CONIC_OK ? pass->statuses[i] : status;
  return status;
}

static conic_status order_by_size(ways_pass *pass) {
  const conic_clustered_mesh *mesh = pass->job->mesh;
  size_t n = pass->job->n_clusters;
  conic_radix_item *items = conic_memory_allocate(pass->job->context, n, sizeof *items);
  if (!items)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    items[i] = (conic_radix_item){UINT32_MAX - (mesh->starts[i + 1] - mesh->starts[i]), (uint32_t)i};
  conic_status status = conic_radix_sort(pass->job->context, items, n, 32);
  for (size_t i = 0; i < n; i++)
    pass->order[i] = items[i].value;
  conic_memory_release(pass->job->context, items);
  return status;
}

static conic_status run_passes(ways_pass *pass) {
  conic_ways_job *job = pass->job;
  int n_threads = conic_context_threads(job->context);
  size_t n_all = job->mesh->clusters->n_clusters;
  double start = conic_seconds_now();
  conic_status status = job->most_error > 0.0 ? CONIC_OK : run_pass(pass);
  for (int i = 0; i < n_threads; i++)
    conic_sampler_destroy(pass->workers[i]);
  if (status == CONIC_OK)
    status = conic_find_nodes(job);
  double sampled = conic_seconds_now();
  if (status == CONIC_OK && !job->options->has_single_levels)
    status = conic_find_simpler(job);
  if (status == CONIC_OK && (job->most_error > 0.0 || !job->options->has_single_levels) && n_all == job->n_clusters &&
      !job->mesh->kept)
    status = conic_find_whole(job);
  job->sample_seconds = sampled - start;
  job->simplify_seconds = conic_seconds_now() - sampled;
  return status;
}

conic_status conic_find_ways(conic_ways_job *job) {
  size_t n_threads = (size_t)conic_context_threads(job->context);
  size_t n = job->n_clusters;
  ways_pass pass = {.job = job,
                    .order = conic_memory_allocate(job->context, n, sizeof *pass.order),
                    .workers = conic_memory_allocate_zeroed(job->context, n_threads, sizeof *pass.workers),
                    .statuses = conic_memory_allocate_zeroed(job->context, n_threads, sizeof *pass.statuses)};
  conic_status status = CONIC_ERROR_MEMORY;
  if (pass.order && pass.workers && pass.statuses)
    status = order_by_size(&pass);
  if (status == CONIC_OK)
    status = conic_face_tree_build(job->context, &job->mesh->mesh, job->mesh->adjacency, &job->tree);
  if (status == CONIC_OK) {
    job->most_out = find_most_out(job);
    for (size_t i = 0; i < n; i++) {
      job->ways[i].area = cluster_area(job->mesh, (uint32_t)i);
      job->ways[i].bound = conic_cluster_bound(job->mesh, (uint32_t)i);
    }
    status = run_passes(&pass);
  }
  conic_face_tree_release(job->context, &job->tree);
  conic_memory_release_these(job->context, pass.order, pass.workers, pass.statuses);
  return status;
}
