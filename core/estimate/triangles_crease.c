/* Normals of corners: round over edges flatter than an angle, sharp over others. */

#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/estimate/neighbourhood.h"
#include "core/estimate/places.h"
#include "core/splats/columns.h"

/* Where more corners meet, all get their faces' normals: each would have to look at all others. */
enum { MOST_CORNERS = 256 };

/* Corners are numbered by triangle, three each. Those at one place belong together, whichever vertices they name. */
typedef struct creasing {
  const conic_triangles *triangles;
  double cosine;
  uint32_t *place; /* of each vertex */
  size_t n_places;
  size_t *starts;    /* of each place, in `corners` */
  size_t *corners;   /* by place */
  size_t *normal_at; /* of each place: how many normals it has, then its first one */
  float *normal[3];
  uint32_t (*normal_corners)[3];
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

/* Faces without an area are smooth with any face. */
static int is_smooth(const creasing *c, const corner_fan *fan, size_t i, size_t j) {
  const uint32_t *a = fan->others[i], *b = fan->others[j];
  if (a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1])
    return 0;
  int has_area = conic_dot(fan->units[i], fan->units[i]) > 0.0 && conic_dot(fan->units[j], fan->units[j]) > 0.0;
  return !has_area || conic_dot(fan->units[i], fan->units[j]) >= c->cosine;
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
static int gather_fan(const creasing *c, size_t place, corner_fan *fan) {
  fan->n = c->starts[place + 1] - c->starts[place];
  fan->corners = c->corners + c->starts[place];
  if (fan->n > MOST_CORNERS)
    return 0;
  for (size_t i = 0; i < fan->n; i++)
    gather_corner(c, fan->corners[i], fan, i);
  for (size_t i = 0; i < fan->n; i++)
    for (size_t j = 0; j < i; j++)
      if (fan->group[i] != fan->group[j] && is_smooth(c, fan, i, j))
        join_groups(fan, fan->group[i], fan->group[j]);
  number_groups(fan);
  return 1;
}

static void count_normals(void *data, size_t begin, size_t end) {
  const creasing *c = data;
  corner_fan fan;
  for (size_t place = begin; place < end; place++)
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
                                     CONIC_ROOM(c->normal_corners, t->count));
}

static conic_status crease_normals(conic_context *context, creasing *c, size_t *n_normals) {
  const conic_triangles *t = c->triangles;
  conic_status status = conic_places_find(context, (const float *const *)t->position, t->n_vertices, c->place);
  if (status != CONIC_OK)
    return status;
  sort_corners(c);
  status = conic_slots_for(context, c->n_places, count_normals, c, 0.0, 0.5);
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
  return status == CONIC_OK ? conic_slots_for(context, c->n_places, lay_normals, c, 0.5, 1.0) : status;
}

conic_status conic_triangles_crease(conic_context *context, conic_triangles *triangles, double angle_deg) {
  creasing c = {.triangles = triangles, .cosine = conic_cos(conic_radians(angle_deg))};
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
  conic_memory_release_these(context, c.place, c.starts, c.corners, c.normal_at, c.normal_corners);
  for (int axis = 0; axis < 3; axis++) {
    conic_memory_release(context, status == CONIC_OK ? triangles->normal[axis] : c.normal[axis]);
    if (status == CONIC_OK)
      triangles->normal[axis] = c.normal[axis];
  }
  return status;
}
