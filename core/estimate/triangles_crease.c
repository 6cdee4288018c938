/* Normals of corners: round over edges flatter than an angle, sharp over others. */

#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/estimate/neighbourhood.h"
#include "core/estimate/places.h"
#include "core/splats/columns.h"

/* Where more corners meet, all get their faces' normals: each would have to look at all others. */
enum { MOST_CORNERS = 256 };

/* A mesh with this many times more edges over half the angle than over the angle is rounded, or noisy: single edges of
 * its rounds are that steep by chance, and creases would fray there. So edges that hang together are a crease only if
 * they are at least so many for each end amid the surface, where those over 60° count four times. */
enum { ROUND_EDGES = 2, EDGES_AN_END = 12, STEEP = 4 };
static const double steep_cosine = 0.5;

/* What creases hold, with each edge at both of its ends: `score` is the edges by how much they count. */
typedef struct crease_size {
  uint32_t n_sharp, n_weak, score, n_ends;
} crease_size;

/* Corners are numbered by triangle, three each. Those at one place belong together, whichever vertices they name. */
typedef struct creasing {
  const conic_triangles *triangles;
  double cosine, half_cosine;
  int is_rounded;
  uint32_t *place; /* of each vertex */
  size_t n_places;
  size_t *starts;    /* of each place, in `corners` */
  size_t *corners;   /* by place */
  size_t *normal_at; /* of each place: how many normals it has, then its first one */
  float *normal[3];
  uint32_t (*normal_corners)[3];
  uint8_t *sharp;    /* of each corner: bits of its edges, as in corner_fan.others, that are over the angle */
  uint32_t *crease;  /* of each place: another place of the same crease, or itself */
  crease_size *size; /* of each place, then of each crease at its first place */
} creasing;

/* --- places --- */

/* A counting sort, as of vertices' triangles. */
static void sort_corners(creasing *c) {
  const conic_triangles *t = c->triangles;
  for (size_t i = 0; i < 3 * t->count; i++)
    c->starts[c->place[t->corners[i / 3][i % 3]] + 2]++;
  for (size_t place = 0; place < c->n_places; place++)
    c->starts[place + 2] += c->starts[place + 1];
  for (size_t i = 0; i < 3 * t->count; i++)
    c->corners[c->starts[c->place[t->corners[i / 3][i % 3]] + 1]++] = i;
}

/* --- normals --- */

/* A face's normal: twice its area long; zero where it is not finite. */
static void normal_of_face(const conic_triangles *t, size_t i, double normal[3]) {
  conic_triangles_face_normal(t, i, normal);
  if (!(conic_dot(normal, normal) * 0.0 == 0.0))
    memset(normal, 0, 3 * sizeof *normal);
}

/* The corners at a place, and the groups that hang together by smooth edges. */
typedef struct corner_fan {
  size_t n;
  const size_t *corners;
  double normals[MOST_CORNERS][3], units[MOST_CORNERS][3];
  uint32_t others[MOST_CORNERS][2]; /* the places of the triangle's other corners */
  uint16_t group[MOST_CORNERS];     /* numbered from 0 */
  int n_groups;
} corner_fan;

static void gather_corner(const creasing *c, size_t corner, corner_fan *fan, size_t i) {
  const conic_triangles *t = c->triangles;
  normal_of_face(t, corner / 3, fan->normals[i]);
  memcpy(fan->units[i], fan->normals[i], sizeof fan->units[i]);
  conic_normalize(fan->units[i]);
  for (size_t k = 0; k < 2; k++)
    fan->others[i][k] = c->place[t->corners[corner / 3][(corner + 1 + k) % 3]];
  fan->group[i] = (uint16_t)i;
}

/* Which of corner i's other places is one of corner j's, too; -1: none. */
static int shared_edge(const corner_fan *fan, size_t i, size_t j) {
  const uint32_t *a = fan->others[i], *b = fan->others[j];
  return a[0] == b[0] || a[0] == b[1] ? 0 : a[1] == b[0] || a[1] == b[1] ? 1 : -1;
}

/* The cosine of the bend between two faces; one without an area is flat beside any. */
static double bend_cosine(const corner_fan *fan, size_t i, size_t j) {
  int has_area = conic_dot(fan->units[i], fan->units[i]) > 0.0 && conic_dot(fan->units[j], fan->units[j]) > 0.0;
  return has_area ? conic_dot(fan->units[i], fan->units[j]) : 1.0;
}

static void join_groups(corner_fan *fan, uint16_t a, uint16_t b) {
  for (size_t i = 0; i < fan->n; i++)
    if (fan->group[i] == (a > b ? a : b))
      fan->group[i] = a < b ? a : b;
}

