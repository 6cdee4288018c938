/* Creases of a mesh. The faces around a vertex fall into wedges, each smooth in itself; the vertex becomes one vertex a
 * wedge, so that each gets an ellipse from its own side alone. What of it reaches over the crease is clipped where its
 * plane meets its mate's: both are clipped at the same line in space, whatever the surface does around it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/vectors.h"
#include "core/splats/features.h"
#include "core/splats/incidence.h"
#include "core/splats/splats_gather.h"

/* An edge that starts at the vertex in hand, in one of its triangles. */
typedef struct spoke {
  uint32_t other, inside; /* the edge's other end, and the triangle's third vertex */
  uint32_t triangle;
  uint32_t member; /* which of the vertex's triangles that is, as they are listed */
  int is_outgoing; /* the triangle runs from the vertex to `other` */
} spoke;

typedef struct splitting {
  conic_context *context;
  const conic_model *model;
  double cosine;
  double (*normals)[3]; /* of each triangle, unit; zero without an area */
  conic_incidence ring; /* a vertex's triangles are its members */
  spoke *spokes;        /* of one vertex */
  uint32_t *parents;    /* of the members of one vertex: a forest, whose trees are the wedges */
  uint32_t *wedges;     /* by position in the ring's triangles: the vertex that this corner gets */
  uint32_t *sources;    /* by new vertex: the old one */
  size_t n_vertices;    /* so far */
  conic_crease *creases;
  size_t n_creases, crease_capacity;
} splitting;

