/* Simpler triangles for all patches: in regions, each on one thread. */
#include <string.h>

#include "core/memory.h"
#include "core/message.h"
#include "core/threads.h"
#include "lod/hybrid_levels.h"
#include "lod/hybrid_tree.h"

/* A region has no more faces than this, or but one patch. What lies between regions stays, so they are large. */
enum { MOST_FACES = 250000 };

typedef struct regions_job {
  conic_ways_job *ways;
  uint32_t *starts; /* of the regions' patches, and an end */
  size_t n, first;
  uint32_t *of_patch;
  conic_patch_levels *levels;
  conic_simplifier **simplifiers; /* by thread, as what became of it */
  conic_status *statuses;
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
    job->of_patch[i] = (uint32_t)job->n;
  job->starts[job->n++] = (uint32_t)begin;
  job->starts[job->n] = (uint32_t)end;
}

static void simplify_task(void *data, size_t i_task, int i_thread) {
  regions_job *job = data;
  conic_ways_job *ways = job->ways;
  conic_simplifier **simplifier = &job->simplifiers[i_thread];
  conic_status *status = &job->statuses[i_thread];
  size_t i = job->first + i_task;
  if (*status == CONIC_OK && !*simplifier)
    *status = conic_simplifier_create(ways->context, ways->mesh, &ways->tree, simplifier);
  if (*status == CONIC_OK)
    *status = conic_region_simplify(*simplifier, &ways->chains, job->starts[i], job->starts[i + 1],
                                    job->levels + job->starts[i]);
}

/* As many regions at a time as there are threads, so that progress is told. */
static conic_status run(regions_job *job) {
  conic_context *context = job->ways->context;
  size_t n_threads = (size_t)conic_context_threads(context);
  conic_status status = CONIC_OK;
  for (job->first = 0; job->first < job->n && status == CONIC_OK; job->first += n_threads) {
    size_t n_now = job->n - job->first < n_threads ? job->n - job->first : n_threads;
    conic_parallel_for(context, n_now, simplify_task, job);
    for (size_t i = 0; i < n_threads; i++)
      status = job->statuses[i] != CONIC_OK ? job->statuses[i] : status;
    if (status == CONIC_OK)
      status = conic_progress(context, "sample", 0.5 + 0.5 * (double)(job->first + n_now) / (double)job->n);
  }
  for (size_t i = 0; i < n_threads; i++)
    conic_simplifier_destroy(job->simplifiers[i]);
  return status;
}

conic_status conic_find_simpler(conic_ways_job *ways) {
  conic_context *context = ways->context;
  size_t n = ways->mesh->clusters->n_clusters, n_threads = (size_t)conic_context_threads(context);
  regions_job job = {.ways = ways};
  job.starts = conic_memory_allocate(context, n + 1, sizeof *job.starts);
  job.of_patch = conic_memory_allocate(context, n, sizeof *job.of_patch);
  job.levels = conic_memory_allocate_zeroed(context, n, sizeof *job.levels);
  job.simplifiers = conic_memory_allocate_zeroed(context, n_threads, sizeof *job.simplifiers);
  job.statuses = conic_memory_allocate_zeroed(context, n_threads, sizeof *job.statuses);
  conic_status status = CONIC_ERROR_MEMORY;
  if (job.starts && job.of_patch && job.levels && job.simplifiers && job.statuses) {
    part(&job, 0, n);
    status = conic_patch_chains_find(context, ways->mesh, job.of_patch, &ways->chains);
    if (status == CONIC_OK)
      status = run(&job);
    for (size_t i = 0; i < n; i++)
      ways->ways[i].triangles = job.levels[i];
  }
  conic_memory_release(context, job.starts);
  conic_memory_release(context, job.of_patch);
  conic_memory_release(context, job.levels);
  conic_memory_release(context, job.simplifiers);
  conic_memory_release(context, job.statuses);
  return status;
}
