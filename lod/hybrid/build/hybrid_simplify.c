/* Simpler triangles for all clusters, in regions. Each region goes on to its next stage on one thread; then all threads
 * measure the clusters of all regions. */

#include "lod/hybrid/build/hybrid_build.h"

/* A region has no more faces than this, or but one cluster. What lies between regions stays, so they are large. */
enum { MOST_FACES = 250000 };

/* A region that is worked on. */
typedef struct work_place {
  conic_simplifier *simplifier;
  conic_status status;
  uint32_t n_clusters; /* to be measured */
} work_place;

typedef struct regions_job {
  conic_ways_job *ways;
  uint32_t *starts; /* of the regions' clusters, and an end */
  size_t n, first;
  uint32_t *of_cluster;
  conic_cluster_levels *levels;
  work_place *places; /* as many as there are threads: regions first, first + 1 … */
} regions_job;

/* Halves as the hierarchy's are, so that a region hangs together. */
static void part(regions_job *job, size_t begin, size_t end) {
  const size_t *starts = job->ways->mesh->starts;
  if (starts[end] - starts[begin] > MOST_FACES && end - begin > 1) {
    size_t middle = begin + conic_hybrid_half(end - begin);
    part(job, begin, middle);
    part(job, middle, end);
    return;
  }
  for (size_t i = begin; i < end; i++)
    job->of_cluster[i] = (uint32_t)job->n;
  job->starts[job->n++] = (uint32_t)begin;
  job->starts[job->n] = (uint32_t)end;
}

static void begin_task(void *data, size_t i_place) {
  regions_job *job = data;
  conic_ways_job *ways = job->ways;
  work_place *place = &job->places[i_place];
  size_t i = job->first + i_place;
  if (!place->simplifier)
    place->status = conic_simplifier_create(ways->context, ways->mesh, &ways->tree, &place->simplifier);
  if (place->status == CONIC_OK)
    place->status = conic_region_begin(place->simplifier, &ways->chains, job->starts[i], job->starts[i + 1],
                                       (conic_region_as_one){0}, job->levels + job->starts[i]);
}

static void advance_task(void *data, size_t i_place) {
  work_place *place = &((regions_job *)data)->places[i_place];
  place->n_clusters = 0;
  if (place->status == CONIC_OK)
    place->status = conic_region_advance(place->simplifier, &place->n_clusters);
}

/* Measures the i-th of all that are to be measured. */
static void measure_task(void *data, size_t i) {
  const work_place *place = ((regions_job *)data)->places;
  for (; i >= place->n_clusters; place++)
    i -= place->n_clusters;
  conic_region_measure(place->simplifier, (uint32_t)i);
}

static conic_status simplify(regions_job *job, size_t n_now) {
  conic_context *context = job->ways->context;
  conic_status status = CONIC_OK;
  size_t n_clusters;
  conic_parallel_for(context, n_now, begin_task, job);
  do {
    conic_parallel_for(context, n_now, advance_task, job);
    n_clusters = 0;
    for (size_t i = 0; i < n_now; i++)
      n_clusters += job->places[i].n_clusters;
    double done = 0.5 + 0.5 * (double)job->first / (double)job->n;
    status = conic_parallel_told(context, "sample", done, done, n_clusters, measure_task, job);
  } while (n_clusters > 0 && status == CONIC_OK);
  for (size_t i = 0; i < n_now; i++) {
    status = job->places[i].status != CONIC_OK ? job->places[i].status : status;
    if (job->places[i].simplifier)
      conic_region_end(job->places[i].simplifier);
  }
  return status;
}

/* As many regions at a time as there are threads, so that progress is told. */
static conic_status run_regions(regions_job *job) {
  conic_context *context = job->ways->context;
  size_t n_threads = (size_t)conic_context_threads(context);
  conic_status status = CONIC_OK;
  for (job->first = 0; job->first < job->n && status == CONIC_OK; job->first += n_threads) {
    size_t n_now = job->n - job->first < n_threads ? job->n - job->first : n_threads;
    status = simplify(job, n_now);
    if (status == CONIC_OK)
      status = conic_progress(context, "sample", 0.5 + 0.5 * (double)(job->first + n_now) / (double)job->n);
  }
  for (size_t i = 0; i < n_threads; i++)
    conic_simplifier_destroy(job->places[i].simplifier);
  return status;
}

