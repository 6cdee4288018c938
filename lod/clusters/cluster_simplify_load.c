/* The region as simplifying has it. */

#include "lod/clusters/cluster_simplifier.h"

/* How much more a border's planes weigh than the faces' (HQP §3.2.4). */
static const double border_weight = 10.0;

void conic_simplifier_release_region(conic_simplifier *s) {
  conic_memory_release_these(s->context, s->vertices, s->triangles, s->points, s->alive, s->taken, s->errors2,
                             s->queue.keys, s->queue.slots, s->point_starts[0], s->point_starts[1], s->border_starts,
                             s->spokes, s->originals, s->near, s->wedges, s->changes, s->hits, s->contrasts,
                             s->borders);
}

/* Edges have a point each, and at most two on a border; they are at most three a face. */
static conic_status make_room_for_region(conic_simplifier *s, size_t n_vertices, size_t n_faces) {
  size_t n = s->end - s->begin;
  conic_simplifier_release_region(s);
  s->hits = NULL;
  s->contrasts = NULL;
  s->borders = NULL;
  conic_status status = conic_memory_allocate_these(
      s->context, CONIC_ROOM(s->vertices, n_vertices), CONIC_ROOM(s->triangles, n_faces),
      CONIC_ROOM(s->points, n_vertices + 7 * n_faces), CONIC_ZEROED(s->alive, n), CONIC_ZEROED(s->taken, n),
      CONIC_ZEROED(s->errors2, n), CONIC_ROOM(s->queue.keys, n_vertices), CONIC_ROOM(s->queue.slots, n_vertices),
      CONIC_ROOM(s->point_starts[0], n + 1), CONIC_ROOM(s->point_starts[1], n + 1), CONIC_ROOM(s->border_starts, n + 1),
      CONIC_ROOM(s->spokes, 2 * n_faces), CONIC_ROOM(s->originals, n_faces), CONIC_ROOM(s->near, n_faces),
      CONIC_ROOM(s->wedges, n_faces), CONIC_ZEROED(s->changes, n));
  if (status == CONIC_OK && s->is_one)
    status = conic_memory_allocate_these(s->context, CONIC_ROOM(s->hits, n_faces));
  if (status == CONIC_OK && conic_has_seen_colors(s->mesh->triangles))
    status = conic_memory_allocate_these(s->context, CONIC_ROOM(s->contrasts, n_faces));
  return status;
}

/* Numbers the region's places. */
static void number_places(conic_simplifier *s) {
  const conic_clustered_mesh *mesh = s->mesh;
  s->n_vertices = 0;
  for (size_t i = mesh->starts[s->begin]; i < mesh->starts[s->end]; i++)
    for (int corner = 0; corner < 3; corner++) {
      uint32_t place = mesh->adjacency->place[mesh->mesh.faces[mesh->faces[i]][corner]];
      if (s->number[place] == CONIC_NONE)
        s->number[place] = (uint32_t)s->n_vertices++;
    }
}

void conic_region_end(conic_simplifier *s) {
  const conic_clustered_mesh *mesh = s->mesh;
  for (size_t i = mesh->starts[s->begin]; i < mesh->starts[s->end]; i++)
    for (int corner = 0; corner < 3; corner++)
      s->number[mesh->adjacency->place[mesh->mesh.faces[mesh->faces[i]][corner]]] = CONIC_NONE;
}

/* The middle of some of a triangle's corners, which are bits. */
static void add_point(conic_simplifier *s, uint32_t i_vertex, const double at[3], uint32_t triangle, uint32_t corners) {
  conic_simplifier_point *p = &s->points[s->n_points++];
  memcpy(p->at, at, sizeof p->at);
  p->vertex = i_vertex;
  p->triangle = triangle;
  p->corners = corners;
}

