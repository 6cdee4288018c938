/* All clusters as one, for budgets: each level is no farther from the mesh than it states, nor the mesh from it, at
 * places that nobody measured; it has the mesh's volume, which the mesh's own vertices alone would lose; and its
 * normals are the mesh's. */
#include "core/base/vectors.h"
#include "lod/clusters/cluster_seen.h"
#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/mesh/mesh.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/random_numbers.h"

enum { AROUND = 72, DOWN = 40, PLACES = 300 };

/* Triangles with their corners' places and normals. */
typedef struct whole_surface {
  size_t n;
  double (*at)[3][3], (*normals)[3][3], *area_up_to;
} whole_surface;

static whole_surface surface_of(const conic_hybrid *h, const conic_hybrid_level *level, size_t room,
                                whole_surface old) {
  whole_surface s = old;
  if (!s.at) {
    s.at = malloc(room * sizeof *s.at);
    s.normals = malloc(room * sizeof *s.normals);
    s.area_up_to = malloc(room * sizeof *s.area_up_to);
  }
  if (!s.at || !s.normals || !s.area_up_to)
    exit(1);
  conic_hybrid_piece piece = conic_hybrid_piece_of(h, (uint32_t)(level - h->levels));
  for (size_t i = 0; i < level->count; i++, s.n++) {
    double sides[2][3], cross[3];
    for (int k = 0; k < 9; k++) {
      uint32_t v = conic_hybrid_corner(&piece, i, k / 3);
      s.at[s.n][k / 3][k % 3] = (double)piece.vertices.position[k % 3][v];
      s.normals[s.n][k / 3][k % 3] = (double)piece.vertices.normal[k % 3][v];
    }
    for (int k = 0; k < 2; k++)
      conic_subtract(s.at[s.n][k + 1], s.at[s.n][0], sides[k]);
    conic_cross(sides[0], sides[1], cross);
    s.area_up_to[s.n] = (s.n ? s.area_up_to[s.n - 1] : 0.0) + conic_length(cross);
  }
  return s;
}

static void release_surface(whole_surface *s) {
  free(s->at);
  free(s->normals);
  free(s->area_up_to);
}

/* The finest triangles of all clusters: the mesh. */
static whole_surface mesh_of(const conic_hybrid *h) {
  whole_surface s = {0};
  size_t room = 0;
  for (size_t i = 0; i < h->n_clusters; i++)
    room += h->levels[h->clusters[i].first_level].count;
  for (size_t i = 0; i < h->n_clusters; i++)
    s = surface_of(h, &h->levels[h->clusters[i].first_level], room, s);
  return s;
}

/* A place by chance, as likely anywhere on the surface, and the normal there. */
static void draw_place(const whole_surface *s, uint64_t *state, double at[3], double normal[3]) {
  double area = random_unit(state) * s->area_up_to[s->n - 1], u = random_unit(state), v = random_unit(state);
  size_t low = 0, high = s->n - 1;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (s->area_up_to[middle] <= area)
      low = middle + 1;
    else
      high = middle;
  }
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  for (int axis = 0; axis < 3; axis++) {
    const double(*p)[3] = s->at[low], (*n)[3] = s->normals[low];
    at[axis] = (1.0 - u - v) * p[0][axis] + u * p[1][axis] + v * p[2][axis];
    normal[axis] = (1.0 - u - v) * n[0][axis] + u * n[1][axis] + v * n[2][axis];
  }
  conic_normalize(normal);
}

static double distance_to_surface(const whole_surface *s, const double at[3]) {
  double least2 = HUGE_VAL;
  for (size_t i = 0; i < s->n; i++) {
    double distance2 = conic_distance2_to_triangle(at, s->at[i][0], s->at[i][1], s->at[i][2]);
    least2 = distance2 < least2 ? distance2 : least2;
  }
  return sqrt(least2);
}

/* The greatest of how far some places of one surface are from the other, and the root mean square. */
static double farthest_from(const whole_surface *from, const whole_surface *to, uint64_t *state, double *mean) {
  double most = 0.0, sum = 0.0;
  for (int i = 0; i < PLACES; i++) {
    double at[3], normal[3];
    draw_place(from, state, at, normal);
    double distance = distance_to_surface(to, at);
    most = distance > most ? distance : most;
    sum += distance * distance;
  }
  *mean = sqrt(sum / PLACES);
  return most;
}

static double volume_of(const whole_surface *s) {
  double sum = 0.0;
  for (size_t i = 0; i < s->n; i++) {
    double cross[3];
    conic_cross(s->at[i][1], s->at[i][2], cross);
    sum += conic_dot(s->at[i][0], cross) / 6.0;
  }
  return sum;
}

/* The root mean square of the angle between the normals of one surface, in degrees, and those where the other is
 * nearest. */
