#include "lod/patch_simplify.h"

#include <math.h>
#include <string.h>

#include "core/heap.h"
#include "core/memory.h"
#include "lod/distance.h"
#include "lod/quadric.h"

static const uint32_t none = UINT32_MAX;

/* How much more a border's planes weigh than the faces' (HQP §3.2.4), and the least cosine by which a face may turn. */
static const double border_weight = 10.0;
static const double least_turn = 0.2;

typedef enum vertex_kind {
  VERTEX_FREE = 0,   /* faces of the patch all around */
  VERTEX_BORDER = 1, /* on an open border, along which it may go */
  VERTEX_LOCKED = 2  /* another patch has it too; or its surroundings are no surface, or its attributes differ */
} vertex_kind;

typedef struct vertex {
  uint32_t original;             /* in the mesh */
  uint32_t material;             /* of its faces */
  uint32_t ring;                 /* its first slot, 3 · triangle + corner, or none */
  uint32_t target;               /* what it would best be drawn onto */
  uint8_t kind, is_old, is_seam; /* is_seam: its attributes differ from face to face */
  double at[3];
  conic_quadric quadric;
} vertex;

typedef struct triangle {
  uint32_t corners[3];   /* vertices */
  uint32_t originals[3]; /* of the mesh: with their attributes */
  uint32_t next[3];      /* slots in the rings */
  uint32_t face, points;
  double normal[3]; /* of the mesh's face */
  int is_alive;
} triangle;

/* A place of the mesh that the simpler triangles are compared with. */
typedef struct point {
  double at[3], distance2;
  uint32_t next;
} point;

struct conic_simplifier {
  conic_context *context;
  const conic_patch_mesh *mesh;
  uint32_t *number; /* of each place of the mesh, while its patch is worked on; else none */
  size_t n_vertices, vertices_room, n_triangles, triangles_room, n_points, points_room, n_alive;
  vertex *vertices;
  triangle *triangles;
  point *points;
  double *keys;
  uint32_t *slots;
  conic_heap queue;
};

conic_status conic_simplifier_create(conic_context *context, const conic_patch_mesh *mesh,
                                     conic_simplifier **simplifier) {
  conic_simplifier *s = conic_memory_allocate_zeroed(context, 1, sizeof *s);
  *simplifier = s;
  if (!s)
    return CONIC_ERROR_MEMORY;
  s->context = context;
  s->mesh = mesh;
  s->number = conic_memory_allocate(context, mesh->mesh.n_vertices, sizeof *s->number);
  if (!s->number) {
    conic_simplifier_destroy(s);
    *simplifier = NULL;
    return CONIC_ERROR_MEMORY;
  }
  memset(s->number, 0xFF, mesh->mesh.n_vertices * sizeof *s->number);
  return CONIC_OK;
}

void conic_simplifier_destroy(conic_simplifier *s) {
  if (!s)
    return;
  conic_memory_release(s->context, s->number);
  conic_memory_release(s->context, s->vertices);
  conic_memory_release(s->context, s->triangles);
  conic_memory_release(s->context, s->points);
  conic_memory_release(s->context, s->keys);
  conic_memory_release(s->context, s->slots);
  conic_memory_release(s->context, s);
}

void conic_patch_levels_release(conic_context *context, conic_patch_levels *levels) {
  for (int i = 0; i < levels->n; i++) {
    conic_memory_release(context, levels->levels[i].corners);
    conic_memory_release(context, levels->levels[i].face);
  }
  memset(levels, 0, sizeof *levels);
}

/* --- the patch --- */

