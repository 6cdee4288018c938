/* From a mesh to a hybrid model: one index a corner, neighbours, clusters, and ways to draw each. */

#include "lod/hybrid/build/hybrid_build.h"
#include "core/splats/columns.h"

CONIC_DEFINE_OPTIONS(conic_hybrid_options, .phase1 = 0.12, .phase2 = 0.4, .density = 2.0, .most_error = 0.5,
                     .cutoff = 1.5f)

typedef struct building {
  conic_context *context;
  const conic_hybrid_options *options;
  conic_triangles flat;
  conic_adjacency adjacency;
  conic_mesh_clusters clusters;
  conic_clustered_mesh mesh;
  const conic_kept_splats *kept; /* null: none */
  uint32_t *faces;
  size_t *starts;
  conic_cluster_ways *ways;
  conic_hybrid_report *report;
  double most_error; /* above 0: in place of clusters' ways, those of the whole (lod/clusters/cluster_simplify.h) */
  int is_lent;       /* the mesh stays the caller's */
  size_t n_own;      /* faces; those behind them lie beside the model */
  size_t n_own_clusters;
} building;

static void release_building(building *b) {
  for (size_t i = 0; b->ways && i < b->clusters.n_clusters; i++)
    conic_cluster_ways_release(b->context, &b->ways[i]);
  conic_memory_release_these(b->context, b->ways, b->faces, b->starts);
  conic_mesh_clusters_release(b->context, &b->clusters);
  conic_adjacency_release(b->context, &b->adjacency);
  b->flat.materials = NULL; /* lent by the mesh */
  b->flat.n_materials = 0;
  conic_triangles_release(b->context, &b->flat);
}

/* --- splats that are kept as what they are, beside the surface that others became --- */

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
      g->clusters->of_face[g->kept->n_surface + 2 * (size_t)g->order[i] + k] = (uint32_t)g->clusters->n_clusters;
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

/* Puts the kept splats into clusters of their own, of up to MOST_KEPT that lie near each other, in place of their
 * faces' clusters. */
