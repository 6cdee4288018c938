/* Models of meshes that are larger than memory: cell by cell, each built with the faces about it, so that cells meet
 * without a gap. */

#include "core/base/real.h"
#include "lod/hybrid/build/hybrid_build.h"
#include "lod/hybrid/model/hybrid_store.h"
#include "lod/mesh/mesh_cells.h"

/* What building takes for each face of a cell, and besides (docs/notes/hybrid-measured.md). */
enum { BYTES_A_FACE = 640, OTHER_BYTES = 48 << 20 };

CONIC_DEFINE_OPTIONS(conic_hybrid_streaming, .memory_bytes = UINT64_C(1) << 30, .crease_deg = 30.0)

/* The median length of a cell's surfels as built, and their number. */
typedef struct cell_length {
  double length;
  size_t n;
} cell_length;

typedef struct large_building {
  conic_context *context;
  const conic_hybrid_options *options;
  conic_hybrid_streaming streaming;
  conic_mesh_cells *cells;
  conic_hybrid *hybrid;
  cell_length *lengths;
  size_t n_lengths, n_done;
  conic_hybrid_report *report;
} large_building;

/* What the model has of all of its parts. */
static void note_part(large_building *b, const conic_hybrid *part, const conic_hybrid_report *own) {
  conic_hybrid *h = b->hybrid;
  conic_hybrid_info info;
  int is_first = b->n_lengths == 0;
  conic_hybrid_describe(part, &info);
  h->n_vertices += part->n_vertices;
  h->flags = part->flags;
  h->cutoff = part->cutoff;
  memcpy(h->origin, part->origin, sizeof h->origin);
  for (int axis = 0; axis < 3; axis++) {
    h->low[axis] = is_first || part->low[axis] < h->low[axis] ? part->low[axis] : h->low[axis];
    h->high[axis] = is_first || part->high[axis] > h->high[axis] ? part->high[axis] : h->high[axis];
  }
  b->lengths[b->n_lengths++] = (cell_length){part->splat_length, info.n_surfels};
  b->report->n_first += own->n_first;
  b->report->cluster_seconds += own->cluster_seconds;
  b->report->sample_seconds += own->sample_seconds;
  b->report->simplify_seconds += own->simplify_seconds;
}

static conic_status build_cell(large_building *b, uint32_t cell) {
  conic_triangles mesh;
  conic_hybrid *part = NULL;
  conic_hybrid_report own;
  size_t n_own;
  conic_status status = conic_mesh_cells_take(b->cells, cell, &mesh, &n_own);
  if (status == CONIC_OK && conic_has_face(mesh.position, (const uint32_t(*)[3])mesh.corners, n_own)) {
    status = conic_mesh_round(b->context, b->streaming.is_smooth, b->streaming.crease_deg, &mesh);
    if (status == CONIC_OK)
      status = conic_hybrid_build_part(b->context, &mesh, n_own, b->options, &part, &own);
    if (status == CONIC_OK) {
      note_part(b, part, &own);
      status = conic_hybrid_pile_add(b->context, b->hybrid->pile, part);
    }
  }
  conic_hybrid_destroy(part);
  conic_triangles_release(b->context, &mesh);
  b->n_done++;
  return status == CONIC_OK
             ? conic_progress(b->context, "cells", (double)b->n_done / (double)conic_mesh_cells_count(b->cells))
             : status;
}

/* A subtree of cells becomes one of nodes. */
static conic_status build_cells(large_building *b, uint32_t i) {
  const conic_cell_node *node = &conic_mesh_cells_tree(b->cells)[i];
  uint32_t own;
  if (!node->above)
    return build_cell(b, node->cell);
  conic_status status = conic_hybrid_pile_begin_node(b->context, b->hybrid->pile, &own);
  if (status == CONIC_OK)
    status = build_cells(b, i + 1);
  if (status == CONIC_OK)
    status = build_cells(b, node->above);
  if (status == CONIC_OK)
    conic_hybrid_pile_end_node(b->hybrid->pile, own);
  return status;
}

CONIC_DEFINE_ORDER(compare_lengths, cell_length, length)

