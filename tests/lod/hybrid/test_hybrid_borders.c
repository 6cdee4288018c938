/* Clusters at any levels side by side fit to the bit: each edge of the triangles that are drawn has its like on the
 * other side, or is the mesh's own border; and no place of the mesh is farther from them than their errors allow, nor
 * they from it. */
#include "lod/hybrid/draw/hybrid_selecting.h"
#include "lod/mesh/mesh.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/sanitized.h"

/* An edge by the places of its ends, the lower first. */
typedef struct edge {
  uint32_t a, b;
} edge;

typedef struct borders_scene {
  conic_context *context;
  const char *name;
  conic_hybrid *hybrid;
  conic_triangles mesh;
  size_t n_vertices; /* of the faces of all clusters, one cluster's after the other's: */
  float (*at)[3];
  size_t *first;            /* of each cluster */
  uint32_t *place;          /* of each of these: the first that lies there */
  unsigned char *is_border; /* of each place: it is on an edge of the mesh that has not two faces */
  uint32_t *levels;         /* of each cluster: the one that is drawn, from its first */
  uint32_t *stages;
  conic_triangles drawn;
  uint32_t *drawn_place;
  size_t n_put, n_edges, n_single;
  double farthest, farthest_back; /* over the error that is allowed */
} borders_scene;

static int compare_edges(const void *x, const void *y) {
  const edge *a = x, *b = y;
  if (a->a != b->a)
    return a->a < b->a ? -1 : 1;
  return (a->b > b->b) - (a->b < b->b);
}

static int compare_places(const void *x, const void *y) {
  return memcmp(x, y, 3 * sizeof(float));
}

typedef struct spot {
  float at[3];
  uint32_t vertex;
} spot;

static void list_all_vertices(borders_scene *s) {
  const conic_hybrid *h = s->hybrid;
  s->first = malloc((h->n_clusters + 1) * sizeof *s->first);
  if (!s->first)
    exit(1);
  for (size_t i = 0; i < h->n_clusters; i++) {
    s->first[i] = s->n_vertices;
    s->n_vertices += h->levels[h->clusters[i].first_level].n_vertices;
  }
  s->at = malloc((s->n_vertices + 1) * sizeof *s->at);
  if (!s->at)
    exit(1);
  for (size_t i = 0; i < h->n_clusters; i++) {
    conic_hybrid_piece piece = conic_hybrid_piece_of(h, h->clusters[i].first_level);
    for (size_t k = 0; k < h->levels[h->clusters[i].first_level].n_vertices; k++)
      for (int axis = 0; axis < 3; axis++)
        s->at[s->first[i] + k][axis] = piece.vertices.position[axis][k];
  }
}

static void find_places(borders_scene *s) {
  size_t n = s->n_vertices;
  spot *spots = malloc(n * sizeof *spots);
  s->place = malloc(n * sizeof *s->place);
  if (!spots || !s->place)
    exit(1);
  for (uint32_t i = 0; i < n; i++) {
    for (int axis = 0; axis < 3; axis++)
      spots[i].at[axis] = s->at[i][axis] + 0.0f; /* no negative zero */
    spots[i].vertex = i;
  }
  qsort(spots, n, sizeof *spots, compare_places);
  for (size_t i = 0; i < n; i++)
    s->place[spots[i].vertex] =
        i > 0 && compare_places(&spots[i], &spots[i - 1]) == 0 ? s->place[spots[i - 1].vertex] : spots[i].vertex;
  free(spots);
}

/* All edges of n triangles, sorted. */
static edge *list_edges(const uint32_t (*corners)[3], const uint32_t *place, size_t n) {
  edge *edges = malloc((3 * n + 1) * sizeof *edges);
  if (!edges)
    exit(1);
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t a = place[corners[i][k]], b = place[corners[i][(k + 1) % 3]];
      CHECK(a != b);
      edges[3 * i + (size_t)k] = (edge){a < b ? a : b, a < b ? b : a};
    }
  qsort(edges, 3 * n, sizeof *edges, compare_edges);
  return edges;
}