static double turned_by(const whole_surface *from, const whole_surface *to, uint64_t *state) {
  double sum = 0.0;
  for (int i = 0; i < PLACES; i++) {
    double at[3], normal[3], there[3] = {0.0, 0.0, 0.0}, least2 = HUGE_VAL;
    draw_place(from, state, at, normal);
    for (size_t k = 0; k < to->n; k++) {
      const double *corners[3] = {to->at[k][0], to->at[k][1], to->at[k][2]};
      double bary[3], distance2 = conic_seen_nearest(at, corners, bary);
      if (!(distance2 < least2))
        continue;
      least2 = distance2;
      for (int axis = 0; axis < 3; axis++)
        there[axis] =
            bary[0] * to->normals[k][0][axis] + bary[1] * to->normals[k][1][axis] + bary[2] * to->normals[k][2][axis];
    }
    conic_normalize(there);
    double along = conic_dot(normal, there), angle = acos(along < 1.0 ? along : 1.0) * 57.29577951308232;
    sum += angle * angle;
  }
  return sqrt(sum / PLACES);
}

/* --- the mesh --- */

static uint32_t vertex_at(int row, int column) {
  return row == 0 ? 0 : row == DOWN ? 1 : (uint32_t)(2 + (row - 1) * AROUND + column % AROUND);
}

static void put_vertex(conic_triangles *mesh, int row, int column) {
  double polar = 3.14159265358979 * row / DOWN, around = 2.0 * 3.14159265358979 * column / AROUND;
  double radius = 1.0 + 0.12 * sin(3.0 * around) * sin(polar) * sin(polar) + 0.1 * cos(5.0 * polar);
  const double way[3] = {sin(polar) * cos(around), cos(polar), sin(polar) * sin(around)};
  for (int axis = 0; axis < 3; axis++)
    mesh->position[axis][vertex_at(row, column)] = (float)(radius * way[axis]);
}

static void add_face(conic_triangles *mesh, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t corners[3] = {a, b, c};
  double at[3][3], sides[2][3], cross[3];
  memcpy(mesh->corners[mesh->count++], corners, sizeof corners);
  for (int k = 0; k < 9; k++)
    at[k / 3][k % 3] = (double)mesh->position[k % 3][corners[k / 3]];
  for (int k = 0; k < 2; k++)
    conic_subtract(at[k + 1], at[0], sides[k]);
  conic_cross(sides[0], sides[1], cross);
  for (int k = 0; k < 9; k++)
    mesh->normal[k % 3][corners[k / 3]] += (float)cross[k % 3];
}

/* A ball with smooth bumps. */
static void make_ball(conic_context *context, unsigned colors, conic_triangles *mesh) {
  CHECK_OK(conic_triangles_allocate(context, 2 * AROUND * (DOWN - 1), 2 + AROUND * (DOWN - 1),
                                    CONIC_TRIANGLES_NORMALS | colors, mesh));
  for (int row = 0; row <= DOWN; row++)
    for (int column = 0; column < AROUND; column++)
      put_vertex(mesh, row, column);
  for (int axis = 0; axis < 3; axis++)
    memset(mesh->normal[axis], 0, mesh->n_vertices * sizeof(float));
  mesh->count = 0;
  for (int row = 0; row < DOWN; row++)
    for (int column = 0; column < AROUND; column++) {
      if (row > 0)
        add_face(mesh, vertex_at(row, column), vertex_at(row, column + 1), vertex_at(row + 1, column));
      if (row < DOWN - 1)
        add_face(mesh, vertex_at(row, column + 1), vertex_at(row + 1, column + 1), vertex_at(row + 1, column));
    }
  for (size_t i = 0; i < mesh->n_vertices; i++) {
    double normal[3] = {(double)mesh->normal[0][i], (double)mesh->normal[1][i], (double)mesh->normal[2][i]};
    conic_normalize(normal);
    for (int axis = 0; axis < 3; axis++)
      mesh->normal[axis][i] = (float)normal[axis];
    for (int axis = 0; axis < 3 && colors; axis++)
      mesh->color[axis][i] = 0.5f + 0.1f * mesh->position[axis][i];
  }
}

/* --- what holds --- */

static void build_whole(conic_context *context, conic_triangles *mesh, conic_hybrid **hybrid) {
  conic_hybrid_options options;
  conic_hybrid_options_init(&options);
  CHECK_OK(conic_hybrid_build(context, mesh, &options, hybrid, NULL));
}

static void check_level(const conic_hybrid *h, const conic_hybrid_level *level, const whole_surface *mesh,
                        int is_colored, uint64_t *state) {
  whole_surface none = {0}, s = surface_of(h, level, level->count, none);
  double error = (double)level->error, mean, mean_back;
  double there = farthest_from(mesh, &s, state, &mean), back = farthest_from(&s, mesh, state, &mean_back);
  double volume = volume_of(&s) / volume_of(mesh), turned = turned_by(mesh, &s, state), n = (double)level->count;
  fprintf(stderr,
          "%u triangles: error %.5f, places %.2f of it, back %.2f, mean %.5f, volume %.4f, normals %.2f degrees\n",
          level->count, error, there / error, back / error, mean, volume, turned);
  CHECK(there <= error);
  CHECK(back <= error);
  CHECK(n < 20.0 || turned < 14.5); /* few large ones look like the mesh only with creases between them */
  if (n >= 200.0) {                 /* as near as so many can be: without what is fitted they are farther */
    CHECK(!is_colored || fabs(1.0 - volume) < 0.003);
    CHECK(turned < 2000.0 / n);
    CHECK(mean < 2.4 / n);
  }
  release_surface(&s);
}

