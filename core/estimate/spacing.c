#include "core/estimate/neighbours.h"
#include "core/splats/columns.h"

enum { N_NEAREST = 8, MAX_SAMPLES = 20000 };

/* The spacing about a slot: √(area a point), its nearest neighbours' share of the disc that holds them. 0 where it
 * stands alone. */
static double spacing_at(const conic_neighbours *tree, size_t slot) {
  uint32_t slots[N_NEAREST];
  double distances2[N_NEAREST];
  const double query[3] = {(double)tree->position[0][slot], (double)tree->position[1][slot],
                           (double)tree->position[2][slot]};
  size_t n = conic_neighbours_nearest(tree, query, (uint32_t)slot, N_NEAREST, HUGE_VAL, slots, distances2);
  return n ? sqrt(3.14159265358979323846 * distances2[n - 1] / (double)n) : 0.0;
}

/* The lower median over at most MAX_SAMPLES slots, evenly taken. */
static conic_status median_of_slots(conic_context *context, const conic_neighbours *tree, double *spacing) {
  size_t n = tree->n_slots < MAX_SAMPLES ? tree->n_slots : MAX_SAMPLES;
  double *sampled = conic_memory_allocate(context, n, sizeof *sampled);
  if (!sampled)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    sampled[i] = spacing_at(tree, (size_t)((uint64_t)i * (uint64_t)tree->n_slots / (uint64_t)n));
  qsort(sampled, n, sizeof *sampled, conic_compare_doubles);
  *spacing = n ? sampled[(n - 1) / 2] : 0.0;
  conic_memory_release(context, sampled);
  return CONIC_OK;
}

conic_status conic_splats_spacing(conic_context *context, const conic_splats *splats, double *spacing) {
  conic_neighbours tree;
  conic_splats close;
  float *block;
  *spacing = 0.0;
  conic_status status = conic_splats_enter(context, "spacing", splats, &close, &block);
  if (status == CONIC_OK)
    status = conic_neighbours_build(context, (const float *const *)close.position, close.count, &tree);
  if (status == CONIC_OK) {
    status = median_of_slots(context, &tree, spacing);
    conic_neighbours_release(context, &tree);
  }
  conic_memory_release(context, block);
  return status;
}