static conic_status make_room(conic_simplifier *s, size_t n_faces) {
  if (n_faces <= s->triangles_room)
    return CONIC_OK;
  conic_memory_release(s->context, s->vertices);
  conic_memory_release(s->context, s->triangles);
  conic_memory_release(s->context, s->points);
  conic_memory_release(s->context, s->keys);
  conic_memory_release(s->context, s->slots);
  size_t room = n_faces + n_faces / 2 + 64, n_vertices = 3 * room;
  s->triangles_room = 0;
  s->vertices = conic_memory_allocate(s->context, n_vertices, sizeof *s->vertices);
  s->triangles = conic_memory_allocate(s->context, room, sizeof *s->triangles);
  s->points = conic_memory_allocate(s->context, n_vertices + 4 * room, sizeof *s->points);
  s->keys = conic_memory_allocate(s->context, n_vertices, sizeof *s->keys);
  s->slots = conic_memory_allocate(s->context, n_vertices, sizeof *s->slots);
  if (!s->vertices || !s->triangles || !s->points || !s->keys || !s->slots)
    return CONIC_ERROR_MEMORY;
  s->triangles_room = room;
  s->queue.slots = s->slots;
  s->queue.keys = s->keys;
  return CONIC_OK;
}

/* The patch's number of a mesh's vertex. */
static uint32_t add_vertex(conic_simplifier *s, uint32_t original, uint32_t material) {
  uint32_t place = s->mesh->adjacency->place[original];
  if (s->number[place] == none) {
    vertex *v = &s->vertices[s->n_vertices];
    memset(v, 0, sizeof *v);
    v->original = original;
    v->material = material;
    v->ring = v->target = none;
    for (int axis = 0; axis < 3; axis++)
      v->at[axis] = (double)s->mesh->mesh.position[axis][original];
    s->number[place] = (uint32_t)s->n_vertices++;
  }
  vertex *v = &s->vertices[s->number[place]];
  if (v->original != original || v->material != material) {
    v->kind = VERTEX_LOCKED;
    v->is_seam = 1;
  }
  return s->number[place];
}

static void add_point(conic_simplifier *s, uint32_t i_triangle, const double at[3]) {
  point *p = &s->points[s->n_points];
  memcpy(p->at, at, sizeof p->at);
  p->distance2 = 0.0;
  p->next = s->triangles[i_triangle].points;
  s->triangles[i_triangle].points = (uint32_t)s->n_points++;
}

static void add_triangle(conic_simplifier *s, uint32_t face) {
  uint32_t i = (uint32_t)s->n_triangles++;
  triangle *t = &s->triangles[i];
  double middle[3] = {0.0, 0.0, 0.0};
  t->face = face;
  t->points = none;
  t->is_alive = 1;
  conic_patch_face_normal(s->mesh, face, t->normal);
  for (int corner = 0; corner < 3; corner++) {
    size_t n_before = s->n_vertices;
    const uint32_t *materials = s->mesh->triangles->material;
    t->originals[corner] = s->mesh->mesh.faces[face][corner];
    uint32_t k = add_vertex(s, t->originals[corner], materials ? materials[face] : 0);
    vertex *v = &s->vertices[k];
    t->corners[corner] = k;
    t->next[corner] = v->ring;
    v->ring = 3 * i + (uint32_t)corner;
    for (int axis = 0; axis < 3; axis++)
      middle[axis] += v->at[axis] / 3.0;
    if (s->n_vertices > n_before)
      add_point(s, i, v->at);
  }
  add_point(s, i, middle);
  for (int corner = 0; corner < 3; corner++) {
    uint32_t across = s->mesh->adjacency->across[3 * (size_t)face + (size_t)corner];
    const double *a = s->vertices[t->corners[corner]].at, *b = s->vertices[t->corners[(corner + 1) % 3]].at;
    const double half[3] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
    if (conic_patch_ends_at(s->mesh, face, corner) || across / 3 > face) /* of two faces the one */
      add_point(s, i, half);
  }
}