/* The region's number of a mesh's vertex. */
static uint32_t use_vertex(conic_simplifier *s, uint32_t triangle, int corner, uint32_t material) {
  uint32_t original = s->originals[triangle][corner];
  uint32_t i = s->number[s->mesh->adjacency->place[original]];
  conic_simplifier_vertex *v = &s->vertices[i];
  if (v->original == CONIC_NONE) {
    v->original = original;
    v->material = material;
    for (int axis = 0; axis < 3; axis++)
      v->at[axis] = (double)s->mesh->mesh.position[axis][original];
    add_point(s, i, v->at, triangle, 1u << corner);
  } else if (v->original != original || v->material != material)
    v->is_seam = 1;
  return i;
}

/* What its colours need to be known of a face. */
static void note_face(conic_simplifier *s, uint32_t triangle) {
  double cross[3];
  s->contrasts[triangle][0] = (float)conic_seen_contrast(s->mesh->triangles, s->triangles[triangle].face);
  s->contrasts[triangle][1] = (float)conic_simplifier_twice_area(s, triangle, cross);
}

/* A face is nearest to itself. */
static void begin_hit(conic_simplifier *s, uint32_t triangle) {
  float *const *normals = s->mesh->triangles->normal;
  double normal[3] = {0.0, 0.0, 0.0}, cross[3];
  for (int k = 0; k < 9 && normals[0]; k++)
    normal[k % 3] += (double)normals[k % 3][s->originals[triangle][k / 3]];
  conic_normalize(normal);
  conic_simplifier_hit *hit = &s->hits[triangle];
  *hit = (conic_simplifier_hit){.area2 = (float)conic_simplifier_twice_area(s, triangle, cross), .triangle = triangle};
  for (int axis = 0; axis < 3; axis++)
    hit->normal[axis] = (float)normal[axis];
}

static void add_region_triangle(conic_simplifier *s, uint32_t cluster, uint32_t face) {
  uint32_t i = (uint32_t)s->n_triangles++;
  conic_simplifier_triangle *t = &s->triangles[i];
  double middle[3] = {0.0, 0.0, 0.0};
  t->face = s->near[i][0] = s->near[i][1] = s->near[i][2] = s->near[i][3] = face;
  t->cluster = s->is_one ? 0 : cluster;
  t->is_alive = 1;
  s->alive[t->cluster]++;
  conic_cluster_face_normal(s->mesh, face, t->normal);
  for (int corner = 0; corner < 3; corner++) {
    const uint32_t *materials = s->mesh->triangles->material;
    s->originals[i][corner] = s->mesh->mesh.faces[face][corner];
    uint32_t k = use_vertex(s, i, corner, materials ? materials[face] : 0);
    conic_simplifier_vertex *v = &s->vertices[k];
    t->corners[corner] = k;
    t->next[corner] = v->ring;
    v->ring = 3 * i + (uint32_t)corner;
    for (int axis = 0; axis < 3; axis++)
      middle[axis] += v->at[axis] / 3.0;
  }
  if (s->contrasts)
    note_face(s, i);
  if (s->hits)
    begin_hit(s, i);
  add_point(s, t->corners[0], middle, i, 7);
  for (int corner = 0; corner < 3; corner++) {
    uint32_t across = s->mesh->adjacency->across[3 * (size_t)face + (size_t)corner];
    const double *a = s->vertices[t->corners[corner]].at, *b = s->vertices[t->corners[(corner + 1) % 3]].at;
    const double half[3] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
    if (conic_cluster_ends_at(s->mesh, face, corner) || across / 3 > face) /* of two faces the one */
      add_point(s, t->corners[corner], half, i, 1u << corner | 1u << (corner + 1) % 3);
  }
}

/* --- borders --- */

static void stand_on_edge(const conic_simplifier_triangle *t, conic_simplifier_vertex *ends[2]) {
  double side[3], upright[3];
  for (int axis = 0; axis < 3; axis++)
    side[axis] = ends[1]->at[axis] - ends[0]->at[axis];
  conic_cross(side, t->normal, upright);
  double length = conic_length(upright);
  if (!(length > 0.0))
    return;
  for (int axis = 0; axis < 3; axis++)
    upright[axis] /= length;
  for (int k = 0; k < 2; k++)
    conic_quadric_add_plane(&ends[k]->quadric, upright, -conic_dot(upright, ends[0]->at),
                            border_weight * length * length);
}