static size_t count_alike(const edge *edges, size_t i, size_t n) {
  size_t end = i + 1;
  while (end < n && compare_edges(&edges[i], &edges[end]) == 0)
    end++;
  return end - i;
}

/* --- what is drawn --- */

/* A level for each cluster; one in four is surfels, which cover its faces as the mesh has them. */
static void choose(borders_scene *s, uint64_t *state) {
  for (size_t i = 0; i < s->hybrid->n_clusters; i++) {
    const conic_hybrid_cluster *cluster = &s->hybrid->clusters[i];
    uint32_t n = 0;
    while (n < cluster->n_levels && s->hybrid->levels[cluster->first_level + n].kind == CONIC_HYBRID_TRIANGLES)
      n++;
    s->levels[i] = random_unit(state) < 0.25 ? 0 : (uint32_t)(random_unit(state) * (double)n);
    s->stages[i] = s->hybrid->levels[cluster->first_level + s->levels[i]].stage;
  }
}

static const conic_hybrid_level *level_of(const borders_scene *s, size_t cluster) {
  return &s->hybrid->levels[s->hybrid->clusters[cluster].first_level + s->levels[cluster]];
}

static void put_cluster(borders_scene *s, size_t cluster) {
  const conic_hybrid *h = s->hybrid;
  const conic_hybrid_level *level = level_of(s, cluster);
  conic_triangles *to = &s->drawn;
  size_t n_put = conic_hybrid_count_stitches(h, (uint32_t)cluster, level, s->stages);
  conic_hybrid_piece piece = conic_hybrid_piece_of(h, (uint32_t)(level - h->levels));
  conic_hybrid_stitching stitching = {.hybrid = h,
                                      .cluster = (uint32_t)cluster,
                                      .level = level,
                                      .stages = s->stages,
                                      .to = to,
                                      .first_triangle = to->count,
                                      .triangle = to->count + level->count,
                                      .vertex = to->n_vertices + level->n_vertices};
  for (size_t i = 0; i < level->n_vertices; i++)
    for (int axis = 0; axis < 3; axis++)
      to->position[axis][to->n_vertices + i] = piece.vertices.position[axis][i];
  for (size_t i = 0; i < level->count; i++) {
    to->cluster[to->count + i] = (uint32_t)cluster;
    for (int k = 0; k < 3; k++)
      to->corners[to->count + i][k] = (uint32_t)to->n_vertices + conic_hybrid_corner(&piece, i, k);
  }
  conic_hybrid_stitch(&stitching);
  CHECK(stitching.triangle == to->count + level->count + n_put);
  CHECK(stitching.vertex == to->n_vertices + level->n_vertices + n_put);
  to->count = stitching.triangle;
  to->n_vertices = stitching.vertex;
  s->n_put += n_put;
}

/* --- what holds --- */

/* Where a drawn vertex lies among the mesh's. */
static void place_drawn(borders_scene *s) {
  size_t n = s->n_vertices;
  spot *spots = malloc(n * sizeof *spots);
  if (!spots)
    exit(1);
  for (uint32_t i = 0; i < n; i++) {
    for (int axis = 0; axis < 3; axis++)
      spots[i].at[axis] = s->at[i][axis] + 0.0f;
    spots[i].vertex = s->place[i];
  }
  qsort(spots, n, sizeof *spots, compare_places);
  for (size_t i = 0; i < s->drawn.n_vertices; i++) {
    float at[3];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = s->drawn.position[axis][i] + 0.0f;
    const spot *found = bsearch(at, spots, n, sizeof *spots, compare_places);
    CHECK(found != NULL);
    s->drawn_place[i] = found ? found->vertex : 0;
  }
  free(spots);
}

static void check_edges(borders_scene *s) {
  place_drawn(s);
  size_t n = 3 * s->drawn.count;
  edge *edges = list_edges((const uint32_t(*)[3])s->drawn.corners, s->drawn_place, s->drawn.count);
  for (size_t i = 0; i < n;) {
    size_t alike = count_alike(edges, i, n);
    s->n_edges++;
    s->n_single += alike != 2 && !(s->is_border[edges[i].a] && s->is_border[edges[i].b]);
    i += alike;
  }
  free(edges);
}

