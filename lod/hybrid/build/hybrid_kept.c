/* Splats that a hybrid model keeps as what they are, beside the surface that others became. */
#include "lod/hybrid/build/hybrid_build.h"

#include <string.h>

#include "core/base/memory.h"
#include "lod/hybrid/model/hybrid_model.h"

/* The most splats of a cluster. */
enum { MOST_KEPT = 64 };

typedef struct grouping {
  const conic_kept_splats *kept;
  uint32_t *order; /* of the splats: those near each other, after one another */
  conic_mesh_clusters *clusters;
} grouping;

/* Halves as those that the order was made by. */
static void group_range(grouping *g, size_t begin, size_t end) {
  if (end - begin > MOST_KEPT) {
    size_t middle = begin + conic_hybrid_half(end - begin);
    group_range(g, begin, middle);
    group_range(g, middle, end);
    return;
  }
  for (size_t i = begin; i < end; i++)
    for (size_t k = 0; k < 2; k++)
      g->clusters->of_face[g->kept->n_surface + 2 * g->order[i] + k] = (uint32_t)g->clusters->n_clusters;
  g->clusters->is_gathered[g->clusters->n_clusters++] = 1;
}

/* Discs by themselves, and dots. */
static conic_status group_all(conic_context *context, grouping *g) {
  const conic_kept_splats *kept = g->kept;
  conic_hybrid_bound *places = conic_memory_allocate_zeroed(context, kept->n, sizeof *places);
  conic_status status = places ? CONIC_OK : CONIC_ERROR_MEMORY;
  const size_t begins[3] = {0, kept->n_discs, kept->n};
  for (int kind = 0; kind < 2 && status == CONIC_OK; kind++) {
    size_t begin = begins[kind], n = begins[kind + 1] - begin;
    for (size_t i = 0; i < n; i++)
      memcpy(places[i].center, kept->items[begin + i].position, sizeof places[i].center);
    status = conic_hybrid_order(context, places, NULL, n, g->order + begin);
    for (size_t i = 0; i < n && status == CONIC_OK; i++)
      g->order[begin + i] += (uint32_t)begin;
    if (status == CONIC_OK && n > 0)
      group_range(g, begin, begin + n);
  }
  conic_memory_release(context, places);
  return status;
}

/* Clusters are numbered by their first faces, so that those of the surface come first. */
static size_t count_surface_clusters(const conic_kept_splats *kept, const conic_mesh_clusters *clusters) {
  size_t n = 0;
  for (size_t i = 0; i < kept->n_surface; i++)
    if (clusters->of_face[i] != CONIC_NO_CLUSTER && clusters->of_face[i] >= n)
      n = clusters->of_face[i] + 1;
  return n;
}

conic_status conic_hybrid_group_kept(conic_context *context, const conic_kept_splats *kept,
                                     conic_mesh_clusters *clusters) {
  grouping g = {kept, conic_memory_allocate(context, kept->n, sizeof *g.order), clusters};
  size_t n_surface = count_surface_clusters(kept, clusters);
  uint8_t *is_gathered = conic_memory_allocate(context, n_surface + kept->n, 1);
  conic_face_sums *sums = conic_memory_allocate_zeroed(context, n_surface + kept->n, sizeof *sums);
  conic_status status = g.order && is_gathered && sums ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    memcpy(is_gathered, clusters->is_gathered, n_surface);
    memcpy(sums, clusters->sums, n_surface * sizeof *sums);
    uint8_t *old = clusters->is_gathered;
    conic_face_sums *old_sums = clusters->sums;
    clusters->is_gathered = is_gathered;
    clusters->sums = sums;
    clusters->n_clusters = n_surface;
    is_gathered = old;
    sums = old_sums;
    status = group_all(context, &g);
  }
  conic_memory_release_these(context, sums, is_gathered, g.order);
  return status;
}