conic_status conic_find_simpler(conic_ways_job *ways) {
  conic_context *context = ways->context;
  size_t n = ways->n_clusters, n_all = ways->mesh->clusters->n_clusters;
  size_t n_threads = (size_t)conic_context_threads(context);
  regions_job job = {.ways = ways};
  size_t n_surface = 0; /* splats that stay come after what may become simpler */
  while (n_surface < n && !conic_cluster_is_kept(ways->mesh, (uint32_t)n_surface))
    n_surface++;
  job.starts = conic_memory_allocate(context, n + 1, sizeof *job.starts);
  job.of_cluster = conic_memory_allocate(context, n_all, sizeof *job.of_cluster);
  job.levels = conic_memory_allocate_zeroed(context, n, sizeof *job.levels);
  job.places = conic_memory_allocate_zeroed(context, n_threads, sizeof *job.places);
  conic_status status = CONIC_ERROR_MEMORY;
  if (job.starts && job.of_cluster && job.levels && job.places) {
    if (n_surface > 0)
      part(&job, 0, n_surface);
    for (size_t i = n_surface; i < n_all; i++) /* each a region by itself, which is left as it is */
      job.of_cluster[i] = (uint32_t)(job.n + i);
    status = conic_cluster_chains_find(context, ways->mesh, job.of_cluster, &ways->chains);
    if (status == CONIC_OK)
      status = run_regions(&job);
    for (size_t i = 0; i < n; i++)
      ways->ways[i].triangles = job.levels[i];
  }
  conic_memory_release_these(context, job.starts, job.of_cluster, job.levels, job.places);
  return status;
}

/* --- all as one --- */

/* What is drawn with more triangles than this has them by cluster. */
enum { MOST_OF_WHOLE = 16384 };

typedef struct whole_job {
  conic_ways_job *ways;
  conic_clustered_mesh mesh; /* its faces lie by cluster, but are of a single one */
  conic_mesh_clusters one;
  conic_cluster_chains chains; /* none */
  conic_simplifier *simplifier;
} whole_job;

static void measure_whole(void *data, size_t i) {
  conic_region_measure(((whole_job *)data)->simplifier, (uint32_t)i);
}

static conic_status simplify_whole(whole_job *job) {
  conic_ways_job *ways = job->ways;
  uint32_t n = (uint32_t)ways->mesh->clusters->n_clusters, n_pieces;
  const conic_region_as_one as_one = {ways->most_error > 0.0 ? SIZE_MAX : MOST_OF_WHOLE, ways->most_error};
  conic_status status = conic_region_begin(job->simplifier, &job->chains, 0, n, as_one, &ways->whole);
  do {
    if (status == CONIC_OK)
      status = conic_region_advance(job->simplifier, &n_pieces);
    if (status == CONIC_OK)
      status = conic_parallel_told(ways->context, "sample", 1.0, 1.0, n_pieces, measure_whole, job);
  } while (status == CONIC_OK && n_pieces > 0);
  conic_region_end(job->simplifier);
  return status;
}

conic_status conic_find_whole(conic_ways_job *ways) {
  conic_context *context = ways->context;
  whole_job job = {.ways = ways, .mesh = *ways->mesh, .one = *ways->mesh->clusters};
  size_t n = ways->mesh->mesh.n_faces;
  uint32_t region = 0;
  job.one.of_face = conic_memory_allocate(context, n, sizeof *job.one.of_face);
  if (!job.one.of_face)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    job.one.of_face[i] = ways->mesh->clusters->of_face[i] == CONIC_NO_CLUSTER ? CONIC_NO_CLUSTER : 0;
  job.mesh.clusters = &job.one;
  conic_status status = conic_cluster_chains_find(context, &job.mesh, &region, &job.chains);
  if (status == CONIC_OK)
    status = conic_simplifier_create(context, &job.mesh, &ways->tree, &job.simplifier);
  if (status == CONIC_OK)
    status = simplify_whole(&job);
  conic_simplifier_destroy(job.simplifier);
  conic_cluster_chains_release(context, &job.chains);
  conic_memory_release(context, job.one.of_face);
  return status;
}