static double distance_of(const borders_scene *s, const double at[3]) {
  double least2 = HUGE_VAL;
  for (size_t i = 0; i < s->drawn.count; i++) {
    double corners[3][3];
    for (int k = 0; k < 3; k++)
      for (int axis = 0; axis < 3; axis++)
        corners[k][axis] = (double)s->drawn.position[axis][s->drawn.corners[i][k]];
    double distance2 = conic_distance2_to_triangle(at, corners[0], corners[1], corners[2]);
    least2 = distance2 < least2 ? distance2 : least2;
  }
  return sqrt(least2);
}

/* Some vertices of the mesh, by the greatest error that is drawn. */
static void check_distances(borders_scene *s, uint64_t *state) {
  double most = 0.0;
  for (size_t i = 0; i < s->hybrid->n_clusters; i++)
    most = (double)level_of(s, i)->error > most ? (double)level_of(s, i)->error : most;
  for (int run = 0; run < 200 && most > 0.0; run++) {
    size_t i = (size_t)(random_unit(state) * (double)s->n_vertices);
    double at[3];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = (double)s->at[i][axis];
    double share = distance_of(s, at) / most;
    s->farthest = share > s->farthest ? share : s->farthest;
  }
  CHECK(s->farthest <= 1.0);
}

/* The middles of a triangle and of one of its edges, by the error of its level. */
static void check_triangle(borders_scene *s, const conic_hybrid_level *level, size_t triangle) {
  conic_hybrid_piece piece = conic_hybrid_piece_of(s->hybrid, (uint32_t)(level - s->hybrid->levels));
  for (int n = 2; n <= 3; n++) {
    double at[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < n; k++)
      for (int axis = 0; axis < 3; axis++)
        at[axis] += (double)piece.vertices.position[axis][conic_hybrid_corner(&piece, triangle, k)] / n;
    double distance = distance_of(s, at);
    CHECK(distance <= (double)level->error);
    if (level->error > 0.0f && distance > s->farthest_back * (double)level->error)
      s->farthest_back = distance / (double)level->error;
  }
}

/* Nor are simpler triangles farther from the mesh, to which all clusters are drawn, than their errors. */
static void check_back(borders_scene *s, size_t room) {
  const conic_hybrid *h = s->hybrid;
  size_t n = 0;
  CHECK_OK(conic_triangles_allocate(s->context, room, 3 * room, CONIC_TRIANGLES_CLUSTERS, &s->drawn));
  s->drawn.count = s->drawn.n_vertices = 0;
  for (size_t i = 0; i < h->n_clusters; i++)
    s->levels[i] = s->stages[i] = 0;
  for (size_t i = 0; i < h->n_clusters; i++)
    put_cluster(s, i);
  for (size_t i = 0; i < h->n_clusters; i++)
    for (uint32_t k = 1; k < h->clusters[i].n_levels; k++) {
      const conic_hybrid_level *level = &h->levels[h->clusters[i].first_level + k];
      for (size_t t = 0; t < level->count && level->kind == CONIC_HYBRID_TRIANGLES; t++)
        if (n++ % 16 == 0)
          check_triangle(s, level, t);
    }
  conic_triangles_release(s->context, &s->drawn);
}