static void test_ball(conic_context *context, unsigned colors) {
  conic_triangles mesh;
  conic_hybrid *h;
  uint64_t state = 5;
  make_ball(context, colors, &mesh);
  build_whole(context, &mesh, &h);
  whole_surface all = mesh_of(h);
  size_t last = SIZE_MAX;
  for (uint32_t k = 0; k < h->nodes[0].n_levels; k++) {
    const conic_hybrid_level *level = &h->levels[h->nodes[0].first_level + k];
    if (level->kind != CONIC_HYBRID_TRIANGLES || (last < SIZE_MAX && level->count > last / 2))
      continue;
    last = level->count;
    check_level(h, level, &all, colors != 0, &state);
  }
  CHECK(last < 20);
  release_surface(&all);
  conic_hybrid_destroy(h);
}

/* --- creases --- */

enum { CAN_AROUND = 48, RINGS = 8, ROWS = 12, CAN_LINES = 2 * (RINGS + 1) + ROWS + 1 };

/* Line by line: from the middle of the lid to its rim, down the side, and from the floor's rim to its middle. Rims are
 * there twice, with the normals of each surface. */
static void put_line(conic_triangles *mesh, int line) {
  int is_lid = line <= RINGS, is_floor = line > RINGS + 1 + ROWS;
  double radius = is_lid ? (double)line / RINGS : is_floor ? (double)(CAN_LINES - 1 - line) / RINGS : 1.0;
  double height = is_lid ? 1.0 : is_floor ? -1.0 : 1.0 - 2.0 * (line - RINGS - 1) / ROWS;
  for (int column = 0; column < CAN_AROUND; column++) {
    double around = 2.0 * 3.14159265358979 * column / CAN_AROUND;
    size_t i = (size_t)line * CAN_AROUND + (size_t)column;
    const double way[3] = {cos(around), 0.0, sin(around)};
    for (int axis = 0; axis < 3; axis++) {
      mesh->position[axis][i] = (float)(axis == 1 ? height : radius * way[axis]);
      mesh->normal[axis][i] = (float)(is_lid || is_floor ? (axis == 1 ? height : 0.0) : way[axis]);
    }
  }
}

static void make_can(conic_context *context, conic_triangles *mesh) {
  CHECK_OK(conic_triangles_allocate(context, (CAN_LINES - 1) * CAN_AROUND * 2, CAN_LINES * CAN_AROUND,
                                    CONIC_TRIANGLES_NORMALS, mesh));
  mesh->count = 0;
  for (int line = 0; line < CAN_LINES; line++) {
    put_line(mesh, line);
    for (uint32_t column = 0; column < CAN_AROUND && line < CAN_LINES - 1 && line != RINGS && line != RINGS + 1 + ROWS;
         column++) {
      uint32_t at = (uint32_t)line * CAN_AROUND, a = at + column, b = at + (column + 1) % CAN_AROUND;
      const uint32_t both[2][3] = {{a, b, a + CAN_AROUND}, {b, b + CAN_AROUND, a + CAN_AROUND}};
      memcpy(mesh->corners[mesh->count], both, sizeof both);
      mesh->count += 2;
    }
  }
}

/* Lid and side keep their normals, though the rim is drawn together. */
static void test_can(conic_context *context) {
  conic_triangles mesh;
  conic_hybrid *h;
  size_t n_levels = 0;
  make_can(context, &mesh);
  build_whole(context, &mesh, &h);
  for (uint32_t k = 0; k < h->nodes[0].n_levels; k++) {
    const conic_hybrid_level *level = &h->levels[h->nodes[0].first_level + k];
    if (level->kind != CONIC_HYBRID_TRIANGLES || level->count < 60)
      continue;
    whole_surface none = {0}, s = surface_of(h, level, level->count, none);
    size_t n_oblique = 0;
    for (size_t i = 0; i < 3 * s.n; i++) {
      double up = fabs(s.normals[i / 3][i % 3][1]);
      n_oblique += up > 0.05 && up < 0.999;
    }
    fprintf(stderr, "can: %u triangles, error %.5f, %zu oblique\n", level->count, (double)level->error, n_oblique);
    CHECK(n_oblique == 0);
    n_levels++;
    release_surface(&s);
  }
  CHECK(n_levels > 10);
  conic_hybrid_destroy(h);
}

int main(void) {
  conic_context *context = check_context(2);
  test_ball(context, 0);
  test_ball(context, CONIC_TRIANGLES_COLORS);
  test_can(context);
  conic_context_destroy(context);
  return check_result();
}
