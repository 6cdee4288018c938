/* Chains: where two clusters meet, from one corner that a third has too to the next. A simpler cluster may leave out
 * what lies between a chain's ends. What a finer neighbour still has of it is put into both when they are drawn. */
#include "lod/clusters/cluster.h"

/* An edge between two clusters, its ends as places. */
typedef struct border_edge {
  uint32_t ends[2], clusters[2]; /* the lower cluster first */
  uint32_t is_taken;
} border_edge;

/* The edges between clusters that end at a place. */
typedef struct border_place {
  uint32_t edges[2];
  uint32_t vertices[2]; /* of the mesh that lie there: one of either cluster */
  uint32_t n;           /* how many; more than two where something else ends here too */
} border_place;

typedef struct finding {
  conic_context *context;
  const conic_clustered_mesh *mesh;
  const uint32_t *region;
  size_t n_edges;
  border_edge *edges;
  border_place *places; /* by vertex */
  conic_cluster_chains *chains;
} finding;

enum { CROWD = 3 };

static uint32_t place_of_vertex(const finding *f, uint32_t face, int corner) {
  return f->mesh->adjacency->place[f->mesh->mesh.faces[face][corner]];
}

/* The cluster across an edge of a face, if it is another one of the same region. */
static int is_between(const finding *f, uint32_t face, int corner, uint32_t *across_cluster) {
  uint32_t across = f->mesh->adjacency->across[3 * (size_t)face + (size_t)corner];
  const uint32_t *of_face = f->mesh->clusters->of_face;
  if (!conic_edge_is_shared(across))
    return 0;
  *across_cluster = of_face[across / 3];
  return f->region[*across_cluster] == f->region[of_face[face]];
}

/* The vertex of a face at a place that it has. */
static uint32_t vertex_at(const finding *f, uint32_t face, uint32_t place) {
  int corner = 0;
  while (corner < 2 && place_of_vertex(f, face, corner) != place)
    corner++;
  return f->mesh->mesh.faces[face][corner];
}

static void add_edge(finding *f, uint32_t face, int corner, uint32_t other) {
  uint32_t across = f->mesh->adjacency->across[3 * (size_t)face + (size_t)corner] / 3;
  uint32_t own = f->mesh->clusters->of_face[face], i = (uint32_t)f->n_edges++;
  border_edge *edge = &f->edges[i];
  edge->ends[0] = place_of_vertex(f, face, corner);
  edge->ends[1] = place_of_vertex(f, face, (corner + 1) % 3);
  edge->clusters[0] = own < other ? own : other;
  edge->clusters[1] = own < other ? other : own;
  edge->is_taken = 0;
  for (int k = 0; k < 2; k++) {
    border_place *place = &f->places[edge->ends[k]];
    place->vertices[own > other] = f->mesh->mesh.faces[face][(corner + k) % 3];
    place->vertices[own < other] = vertex_at(f, across, edge->ends[k]);
    if (place->n < 2)
      place->edges[place->n] = i;
    place->n = place->n < CROWD ? place->n + 1 : CROWD;
  }
}

/* The first of two faces tells of their edge. Open and crowded edges, and those between regions, end all chains. */
static void find_edges(finding *f) {
  size_t n_faces = f->mesh->starts[f->mesh->clusters->n_clusters];
  for (size_t i = 0; i < n_faces; i++)
    for (int corner = 0; corner < 3; corner++) {
      uint32_t face = f->mesh->faces[i], other;
      if (!conic_cluster_ends_at(f->mesh, face, corner))
        continue;
      if (!is_between(f, face, corner, &other))
        f->places[place_of_vertex(f, face, corner)].n = f->places[place_of_vertex(f, face, (corner + 1) % 3)].n = CROWD;
      else if (f->mesh->adjacency->across[3 * (size_t)face + (size_t)corner] / 3 > face)
        add_edge(f, face, corner, other);
    }
}