/* The ends of an edge on a border are on an open one, or within a chain, or they stay. */
static void treat_border(conic_simplifier *s, const conic_simplifier_triangle *t, int corner) {
  uint32_t across = s->mesh->adjacency->across[3 * (size_t)t->face + (size_t)corner];
  conic_simplifier_vertex *ends[2] = {&s->vertices[t->corners[corner]], &s->vertices[t->corners[(corner + 1) % 3]]};
  if (!conic_cluster_ends_at(s->mesh, t->face, corner))
    return;
  /* it is of each cluster that has it */
  add_point(s, t->corners[corner], ends[0]->at, (uint32_t)(t - s->triangles), 1u << corner);
  for (int k = 0; k < 2; k++) {
    uint32_t place = s->mesh->adjacency->place[ends[k]->original];
    uint8_t kind = across == CONIC_OPEN_EDGE                      ? CONIC_VERTEX_BORDER
                   : s->chains->of_vertex[place] != CONIC_NO_SLOT ? CONIC_VERTEX_CHAIN
                                                                  : CONIC_VERTEX_LOCKED;
    ends[k]->kind = ends[k]->kind == CONIC_VERTEX_FREE || ends[k]->kind == kind ? kind : CONIC_VERTEX_LOCKED;
  }
  if (across == CONIC_OPEN_EDGE)
    stand_on_edge(t, ends);
}

static void add_planes(conic_simplifier *s, const conic_simplifier_triangle *t) {
  double sides[2][3], cross[3];
  for (int k = 0; k < 2; k++)
    for (int axis = 0; axis < 3; axis++)
      sides[k][axis] = s->vertices[t->corners[k + 1]].at[axis] - s->vertices[t->corners[0]].at[axis];
  conic_cross(sides[0], sides[1], cross);
  double d = -conic_dot(t->normal, s->vertices[t->corners[0]].at), area2 = conic_length(cross);
  for (int corner = 0; corner < 3; corner++)
    conic_quadric_add_plane(&s->vertices[t->corners[corner]].quadric, t->normal, d, area2);
}

conic_status conic_simplifier_load(conic_simplifier *s) {
  const conic_clustered_mesh *mesh = s->mesh;
  const size_t *starts = mesh->starts + s->begin;
  uint32_t n_clusters = s->end - s->begin;
  number_places(s);
  conic_status status = make_room_for_region(s, s->n_vertices, starts[n_clusters] - starts[0]);
  if (status != CONIC_OK)
    return status;
  s->n_triangles = s->n_points = s->queue.n = 0;
  s->stage = 0;
  memset(s->vertices, 0, s->n_vertices * sizeof *s->vertices);
  for (size_t i = 0; i < s->n_vertices; i++)
    s->vertices[i].original = s->vertices[i].ring = s->vertices[i].target = s->vertices[i].moved = CONIC_NONE;
  for (uint32_t cluster = 0; cluster < n_clusters; cluster++) {
    s->point_starts[0][cluster] = s->n_points;
    for (size_t i = starts[cluster]; i < starts[cluster + 1]; i++)
      add_region_triangle(s, cluster, mesh->faces[i]);
  }
  s->point_starts[0][n_clusters] = s->n_points;
  memcpy(s->taken, s->alive, n_clusters * sizeof *s->taken);
  s->n_alive = s->n_triangles;
  for (uint32_t cluster = 0; cluster < n_clusters; cluster++) {
    s->point_starts[1][cluster] = s->n_points;
    for (size_t i = starts[cluster] - starts[0]; i < starts[cluster + 1] - starts[0]; i++) {
      for (int corner = 0; corner < 3; corner++)
        treat_border(s, &s->triangles[i], corner);
      add_planes(s, &s->triangles[i]);
    }
  }
  s->point_starts[1][n_clusters] = s->n_points;
  return CONIC_OK;
}