/* Locks both ends of an edge that another patch has too; an open one holds by a plane that stands on it. */
static void treat_border(conic_simplifier *s, uint32_t i, int corner) {
  const triangle *t = &s->triangles[i];
  uint32_t across = s->mesh->adjacency->across[3 * (size_t)t->face + (size_t)corner];
  vertex *ends[2] = {&s->vertices[t->corners[corner]], &s->vertices[t->corners[(corner + 1) % 3]]};
  if (!conic_patch_ends_at(s->mesh, t->face, corner))
    return;
  double side[3], upright[3];
  for (int axis = 0; axis < 3; axis++)
    side[axis] = ends[1]->at[axis] - ends[0]->at[axis];
  conic_cross(side, t->normal, upright);
  double length = sqrt(conic_dot(upright, upright));
  for (int k = 0; k < 2; k++) {
    if (across != CONIC_OPEN_EDGE)
      ends[k]->kind = VERTEX_LOCKED;
    else if (ends[k]->kind == VERTEX_FREE)
      ends[k]->kind = VERTEX_BORDER;
  }
  if (across != CONIC_OPEN_EDGE || !(length > 0.0))
    return;
  for (int axis = 0; axis < 3; axis++)
    upright[axis] /= length;
  for (int k = 0; k < 2; k++)
    conic_quadric_add_plane(&ends[k]->quadric, upright, -conic_dot(upright, ends[0]->at),
                            border_weight * length * length);
}

static double area2_of(const conic_simplifier *s, const uint32_t corners[3], double cross[3]) {
  double sides[2][3];
  for (int k = 0; k < 2; k++)
    for (int axis = 0; axis < 3; axis++)
      sides[k][axis] = s->vertices[corners[k + 1]].at[axis] - s->vertices[corners[0]].at[axis];
  conic_cross(sides[0], sides[1], cross);
  return sqrt(conic_dot(cross, cross));
}

static void add_planes(conic_simplifier *s) {
  for (uint32_t i = 0; i < s->n_triangles; i++) {
    const triangle *t = &s->triangles[i];
    double cross[3], area2 = area2_of(s, t->corners, cross);
    double d = -conic_dot(t->normal, s->vertices[t->corners[0]].at);
    for (int corner = 0; corner < 3; corner++)
      conic_quadric_add_plane(&s->vertices[t->corners[corner]].quadric, t->normal, d, area2);
  }
}

/* --- neighbours --- */

/* Walks a vertex's living triangles: slots, none at the end. */
static uint32_t living(const conic_simplifier *s, uint32_t slot) {
  while (slot != none && !s->triangles[slot / 3].is_alive)
    slot = s->triangles[slot / 3].next[slot % 3];
  return slot;
}

static uint32_t after(const conic_simplifier *s, uint32_t slot) {
  return living(s, s->triangles[slot / 3].next[slot % 3]);
}

static int has_corner(const triangle *t, uint32_t v) {
  return t->corners[0] == v || t->corners[1] == v || t->corners[2] == v;
}

static int is_neighbour(const conic_simplifier *s, uint32_t a, uint32_t b) {
  for (uint32_t slot = living(s, s->vertices[a].ring); slot != none; slot = after(s, slot))
    if (has_corner(&s->triangles[slot / 3], b))
      return 1;
  return 0;
}

/* How many of u's triangles have v, and how many corners of u's triangles neighbour v: where the surface is to stay
 * one, each of the former has one of the latter, opposite, and there are no others; and some of u's triangles stay. */
static int keeps_surface(const conic_simplifier *s, uint32_t u, uint32_t v) {
  int n_between = 0, n_common = 0, n_open = 0, n = 0;
  for (uint32_t slot = living(s, s->vertices[u].ring); slot != none; slot = after(s, slot)) {
    const triangle *t = &s->triangles[slot / 3];
    n++;
    n_between += has_corner(t, v);
    /* Each neighbour once: as the corner after u; on a border, the last one comes as the corner before. */
    uint32_t next = t->corners[(slot % 3 + 1) % 3], last = t->corners[(slot % 3 + 2) % 3];
    n_common += next != v && is_neighbour(s, next, v);
    int is_last = 1;
    for (uint32_t other = living(s, s->vertices[u].ring); other != none; other = after(s, other))
      is_last = is_last && s->triangles[other / 3].corners[(other % 3 + 1) % 3] != last;
    n_common += is_last && last != v && is_neighbour(s, last, v);
    n_open += is_last;
  }
  int is_border = s->vertices[u].kind == VERTEX_BORDER;
  return n > n_between && n_between == (is_border ? 1 : 2) && n_common == n_between && n_open == is_border;
}