/* The median of the cells' medians, each as often as it has surfels. */
static double median_of_cells(cell_length *lengths, size_t n_lengths) {
  size_t n = 0, before = 0;
  for (size_t i = 0; i < n_lengths; i++)
    n += lengths[i].n;
  if (n == 0)
    return 0.0;
  qsort(lengths, n_lengths, sizeof *lengths, compare_lengths);
  for (size_t i = 0; i < n_lengths; i++) {
    before += lengths[i].n;
    if (2 * before >= n)
      return lengths[i].length;
  }
  return 0.0;
}

static conic_status check_memory(const large_building *b, size_t n_faces) {
  uint64_t needed = OTHER_BYTES + (uint64_t)BYTES_A_FACE * n_faces;
  return needed <= b->streaming.memory_bytes
             ? CONIC_OK
             : conic_fail(b->context, CONIC_ERROR_MEMORY, "building takes %llu MiB of memory, and may take %llu",
                          (unsigned long long)(needed >> 20) + 1,
                          (unsigned long long)(b->streaming.memory_bytes >> 20));
}

static conic_status build_large(large_building *b, const char *mesh, const char *path, size_t most_faces) {
  conic_context *context = b->context;
  conic_status status = check_memory(b, most_faces);
  double start = conic_seconds_now();
  if (status == CONIC_OK)
    status = conic_mesh_cells_find(context, mesh, path, most_faces, &b->cells);
  if (status != CONIC_OK)
    return status;
  conic_mesh_counts counts = conic_mesh_cells_counts(b->cells);
  b->report->n_faces = counts.n_faces;
  b->report->nan = counts.nan;
  b->report->zero = counts.zero;
  b->report->cluster_seconds = conic_seconds_now() - start;
  if (conic_memory_allocate_these(context, CONIC_ROOM(b->lengths, conic_mesh_cells_count(b->cells)),
                                  CONIC_ZEROED(b->hybrid->pile, 1)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  b->hybrid->pile->file.file.descriptor = -1;
  status = conic_pile_begin(context, path, &b->hybrid->pile->file);
  if (status == CONIC_OK)
    status = build_cells(b, 0);
  if (status == CONIC_OK && b->n_lengths == 0)
    status = conic_fail(context, CONIC_ERROR_INPUT, "the mesh has no face that could be drawn");
  if (status != CONIC_OK)
    return status;
  b->hybrid->splat_length = median_of_cells(b->lengths, b->n_lengths);
  return conic_hybrid_pile_finish(b->hybrid->pile, b->hybrid);
}

conic_status conic_hybrid_build_cells(conic_context *context, const char *mesh, const char *path,
                                      const conic_hybrid_options *options, const conic_hybrid_streaming *streaming,
                                      size_t most_faces, conic_hybrid **hybrid, conic_hybrid_report *report) {
  conic_hybrid_report ignored;
  large_building b = {.context = context, .options = options, .report = report ? report : &ignored};
  conic_hybrid_streaming_init(&b.streaming);
  *hybrid = NULL;
  memset(b.report, 0, sizeof *b.report);
  if (!conic_options_take(&b.streaming, streaming))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "hybrid: the options of streaming were not initialised");
  b.hybrid = conic_memory_allocate_zeroed(context, 1, sizeof *b.hybrid);
  if (!b.hybrid)
    return CONIC_ERROR_MEMORY;
  b.hybrid->context = context;
  conic_status status = build_large(&b, mesh, path, most_faces);
  conic_mesh_cells_release(b.cells);
  conic_memory_release(context, b.lengths);
  if (status == CONIC_OK)
    *hybrid = b.hybrid;
  else
    conic_hybrid_destroy(b.hybrid);
  return status;
}

conic_status conic_hybrid_build_file(conic_context *context, const char *mesh, const char *path,
                                     const conic_hybrid_options *options, const conic_hybrid_streaming *streaming,
                                     conic_hybrid **hybrid, conic_hybrid_report *report) {
  return conic_hybrid_build_cells(context, mesh, path, options, streaming, CONIC_HYBRID_CELL_FACES, hybrid, report);
}