static void find_border(borders_scene *s) {
  const conic_hybrid *h = s->hybrid;
  size_t n = 0;
  uint32_t(*corners)[3];
  for (size_t i = 0; i < h->n_clusters; i++)
    n += h->levels[h->clusters[i].first_level].count;
  corners = malloc((n + 1) * sizeof *corners);
  s->is_border = calloc(s->n_vertices, 1);
  if (!corners || !s->is_border)
    exit(1);
  n = 0;
  for (size_t i = 0; i < h->n_clusters; i++) {
    conic_hybrid_piece piece = conic_hybrid_piece_of(h, h->clusters[i].first_level);
    for (size_t t = 0; t < h->levels[h->clusters[i].first_level].count; t++, n++)
      for (int k = 0; k < 3; k++)
        corners[n][k] = (uint32_t)s->first[i] + conic_hybrid_corner(&piece, t, k);
  }
  edge *edges = list_edges((const uint32_t(*)[3])corners, s->place, n);
  for (size_t i = 0; i < 3 * n;) {
    size_t alike = count_alike(edges, i, 3 * n);
    if (alike != 2)
      s->is_border[edges[i].a] = s->is_border[edges[i].b] = 1;
    i += alike;
  }
  free(edges);
  free(corners);
}

/* Clusters at levels by chance; with `is_alone` as if each had nothing beside it. */
static void draw_and_check(borders_scene *s, uint64_t *state, size_t room, int is_alone) {
  CHECK_OK(conic_triangles_allocate(s->context, room, 3 * room, CONIC_TRIANGLES_CLUSTERS, &s->drawn));
  s->drawn.count = s->drawn.n_vertices = 0;
  choose(s, state);
  for (size_t i = 0; i < s->hybrid->n_clusters && is_alone; i++)
    s->stages[i] = CONIC_HYBRID_HIDDEN;
  for (size_t i = 0; i < s->hybrid->n_clusters; i++)
    put_cluster(s, i);
  check_edges(s);
  if (!is_alone)
    check_distances(s, state);
  conic_triangles_release(s->context, &s->drawn);
}

static void test_mesh(conic_context *context, const char *name, const char *path, int n_runs) {
  borders_scene s = {.context = context, .name = name};
  conic_hybrid_options options;
  conic_triangles mesh;
  uint64_t state = 11;
  conic_hybrid_options_init(&options);
  hybrid_mesh(context, path, 48, &mesh);
  CHECK_OK(conic_hybrid_build(context, &mesh, &options, &s.hybrid, NULL));
  size_t n_clusters = s.hybrid->n_clusters, room = 0;
  for (size_t i = 0; i < n_clusters; i++)
    room += s.hybrid->levels[s.hybrid->clusters[i].first_level].count + s.hybrid->clusters[i].n_slots;
  s.levels = malloc((n_clusters + 1) * sizeof *s.levels);
  s.stages = malloc((n_clusters + 1) * sizeof *s.stages);
  s.drawn_place = malloc((3 * room + 1) * sizeof *s.drawn_place);
  if (!s.levels || !s.stages || !s.drawn_place)
    exit(1);
  list_all_vertices(&s);
  find_places(&s);
  find_border(&s);
  for (int run = 0; run < n_runs; run++)
    draw_and_check(&s, &state, room, 0);
  check_back(&s, room);
  CHECK(s.farthest_back > 0.5); /* errors are no larger than need be */
  fprintf(stderr, "%s: %zu patches, %zu edges, %zu vertices put in, farthest %.2f of the error, back %.2f\n", name,
          n_clusters, s.n_edges, s.n_put, s.farthest, s.farthest_back);
  CHECK(s.n_put > 100);
  CHECK(s.n_single == 0);
  draw_and_check(&s, &state, room, 1);
  CHECK(s.n_single > 100); /* it would have been seen */
  free(s.levels);
  free(s.stages);
  free(s.drawn_place);
  free(s.place);
  free(s.at);
  free(s.first);
  free(s.is_border);
  conic_hybrid_destroy(s.hybrid);
}

int main(int argc, char **argv) {
  static const char *const names[] = {"cow.obj", "fandisk.obj", "spot.obj"};
  const char *source_folder = argc > 1 ? argv[1] : ".";
  conic_context *context = check_context(2);
  test_mesh(context, "terrain", NULL, IS_SANITIZED ? 2 : 6);
  for (size_t i = 0; i < sizeof names / sizeof *names && !IS_SANITIZED; i++) {
    const char *path = check_data(source_folder, names[i]);
    if (path)
      test_mesh(context, names[i], path, 4);
  }
  conic_context_destroy(context);
  return check_result();
}