/* Groups are called by their first corners until they are numbered. */
static void number_groups(corner_fan *fan) {
  uint16_t number[MOST_CORNERS];
  fan->n_groups = 0;
  for (size_t i = 0; i < fan->n; i++) {
    if (fan->group[i] == i)
      number[i] = (uint16_t)fan->n_groups++;
    fan->group[i] = number[fan->group[i]];
  }
}

/* Returns 0 where there are too many corners, each of which is then a group. */
static int gather_corners(const creasing *c, size_t place, corner_fan *fan) {
  fan->n = c->starts[place + 1] - c->starts[place];
  fan->corners = c->corners + c->starts[place];
  for (size_t i = 0; i < fan->n && fan->n <= MOST_CORNERS; i++)
    gather_corner(c, fan->corners[i], fan, i);
  return fan->n <= MOST_CORNERS;
}

static uint32_t first_of_crease(const creasing *c, uint32_t place) {
  while (c->crease[place] != place)
    place = c->crease[place];
  return place;
}

static int gather_fan(const creasing *c, size_t place, corner_fan *fan) {
  if (!gather_corners(c, place, fan))
    return 0;
  const crease_size *size = &c->size[first_of_crease(c, (uint32_t)place)];
  int is_crease = !c->is_rounded || size->score >= 2 * EDGES_AN_END * size->n_ends;
  for (size_t i = 0; i < fan->n; i++)
    for (size_t j = 0; j < i; j++)
      if (fan->group[i] != fan->group[j] && shared_edge(fan, i, j) >= 0 &&
          (!is_crease || bend_cosine(fan, i, j) >= c->cosine))
        join_groups(fan, fan->group[i], fan->group[j]);
  number_groups(fan);
  return 1;
}

/* --- creases --- */

/* Finds the edges over the angle at the places, one of which makes an end, unless that is at a border; and how many
 * normals the other places have. */
static void find_sharp(void *data, size_t begin, size_t end) {
  const creasing *c = data;
  corner_fan fan;
  for (size_t place = begin; place < end; place++) {
    size_t n_met = 0, n = gather_corners(c, place, &fan) ? fan.n : 0;
    crease_size size = {0};
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; j < i; j++) {
        int edge = shared_edge(&fan, i, j);
        double cosine = edge < 0 ? 1.0 : bend_cosine(&fan, i, j);
        n_met += edge >= 0;
        if (edge >= 0 && fan.group[i] != fan.group[j])
          join_groups(&fan, fan.group[i], fan.group[j]);
        size.n_weak += cosine < c->half_cosine && cosine >= c->cosine;
        if (edge < 0 || cosine >= c->cosine)
          continue;
        c->sharp[fan.corners[i]] |= (uint8_t)(1 << edge);
        size.n_sharp++;
        size.score += cosine < steep_cosine ? STEEP : 1;
      }
    size.n_ends = size.n_sharp == 1 && n_met >= n; /* around a place amid the surface as many edges as faces meet */
    c->size[place] = size;
    if (n)
      number_groups(&fan);
    c->normal_at[place] = n ? (size_t)fan.n_groups : fan.n; /* unless there are sharp edges */
  }
}

/* Joins the places along those edges, each to the least of them. */
static void join_creases(creasing *c) {
  const conic_triangles *t = c->triangles;
  for (size_t place = 0; place < c->n_places; place++)
    c->crease[place] = (uint32_t)place;
  for (size_t i = 0; i < 3 * t->count; i++)
    for (size_t k = 0; k < 2; k++)
      if (c->sharp[i] >> k & 1) {
        uint32_t a = first_of_crease(c, c->place[t->corners[i / 3][i % 3]]);
        uint32_t b = first_of_crease(c, c->place[t->corners[i / 3][(i + 1 + k) % 3]]);
        c->crease[a > b ? a : b] = a < b ? a : b;
      }
  size_t n_sharp = 0, n_weak = 0;
  for (size_t place = 0; place < c->n_places; place++) { /* the least is the first to get there */
    uint32_t first = c->crease[place] = first_of_crease(c, (uint32_t)place);
    n_sharp += c->size[place].n_sharp;
    n_weak += c->size[place].n_weak;
    if (first != place) {
      c->size[first].score += c->size[place].score;
      c->size[first].n_ends += c->size[place].n_ends;
    }
  }
  c->is_rounded = n_weak > ROUND_EDGES * n_sharp;
}

static void count_normals(void *data, size_t begin, size_t end) {
  const creasing *c = data;
  corner_fan fan;
  for (size_t place = begin; place < end; place++)
    if (c->size[place].n_sharp)
      c->normal_at[place] = gather_fan(c, place, &fan) ? (size_t)fan.n_groups : fan.n;
}

static void store_normal(const creasing *c, size_t at, double sum[3]) {
  conic_normalize(sum);
  for (int axis = 0; axis < 3; axis++)
    c->normal[axis][at] = (float)sum[axis];
}