/* Whether a chain goes on through a place. */
static int goes_on(const finding *f, uint32_t place) {
  const border_place *p = &f->places[place];
  if (p->n != 2)
    return 0;
  const border_edge *a = &f->edges[p->edges[0]], *b = &f->edges[p->edges[1]];
  return a->clusters[0] == b->clusters[0] && a->clusters[1] == b->clusters[1] && p->edges[0] != p->edges[1];
}

/* The edge beyond a place, and where it leads. */
static uint32_t step(const finding *f, uint32_t edge, uint32_t *place) {
  const border_place *p = &f->places[*place];
  uint32_t next = p->edges[0] == edge ? p->edges[1] : p->edges[0];
  *place = f->edges[next].ends[0] == *place ? f->edges[next].ends[1] : f->edges[next].ends[0];
  return next;
}

static void put_slot(finding *f, uint32_t place, int is_between_ends) {
  conic_cluster_chains *c = f->chains;
  if (is_between_ends)
    c->of_vertex[place] = (uint32_t)c->n_slots;
  const uint32_t *vertices = f->places[place].vertices;
  c->slots[c->n_slots++] = (conic_cluster_slot){{vertices[0], vertices[1]}, CONIC_CLUSTER_ALWAYS};
}

/* Goes from an edge back to the chain's beginning, then along all of it. A closed chain begins where the edge does. */
static void trace(finding *f, uint32_t edge) {
  conic_cluster_chains *c = f->chains;
  uint32_t place = f->edges[edge].ends[0], first = edge, closed_at = place;
  while (goes_on(f, place)) {
    uint32_t next = step(f, first, &place);
    first = next;
    if (place == closed_at)
      break;
  }
  conic_chain *chain = &c->chains[c->n_chains];
  chain->first = (uint32_t)c->n_slots;
  memcpy(chain->clusters, f->edges[edge].clusters, sizeof chain->clusters);
  put_slot(f, place, 0);
  uint32_t begin = place, now = first;
  place = f->edges[now].ends[0] == place ? f->edges[now].ends[1] : f->edges[now].ends[0];
  f->edges[now].is_taken = 1;
  while (place != begin && goes_on(f, place)) {
    put_slot(f, place, 1);
    now = step(f, now, &place);
    f->edges[now].is_taken = 1;
  }
  put_slot(f, place, 0);
  chain->n = (uint32_t)c->n_slots - chain->first;
  if (chain->n < 3)
    c->n_slots = chain->first;
  else
    c->n_chains++;
}

static conic_status find(finding *f) {
  size_t n_vertices = f->mesh->mesh.n_vertices, n_faces = f->mesh->starts[f->mesh->clusters->n_clusters], n = 0;
  for (size_t i = 0; i < n_faces; i++)
    for (int corner = 0; corner < 3; corner++)
      n += (size_t)conic_cluster_ends_at(f->mesh, f->mesh->faces[i], corner);
  if (conic_memory_allocate_these(f->context, CONIC_ROOM(f->edges, n), CONIC_ZEROED(f->places, n_vertices),
                                  CONIC_ROOM(f->chains->chains, n), CONIC_ROOM(f->chains->slots, 2 * n),
                                  CONIC_ROOM(f->chains->of_vertex, n_vertices)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  memset(f->chains->of_vertex, 0xFF, n_vertices * sizeof *f->chains->of_vertex);
  find_edges(f);
  for (uint32_t i = 0; i < f->n_edges; i++)
    if (!f->edges[i].is_taken)
      trace(f, i);
  return CONIC_OK;
}

conic_status conic_cluster_chains_find(conic_context *context, const conic_clustered_mesh *mesh, const uint32_t *region,
                                       conic_cluster_chains *chains) {
  finding f = {.context = context, .mesh = mesh, .region = region, .chains = chains};
  memset(chains, 0, sizeof *chains);
  conic_status status = find(&f);
  conic_memory_release_these(context, f.places, f.edges);
  if (status != CONIC_OK)
    conic_cluster_chains_release(context, chains);
  return status;
}

void conic_cluster_chains_release(conic_context *context, conic_cluster_chains *chains) {
  conic_memory_release_these(context, chains->chains, chains->slots, chains->of_vertex);
  memset(chains, 0, sizeof *chains);
}