/* Whether no triangle that stays turns over or loses its area when u goes to v. */
static int keeps_facing(const conic_simplifier *s, uint32_t u, uint32_t v) {
  for (uint32_t slot = living(s, s->vertices[u].ring); slot != none; slot = after(s, slot)) {
    const triangle *t = &s->triangles[slot / 3];
    uint32_t corners[3] = {t->corners[0], t->corners[1], t->corners[2]};
    double cross[3];
    if (has_corner(t, v))
      continue;
    corners[slot % 3] = v;
    double area2 = area2_of(s, corners, cross), along = conic_dot(cross, t->normal);
    along *= (double)s->mesh->adjacency->side[t->face];
    if (!(area2 > 0.0) || !(along > least_turn * area2))
      return 0;
  }
  return 1;
}

static int is_open_edge(const conic_simplifier *s, uint32_t u, uint32_t v) {
  int n = 0;
  for (uint32_t slot = living(s, s->vertices[u].ring); slot != none; slot = after(s, slot))
    n += has_corner(&s->triangles[slot / 3], v);
  return n == 1;
}

static int may_go(const conic_simplifier *s, uint32_t u, uint32_t v) {
  if (s->vertices[v].is_seam || (s->vertices[u].kind == VERTEX_BORDER && !is_open_edge(s, u, v)))
    return 0;
  return keeps_surface(s, u, v) && keeps_facing(s, u, v);
}

/* The neighbour that u is best drawn onto, and what that costs. */
static void find_target(conic_simplifier *s, uint32_t u) {
  vertex *own = &s->vertices[u];
  s->keys[u] = HUGE_VAL;
  own->target = none;
  own->is_old = 0;
  for (uint32_t slot = living(s, own->ring); slot != none; slot = after(s, slot))
    for (uint32_t k = 1; k < 3; k++) {
      uint32_t v = s->triangles[slot / 3].corners[(slot % 3 + k) % 3];
      conic_quadric both = own->quadric;
      conic_quadric_add(&both, &s->vertices[v].quadric);
      double cost = conic_quadric_at(&both, s->vertices[v].at);
      if ((cost < s->keys[u] || (cost == s->keys[u] && v < own->target)) && may_go(s, u, v)) {
        s->keys[u] = cost;
        own->target = v;
      }
    }
}

/* --- drawing together --- */

/* Gives a point to the nearest of v's triangles. */
static void place_point(conic_simplifier *s, uint32_t i_point, uint32_t v) {
  point *p = &s->points[i_point];
  uint32_t best = none;
  p->distance2 = HUGE_VAL;
  for (uint32_t slot = living(s, s->vertices[v].ring); slot != none; slot = after(s, slot)) {
    const uint32_t *corners = s->triangles[slot / 3].corners;
    double distance2 = conic_distance2_to_triangle(p->at, s->vertices[corners[0]].at, s->vertices[corners[1]].at,
                                                   s->vertices[corners[2]].at);
    if (distance2 < p->distance2) {
      p->distance2 = distance2;
      best = slot / 3;
    }
  }
  p->next = s->triangles[best].points;
  s->triangles[best].points = i_point;
}

/* Takes the points off a triangle, in front of `list`. */
static uint32_t take_points(conic_simplifier *s, uint32_t i_triangle, uint32_t list) {
  triangle *t = &s->triangles[i_triangle];
  while (t->points != none) {
    uint32_t i = t->points;
    t->points = s->points[i].next;
    s->points[i].next = list;
    list = i;
  }
  return list;
}