static conic_status group_kept(conic_context *context, const conic_kept_splats *kept, conic_mesh_clusters *clusters) {
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

/* --- clusters --- */

/* In place of clusters: pieces in the order of the faces, which all threads measure. */
static conic_status cut_pieces(building *b) {
  enum { PIECE_FACES = 2048 };
  conic_mesh_clusters *pieces = &b->clusters;
  size_t n = 0;
  if (conic_memory_allocate_these(b->context, CONIC_ROOM(pieces->of_face, b->flat.count),
                                  CONIC_ZEROED(pieces->is_gathered, b->flat.count / PIECE_FACES + 1)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < b->flat.count; i++)
    pieces->of_face[i] = b->adjacency.side[i] ? (uint32_t)(n++ / PIECE_FACES) : CONIC_NO_CLUSTER;
  pieces->n_clusters = pieces->n_first = (n + PIECE_FACES - 1) / PIECE_FACES;
  return CONIC_OK;
}

/* The share of the area where none is given: that of some 2000 faces if all are of one size; for small meshes a
 * fiftieth. */
static double most_area_of(const building *b) {
  double share = 2000.0 / (double)b->flat.count;
  return b->options->most_area > 0.0 ? b->options->most_area : share < 0.02 ? share : 0.02;
}

/* No cluster has both faces of its own and others. */
static void part_from_others(building *b) {
  conic_adjacency *a = &b->adjacency;
  size_t n = 0;
  for (size_t i = 0; i < a->n_joints; i++)
    if ((a->joints[i].faces[0] < b->n_own) == (a->joints[i].faces[1] < b->n_own))
      a->joints[n++] = a->joints[i];
  a->n_joints = n;
}

static conic_status find_clusters(building *b) {
  const conic_clustering_options options = {b->options->phase1, b->options->phase2, most_area_of(b)};
  conic_clustered_mesh *mesh = &b->mesh;
  mesh->triangles = &b->flat;
  mesh->mesh = (conic_mesh){.n_vertices = b->flat.n_vertices,
                            .n_faces = b->flat.count,
                            .position = {b->flat.position[0], b->flat.position[1], b->flat.position[2]},
                            .faces = (const uint32_t(*)[3])b->flat.corners};
  mesh->adjacency = &b->adjacency;
  mesh->clusters = &b->clusters;
  mesh->kept = b->kept;
  conic_status status = conic_adjacency_find(b->context, &mesh->mesh, &b->adjacency);
  if (status == CONIC_OK)
    part_from_others(b);
  if (status == CONIC_OK)
    status = b->most_error > 0.0
                 ? cut_pieces(b)
                 : conic_mesh_clusters_find(b->context, &mesh->mesh, &b->adjacency, &options, &b->clusters);
  if (status == CONIC_OK && b->kept)
    status = group_kept(b->context, b->kept, &b->clusters);
  /* Clusters are numbered by their first faces: others come last. */
  for (size_t i = 0; i < b->flat.count && i < b->n_own && status == CONIC_OK; i++)
    if (b->clusters.of_face[i] != CONIC_NO_CLUSTER && b->clusters.of_face[i] >= b->n_own_clusters)
      b->n_own_clusters = (size_t)b->clusters.of_face[i] + 1;
  if (status == CONIC_OK && b->n_own_clusters == 0)
    status = conic_fail(b->context, CONIC_ERROR_INPUT, "the mesh has no face that could be drawn");
  return status;
}

/* A counting sort of the faces by cluster. */
static void sort_faces(building *b) {
  const uint32_t *of_face = b->clusters.of_face;
  memset(b->starts, 0, (b->clusters.n_clusters + 2) * sizeof *b->starts);
  for (size_t i = 0; i < b->flat.count; i++)
    if (of_face[i] != CONIC_NO_CLUSTER)
      b->starts[of_face[i] + 2]++;
  for (size_t i = 0; i < b->clusters.n_clusters; i++)
    b->starts[i + 2] += b->starts[i + 1];
  for (size_t i = 0; i < b->flat.count; i++)
    if (of_face[i] != CONIC_NO_CLUSTER)
      b->faces[b->starts[of_face[i] + 1]++] = (uint32_t)i;
  b->mesh.faces = b->faces;
  b->mesh.starts = b->starts;
}

/* Numbers the clusters as the hierarchy has them: near each other where they are near. */
static conic_status order_clusters(building *b) {
  size_t n = b->clusters.n_clusters, n_own = b->n_own_clusters;
  conic_hybrid_bound *bounds;
  uint32_t *order, *rank;
  uint8_t *is_gathered, *is_kept;
  conic_status status =
      conic_memory_allocate_these(b->context, CONIC_ROOM(bounds, n), CONIC_ROOM(order, n), CONIC_ROOM(rank, n),
                                  CONIC_ROOM(is_gathered, n), CONIC_ROOM(is_kept, n));
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    bounds[i] = conic_cluster_bound(&b->mesh, (uint32_t)i);
    is_kept[i] = (uint8_t)conic_cluster_is_kept(&b->mesh, (uint32_t)i);
  }
  if (status == CONIC_OK)
    status = conic_hybrid_order(b->context, bounds, is_kept, n_own, order);
  if (status == CONIC_OK) {
    for (size_t i = n_own; i < n; i++)
      order[i] = (uint32_t)i;
    memcpy(is_gathered, b->clusters.is_gathered, n);
    for (size_t i = 0; i < n; i++) {
      rank[order[i]] = (uint32_t)i;
      b->clusters.is_gathered[i] = is_gathered[order[i]];
    }
    for (size_t i = 0; i < b->flat.count; i++)
      if (b->clusters.of_face[i] != CONIC_NO_CLUSTER)
        b->clusters.of_face[i] = rank[b->clusters.of_face[i]];
    sort_faces(b);
  }
  conic_memory_release_these(b->context, is_kept, is_gathered, rank, order, bounds);
  return status;
}

static conic_status make_clusters(building *b) {
  size_t n = b->clusters.n_clusters;
  if (conic_memory_allocate_these(b->context, CONIC_ROOM(b->faces, b->flat.count), CONIC_ROOM(b->starts, n + 2),
                                  CONIC_ZEROED(b->ways, n)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  sort_faces(b);
  return order_clusters(b);
}

/* --- all --- */

static void report_oddities(building *b, const conic_triangles *mesh) {
  const conic_mesh_oddities *o = &b->adjacency.oddities;
  conic_hybrid_report *r = b->report;
  if (b->kept) { /* faces that stand for splats are as they must be */
    r->n_faces = b->kept->n_surface;
    r->n_first = b->clusters.n_first - b->kept->n;
    return;
  }
  r->n_faces = mesh->count;
  r->nan = o->nan;
  r->zero = o->zero;
  r->welded = o->welded;
  r->open = o->open;
  r->crowded = o->crowded;
  r->twisted = o->twisted;
  r->turned = o->turned;
  r->n_pieces = o->n_pieces;
  r->n_first = b->clusters.n_first;
}

static conic_status take_options(conic_context *context, const conic_hybrid_options *given, conic_hybrid_options *o) {
  conic_hybrid_options_init(o);
  int is_good = conic_options_take(o, given) && o->phase1 - o->phase1 == 0.0 && o->phase2 - o->phase2 == 0.0 &&
                o->most_area >= 0.0 && o->density > 0.0 && o->density <= 1024.0 && o->most_error >= 0.0 &&
                o->cutoff >= 0.25f && o->cutoff <= 5.0f &&
                (o->sampling == CONIC_SAMPLING_BLUE || o->sampling == CONIC_SAMPLING_BOX);
  return is_good ? CONIC_OK
                 : conic_fail(context, CONIC_ERROR_ARGUMENT, "an option of the hybrid model is out of range");
}

static conic_status build_hybrid(building *b, conic_triangles *mesh, conic_hybrid **hybrid) {
  double start = conic_seconds_now();
  conic_status status = conic_flat_mesh(b->context, mesh, &b->flat);
  if (status != CONIC_OK)
    return status;
  b->flat.n_materials = mesh->n_materials;
  b->flat.materials = mesh->materials;
  status = find_clusters(b);
  if (status == CONIC_OK)
    status = make_clusters(b);
  if (status != CONIC_OK)
    return status;
  report_oddities(b, mesh);
  b->report->cluster_seconds = conic_seconds_now() - start;
  conic_ways_job ways = {.context = b->context,
                         .mesh = &b->mesh,
                         .options = b->options,
                         .most_error = b->most_error,
                         .n_clusters = b->n_own_clusters,
                         .ways = b->ways};
  status = conic_find_ways(&ways);
  b->report->sample_seconds = ways.sample_seconds;
  b->report->simplify_seconds = ways.simplify_seconds;
  if (status == CONIC_OK)
    status = conic_hybrid_pack(&ways, hybrid);
  conic_cluster_chains_release(b->context, &ways.chains);
  conic_nodes_release(&ways);
  return status;
}

/* All of a mesh, or its first n_own faces; its last ones may stand for splats. */
static conic_status build_some(building b, conic_triangles *mesh, const conic_hybrid_options *given,
                               conic_hybrid **hybrid, conic_hybrid_report *report) {
  conic_context *context = b.context;
  conic_hybrid_report ignored;
  conic_hybrid_options options;
  b.options = &options;
  b.report = report ? report : &ignored;
  *hybrid = NULL;
  memset(b.report, 0, sizeof *b.report);
  conic_status status = conic_triangles_check_own(context, "the mesh", mesh);
  if (status != CONIC_OK)
    return status;
  status = take_options(context, given, &options);
  if (status == CONIC_OK)
    status = conic_triangles_check(context, mesh, "the mesh");
  if (status == CONIC_OK)
    status = build_hybrid(&b, mesh, hybrid);
  release_building(&b);
  if (!b.is_lent)
    conic_triangles_release(context, mesh);
  if (status != CONIC_OK) {
    conic_hybrid_destroy(*hybrid);
    *hybrid = NULL;
  }
  return status;
}

conic_status conic_hybrid_build(conic_context *context, conic_triangles *mesh, const conic_hybrid_options *options,
                                conic_hybrid **hybrid, conic_hybrid_report *report) {
  return build_some((building){.context = context, .n_own = SIZE_MAX}, mesh, options, hybrid, report);
}

conic_status conic_hybrid_build_lent(conic_context *context, const conic_triangles *mesh,
                                     const conic_hybrid_options *options, double most_error, conic_hybrid **hybrid) {
  const building b = {.context = context, .n_own = SIZE_MAX, .most_error = most_error, .is_lent = 1};
  conic_triangles lent = *mesh;
  conic_hybrid_options single = *options;
  single.has_single_levels |= most_error > 0.0;
  return build_some(b, &lent, &single, hybrid, NULL);
}

conic_status conic_hybrid_build_part(conic_context *context, conic_triangles *mesh, size_t n_own,
                                     const conic_hybrid_options *options, conic_hybrid **hybrid,
                                     conic_hybrid_report *report) {
  return build_some((building){.context = context, .n_own = n_own}, mesh, options, hybrid, report);
}

conic_status conic_hybrid_build_with(conic_context *context, conic_triangles *mesh, const conic_kept_splats *kept,
                                     const conic_hybrid_options *options, conic_hybrid **hybrid,
                                     conic_hybrid_report *report) {
  return build_some((building){.context = context, .kept = kept, .n_own = SIZE_MAX}, mesh, options, hybrid, report);
}