/* Lays down the mean of each group, by area. */
static void lay_fan(const creasing *c, size_t place, const corner_fan *fan) {
  double sums[MOST_CORNERS][3];
  memset(sums, 0, (size_t)fan->n_groups * sizeof *sums);
  for (size_t i = 0; i < fan->n; i++) {
    size_t corner = fan->corners[i];
    c->normal_corners[corner / 3][corner % 3] = (uint32_t)(c->normal_at[place] + fan->group[i]);
    for (int axis = 0; axis < 3; axis++)
      sums[fan->group[i]][axis] += fan->normals[i][axis];
  }
  for (int i = 0; i < fan->n_groups; i++)
    store_normal(c, c->normal_at[place] + (size_t)i, sums[i]);
}

static void lay_normals(void *data, size_t begin, size_t end) {
  const creasing *c = data;
  corner_fan fan;
  for (size_t place = begin; place < end; place++) {
    if (gather_fan(c, place, &fan)) {
      lay_fan(c, place, &fan);
      continue;
    }
    for (size_t i = 0; i < fan.n; i++) {
      double normal[3];
      normal_of_face(c->triangles, fan.corners[i] / 3, normal);
      store_normal(c, c->normal_at[place] + i, normal);
      c->normal_corners[fan.corners[i] / 3][fan.corners[i] % 3] = (uint32_t)(c->normal_at[place] + i);
    }
  }
}

/* --- all of it --- */

static conic_status make_room(conic_context *context, creasing *c) {
  const conic_triangles *t = c->triangles;
  size_t n = t->n_vertices;
  c->n_places = n;
  return conic_memory_allocate_these(context, CONIC_ROOM(c->place, n), CONIC_ZEROED(c->starts, n + 2),
                                     CONIC_ROOM(c->corners, 3 * t->count), CONIC_ROOM(c->normal_at, n),
                                     CONIC_ROOM(c->normal_corners, t->count), CONIC_ZEROED(c->sharp, 3 * t->count),
                                     CONIC_ROOM(c->crease, n), CONIC_ROOM(c->size, n));
}

static conic_status crease_normals(conic_context *context, creasing *c, size_t *n_normals) {
  const conic_triangles *t = c->triangles;
  conic_status status = conic_places_find(context, (const float *const *)t->position, t->n_vertices, c->place);
  if (status != CONIC_OK)
    return status;
  sort_corners(c);
  status = conic_slots_for(context, c->n_places, find_sharp, c, 0.0, 0.3);
  if (status == CONIC_OK)
    join_creases(c);
  if (status == CONIC_OK)
    status = conic_slots_for(context, c->n_places, count_normals, c, 0.3, 0.6);
  *n_normals = 0;
  for (size_t place = 0; place < c->n_places && status == CONIC_OK; place++) {
    size_t n = c->normal_at[place];
    c->normal_at[place] = *n_normals;
    *n_normals += n;
  }
  if (*n_normals > UINT32_MAX)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "crease: there are too many triangles");
  for (int axis = 0; axis < 3 && status == CONIC_OK; axis++) {
    c->normal[axis] = conic_memory_allocate(context, *n_normals, sizeof(float));
    status = c->normal[axis] ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  return status == CONIC_OK ? conic_slots_for(context, c->n_places, lay_normals, c, 0.6, 1.0) : status;
}

conic_status conic_triangles_crease(conic_context *context, conic_triangles *triangles, double angle_deg) {
  creasing c = {.triangles = triangles,
                .cosine = conic_cos(conic_radians(angle_deg)),
                .half_cosine = conic_cos(conic_radians(0.5 * angle_deg))};
  size_t n_normals = 0;
  conic_status status = conic_triangles_check(context, triangles, "crease");
  if (status == CONIC_OK)
    status = conic_triangles_check_own(context, "crease", triangles);
  if (status == CONIC_OK && !(angle_deg >= 0.0 && angle_deg <= 90.0))
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "crease: an angle of 0 to 90 degrees");
  if (status != CONIC_OK)
    return status;
  status = make_room(context, &c);
  if (status == CONIC_OK)
    status = crease_normals(context, &c, &n_normals);
  if (status == CONIC_OK) { /* what was there is released in their place */
    uint32_t(*corners)[3] = triangles->normal_corners;
    triangles->normal_corners = c.normal_corners;
    c.normal_corners = corners;
    triangles->n_normals = n_normals;
  }
  conic_memory_release_these(context, c.place, c.starts, c.corners, c.normal_at, c.normal_corners, c.sharp, c.crease,
                             c.size);
  for (int axis = 0; axis < 3; axis++) {
    conic_memory_release(context, status == CONIC_OK ? triangles->normal[axis] : c.normal[axis]);
    if (status == CONIC_OK)
      triangles->normal[axis] = c.normal[axis];
  }
  return status;
}