static void find_face_normal(const conic_model *model, const uint32_t triangle[3], double normal[3]) {
  double edges[2][3];
  for (int i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      edges[i][axis] =
          (double)model->points.position[axis][triangle[i + 1]] - (double)model->points.position[axis][triangle[0]];
  conic_cross(edges[0], edges[1], normal);
  conic_normalize(normal);
}

/* The way there is halved each time, so that long chains do not stay long. */
static uint32_t root_of(uint32_t *parents, uint32_t member) {
  while (parents[member] != member) {
    parents[member] = parents[parents[member]];
    member = parents[member];
  }
  return member;
}

/* The smaller root stays, so that the order in which trees are joined does not show. */
static void join_wedges(uint32_t *parents, uint32_t a, uint32_t b) {
  a = root_of(parents, a);
  b = root_of(parents, b);
  if (a < b)
    parents[b] = a;
  else
    parents[a] = b;
}

static int compare_spokes(const void *first, const void *second) {
  const spoke *a = first, *b = second;
  return a->other != b->other ? (a->other > b->other) - (a->other < b->other)
                              : (a->member > b->member) - (a->member < b->member);
}

/* The edges at a vertex, those to the same other end side by side. */
static size_t list_spokes(const splitting *s, size_t vertex) {
  size_t n = 0;
  for (size_t i = s->ring.starts[vertex]; i < s->ring.starts[vertex + 1]; i++) {
    const uint32_t *t = s->model->triangles[s->ring.triangles[i]];
    int at = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
    uint32_t member = (uint32_t)(i - s->ring.starts[vertex]), next = t[(at + 1) % 3], after = t[(at + 2) % 3];
    s->spokes[n++] = (spoke){next, after, s->ring.triangles[i], member, 1};
    s->spokes[n++] = (spoke){after, next, s->ring.triangles[i], member, 0};
  }
  qsort(s->spokes, n, sizeof *s->spokes, compare_spokes);
  return n;
}

/* Two triangles that run along their edge in the same direction face opposite ways. A triangle without area has no
 * normal, and hangs together with whatever is beside it. */
static int is_smooth(const splitting *s, const spoke *a, const spoke *b) {
  const double *m = s->normals[a->triangle], *n = s->normals[b->triangle];
  double cosine = m[0] * n[0] + m[1] * n[1] + m[2] * n[2];
  int has_normals = (m[0] != 0.0 || m[1] != 0.0 || m[2] != 0.0) && (n[0] != 0.0 || n[1] != 0.0 || n[2] != 0.0);
  return !has_normals || (a->is_outgoing == b->is_outgoing ? -cosine : cosine) >= s->cosine;
}

/* How many spokes from `i` on have the same other end. */
static size_t run_of(const spoke *spokes, size_t i, size_t n) {
  size_t end = i + 1;
  while (end < n && spokes[end].other == spokes[i].other)
    end++;
  return end - i;
}

static conic_status add_crease(splitting *s, uint32_t wedge, uint32_t mate, uint32_t inside) {
  if (conic_memory_reserve(s->context, &s->creases, s->n_creases, s->n_creases + 1, &s->crease_capacity,
                           sizeof *s->creases) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  s->creases[s->n_creases++] = (conic_crease){wedge, mate, inside};
  return CONIC_OK;
}

/* Numbers the wedges of a vertex: the first one keeps the vertex's number. */
static conic_status number_wedges(splitting *s, size_t vertex) {
  size_t first = s->ring.starts[vertex], n = s->ring.starts[vertex + 1] - first;
  for (uint32_t member = 0; member < n; member++) {
    uint32_t root = root_of(s->parents, member);
    if (root != member)
      s->wedges[first + member] = s->wedges[first + root];
    else if (member == 0)
      s->wedges[first] = (uint32_t)vertex;
    else {
      if (s->n_vertices >= UINT32_MAX - 1)
        return conic_fail(s->context, CONIC_ERROR_ARGUMENT, "features: too many vertices");
      s->sources[s->n_vertices] = (uint32_t)vertex;
      s->wedges[first + member] = (uint32_t)s->n_vertices++;
    }
  }
  return CONIC_OK;
}

static conic_status split_vertex(splitting *s, size_t vertex) {
  size_t first = s->ring.starts[vertex], n_members = s->ring.starts[vertex + 1] - first, n = list_spokes(s, vertex);
  for (uint32_t member = 0; member < n_members; member++)
    s->parents[member] = member;
  for (size_t i = 0, run; i < n; i += run) {
    run = run_of(s->spokes, i, n);
    if (run == 2 && is_smooth(s, &s->spokes[i], &s->spokes[i + 1]))
      join_wedges(s->parents, s->spokes[i].member, s->spokes[i + 1].member);
  }
  conic_status status = number_wedges(s, vertex);
  for (size_t i = 0, run; status == CONIC_OK && i < n; i += run) {
    const spoke *a = &s->spokes[i], *b = &s->spokes[i + 1];
    run = run_of(s->spokes, i, n);
    if (run != 2 || s->wedges[first + a->member] == s->wedges[first + b->member])
      continue;
    status = add_crease(s, s->wedges[first + a->member], s->wedges[first + b->member], a->inside);
    if (status == CONIC_OK)
      status = add_crease(s, s->wedges[first + b->member], s->wedges[first + a->member], b->inside);
  }
  return status;
}

/* Puts the wedges' numbers into a copy of the triangles, and of the creases. */
static conic_status renumber(splitting *s, conic_model *split) {
  const conic_model *model = s->model;
  split->triangles = conic_memory_allocate(s->context, model->n_triangles, sizeof *split->triangles);
  if (!split->triangles)
    return CONIC_ERROR_MEMORY;
  split->n_triangles = model->n_triangles;
  memcpy(split->triangles, model->triangles, model->n_triangles * sizeof *split->triangles);
  for (size_t vertex = 0; vertex < model->points.count; vertex++)
    for (size_t i = s->ring.starts[vertex]; i < s->ring.starts[vertex + 1]; i++)
      for (int j = 0; j < 3; j++)
        if (model->triangles[s->ring.triangles[i]][j] == vertex)
          split->triangles[s->ring.triangles[i]][j] = s->wedges[i];
  return CONIC_OK;
}

static int is_split(const splitting *s, size_t vertex) {
  for (size_t i = s->ring.starts[vertex]; i < s->ring.starts[vertex + 1]; i++)
    if (s->wedges[i] != vertex)
      return 1;
  return 0;
}

/* A file's normal is the mean over the crease, or that of one side: each wedge takes the mean of its faces. */
static void set_normals(const splitting *s, conic_splats *points) {
  for (size_t vertex = 0; points->normal[0] && vertex < s->model->points.count; vertex++) {
    if (!is_split(s, vertex))
      continue;
    for (int pass = 0; pass < 2; pass++)
      for (size_t i = s->ring.starts[vertex]; i < s->ring.starts[vertex + 1]; i++)
        for (int axis = 0; axis < 3; axis++) {
          float *normal = &points->normal[axis][s->wedges[i]];
          *normal = pass ? *normal + (float)s->normals[s->ring.triangles[i]][axis] : 0.0f;
        }
  }
}

/* Sorts the creases by wedge, and finds where each wedge's begin. */
static conic_status sort_creases(splitting *s, conic_creases *creases) {
  creases->starts = conic_memory_allocate_zeroed(s->context, s->n_vertices + 2, sizeof *creases->starts);
  creases->all = conic_memory_allocate(s->context, s->n_creases, sizeof *creases->all);
  if (!creases->starts || !creases->all)
    return CONIC_ERROR_MEMORY;
  creases->n = s->n_creases;
  for (size_t i = 0; i < s->n_creases; i++)
    creases->starts[s->creases[i].wedge + 2]++;
  for (size_t vertex = 0; vertex < s->n_vertices; vertex++)
    creases->starts[vertex + 2] += creases->starts[vertex + 1];
  for (size_t i = 0; i < s->n_creases; i++)
    creases->all[creases->starts[s->creases[i].wedge + 1]++] = s->creases[i];
  return CONIC_OK;
}

/* All but what hangs on the greatest number of triangles at a vertex. */
static int make_room_for_split(splitting *s) {
  const conic_model *model = s->model;
  conic_context *context = s->context;
  size_t n_corners = 3 * model->n_triangles;
  s->normals = conic_memory_allocate(context, model->n_triangles, sizeof *s->normals);
  s->wedges = conic_memory_allocate(context, n_corners, sizeof *s->wedges);
  s->sources = conic_memory_allocate(context, model->points.count + n_corners, sizeof *s->sources);
  return s->normals && s->wedges && s->sources;
}

static conic_status split_vertices(splitting *s) {
  size_t n = s->model->points.count, greatest = 0;
  for (size_t vertex = 0; vertex < n; vertex++) {
    size_t n_members = s->ring.starts[vertex + 1] - s->ring.starts[vertex];
    greatest = n_members > greatest ? n_members : greatest;
    s->sources[vertex] = (uint32_t)vertex;
  }
  s->n_vertices = n;
  s->spokes = conic_memory_allocate(s->context, 2 * greatest, sizeof *s->spokes);
  s->parents = conic_memory_allocate(s->context, greatest, sizeof *s->parents);
  if (!s->spokes || !s->parents)
    return CONIC_ERROR_MEMORY;
  for (size_t vertex = 0; vertex < n; vertex++) {
    conic_status status = split_vertex(s, vertex);
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

static void release_splitting(splitting *s) {
  void *all[] = {s->normals, s->spokes, s->parents, s->wedges, s->sources, s->creases};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    conic_memory_release(s->context, all[i]);
  conic_incidence_release(s->context, &s->ring);
}

static conic_status split_model(splitting *s, conic_model *split, conic_creases *creases) {
  if (!make_room_for_split(s))
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < s->model->n_triangles; i++)
    find_face_normal(s->model, s->model->triangles[i], s->normals[i]);
  conic_status status = split_vertices(s);
  if (status == CONIC_OK)
    status = conic_splats_gather(s->context, &s->model->points, s->sources, s->n_vertices, &split->points);
  if (status == CONIC_OK)
    status = renumber(s, split);
  if (status == CONIC_OK)
    status = sort_creases(s, creases);
  if (status == CONIC_OK)
    set_normals(s, &split->points);
  return status;
}

conic_status conic_creases_split(conic_context *context, double cosine, const conic_model *model, conic_model *split,
                                 conic_creases *creases) {
  splitting s = {.context = context, .model = model, .cosine = cosine};
  memset(split, 0, sizeof *split);
  memset(creases, 0, sizeof *creases);
  conic_status status = conic_incidence_create(context, model, UINT32_MAX / 3, &s.ring);
  if (status == CONIC_OK)
    status = split_model(&s, split, creases);
  release_splitting(&s);
  split->kind = model->kind;
  memcpy(split->up, model->up, sizeof split->up);
  if (status != CONIC_OK) {
    conic_model_release(context, split);
    conic_creases_release(context, creases);
  }
  return status;
}

void conic_creases_release(conic_context *context, conic_creases *creases) {
  conic_memory_release(context, creases->all);
  conic_memory_release(context, creases->starts);
  memset(creases, 0, sizeof *creases);
}