static void draw_together(conic_simplifier *s, uint32_t u, uint32_t v) {
  uint32_t homeless = none;
  for (uint32_t slot = living(s, s->vertices[u].ring); slot != none;) {
    triangle *t = &s->triangles[slot / 3];
    uint32_t following = after(s, slot);
    homeless = take_points(s, slot / 3, homeless);
    if (has_corner(t, v)) {
      t->is_alive = 0;
      s->n_alive--;
    } else {
      t->corners[slot % 3] = v;
      t->originals[slot % 3] = s->vertices[v].original;
      t->next[slot % 3] = s->vertices[v].ring;
      s->vertices[v].ring = slot;
    }
    slot = following;
  }
  conic_quadric_add(&s->vertices[v].quadric, &s->vertices[u].quadric);
  while (homeless != none) {
    uint32_t next = s->points[homeless].next;
    place_point(s, homeless, v);
    homeless = next;
  }
  for (uint32_t slot = living(s, s->vertices[v].ring); slot != none; slot = after(s, slot))
    for (int corner = 0; corner < 3; corner++)
      s->vertices[s->triangles[slot / 3].corners[corner]].is_old = 1;
}

/* --- levels --- */

static conic_status take_level(conic_simplifier *s, conic_patch_levels *levels) {
  conic_patch_level *level = &levels->levels[levels->n++];
  double greatest2 = 0.0;
  level->n = 0;
  level->corners = conic_memory_allocate(s->context, s->n_alive, sizeof *level->corners);
  level->face = conic_memory_allocate(s->context, s->n_alive, sizeof *level->face);
  if (!level->corners || !level->face)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < s->n_triangles; i++) {
    const triangle *t = &s->triangles[i];
    if (!t->is_alive)
      continue;
    memcpy(level->corners[level->n], t->originals, sizeof t->originals);
    level->face[level->n++] = t->face;
  }
  for (size_t i = 0; i < s->n_points; i++)
    greatest2 = s->points[i].distance2 > greatest2 ? s->points[i].distance2 : greatest2;
  level->error = sqrt(greatest2);
  return CONIC_OK;
}

static conic_status simplify(conic_simplifier *s, conic_patch_levels *levels) {
  conic_status status = CONIC_OK;
  size_t wanted = s->n_triangles / 2, n_last = s->n_triangles;
  for (uint32_t u = 0; u < s->n_vertices; u++)
    if (s->vertices[u].kind != VERTEX_LOCKED) {
      find_target(s, u);
      if (s->keys[u] < HUGE_VAL)
        conic_heap_push(&s->queue, u);
    }
  while (s->queue.n > 0 && levels->n < CONIC_MOST_TRIANGLE_LEVELS && status == CONIC_OK) {
    uint32_t u = conic_heap_pop(&s->queue);
    if (s->vertices[u].is_old) {
      find_target(s, u);
      if (s->keys[u] < HUGE_VAL)
        conic_heap_push(&s->queue, u);
      continue;
    }
    draw_together(s, u, s->vertices[u].target);
    if (s->n_alive <= wanted) {
      status = take_level(s, levels);
      n_last = s->n_alive;
      wanted = s->n_alive / 2;
    }
  }
  int is_worth_it = 4 * s->n_alive <= 3 * n_last && s->n_alive > 0;
  if (status == CONIC_OK && is_worth_it && levels->n < CONIC_MOST_TRIANGLE_LEVELS)
    status = take_level(s, levels);
  return status;
}

conic_status conic_patch_simplify(conic_simplifier *s, uint32_t patch, conic_patch_levels *levels) {
  const conic_patch_mesh *mesh = s->mesh;
  size_t begin = mesh->starts[patch], n = mesh->starts[patch + 1] - begin;
  memset(levels, 0, sizeof *levels);
  conic_status status = make_room(s, n);
  if (status != CONIC_OK)
    return status;
  s->n_vertices = s->n_triangles = s->n_points = s->queue.n = 0;
  s->n_alive = n;
  for (size_t i = 0; i < n; i++)
    add_triangle(s, mesh->faces[begin + i]);
  for (uint32_t i = 0; i < s->n_triangles; i++)
    for (int corner = 0; corner < 3; corner++)
      treat_border(s, i, corner);
  add_planes(s);
  status = simplify(s, levels);
  for (size_t i = 0; i < s->n_vertices; i++)
    s->number[mesh->adjacency->place[s->vertices[i].original]] = none;
  if (status != CONIC_OK)
    conic_patch_levels_release(s->context, levels);
  return status;
}
