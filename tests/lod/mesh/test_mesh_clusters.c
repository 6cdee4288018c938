/* Clusters of faces: every face of use in just one, whatever the mesh, and the sums that costs are made of, kept while
 * clusters grow, are those of the clusters as they are. */
#include "core/base/vectors.h"
#include "lod/mesh/mesh.h"
#include "lod/mesh/mesh_clusters.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/random_numbers.h"

typedef struct clustered {
  conic_context *context;
  conic_triangles triangles;
  conic_mesh mesh;
  conic_adjacency adjacency;
  conic_mesh_clusters clusters;
} clustered;

/* Takes the triangles over. */
static clustered cluster(conic_context *context, conic_triangles *triangles, double phase1, double phase2,
                         double most_area) {
  clustered c = {.context = context};
  const conic_clustering_options options = {phase1, phase2, most_area};
  CHECK_OK(conic_flat_mesh(context, triangles, &c.triangles));
  conic_triangles_release(context, triangles);
  c.mesh.n_vertices = c.triangles.n_vertices;
  c.mesh.n_faces = c.triangles.count;
  for (int axis = 0; axis < 3; axis++)
    c.mesh.position[axis] = c.triangles.position[axis];
  c.mesh.faces = (const uint32_t(*)[3])c.triangles.corners;
  CHECK_OK(conic_adjacency_find(context, &c.mesh, &c.adjacency));
  CHECK_OK(conic_mesh_clusters_find(context, &c.mesh, &c.adjacency, &options, &c.clusters));
  return c;
}

static void release(clustered *c) {
  conic_mesh_clusters_release(c->context, &c->clusters);
  conic_adjacency_release(c->context, &c->adjacency);
  conic_triangles_release(c->context, &c->triangles);
}

static int same(double a, double b, double scale) {
  return fabs(a - b) <= 1e-11 * (fabs(scale) + 1.0);
}

/* The sums of a cluster from its faces, one by one, and its outline from the edges that leave it. */
static void check_sums(const clustered *c, uint32_t i_cluster) {
  conic_unit_box box = conic_unit_box_of(&c->mesh, &c->adjacency);
  const conic_face_sums *kept = &c->clusters.sums[i_cluster];
  conic_face_sums direct;
  memset(&direct, 0, sizeof direct);
  for (size_t i = 0; i < c->mesh.n_faces; i++)
    if (c->clusters.of_face[i] == i_cluster) {
      conic_face_sums face = conic_face_sums_of(&c->mesh, &c->adjacency, &box, i);
      direct = conic_face_sums_join(&direct, &face, 0.0);
    }
  for (size_t i = 0; i < c->adjacency.n_joints; i++) {
    const conic_joint *joint = &c->adjacency.joints[i];
    if (c->clusters.of_face[joint->faces[0]] == i_cluster && c->clusters.of_face[joint->faces[1]] == i_cluster)
      direct.outline -= 2.0 * joint->length * box.scale;
  }
  int is_same = same(direct.area, kept->area, 1.0) && same(direct.outline, kept->outline, 100.0);
  for (int k = 0; k < 3; k++)
    is_same = is_same && same(direct.first[k], kept->first[k], 1.0) && same(direct.normal[k], kept->normal[k], 1.0);
  for (int k = 0; k < 6; k++)
    is_same = is_same && same(direct.second[k], kept->second[k], 1.0) && same(direct.normals[k], kept->normals[k], 1.0);
  CHECK(is_same);
}

static conic_joining_cost whole_cost(const conic_face_sums *a, const conic_face_sums *b, double shared,
                                     double largest_area) {
  conic_face_sums both;
  conic_joining_cost cost = conic_joining_cost_without_plane(a, b, shared, largest_area, &both);
  conic_joining_cost_add_plane(&both, &cost);
  return cost;
}

/* Fit and direction by their definitions: means over the faces of the squared distance from the plane, by three places
 * in each, which is exact for what is quadratic, and of (1 - n·nᵢ)². */
static void check_cost(const clustered *c, uint32_t a, uint32_t b) {
  conic_unit_box box = conic_unit_box_of(&c->mesh, &c->adjacency);
  const conic_face_sums *sa = &c->clusters.sums[a], *sb = &c->clusters.sums[b];
  conic_face_sums both = conic_face_sums_join(sa, sb, 0.0);
  conic_joining_cost cost = whole_cost(sa, sb, 0.0, 1.0);
  double normal[3], d, fit = 0.0, direction = 0.0, area = 0.0;
  conic_face_sums_plane(&both, normal, &d);
  for (size_t i = 0; i < c->mesh.n_faces; i++) {
    if (c->clusters.of_face[i] != a && c->clusters.of_face[i] != b)
      continue;
    conic_face_sums face = conic_face_sums_of(&c->mesh, &c->adjacency, &box, i);
    for (int side = 0; side < 3; side++) {
      double at[2][3], distance = d;
      for (int k = 0; k < 2; k++)
        conic_mesh_corner(&c->mesh, i, (side + k) % 3, at[k]);
      for (int axis = 0; axis < 3; axis++)
        distance += normal[axis] * (0.5 * (at[0][axis] + at[1][axis]) - box.middle[axis]) * box.scale;
      fit += face.area / 3.0 * distance * distance;
    }
    double along = face.area > 0.0 ? conic_dot(normal, face.normal) / face.area : 0.0;
    direction += face.area * (1.0 - along) * (1.0 - along);
    area += face.area;
  }
  if (!(area > 0.0))
    return;
  CHECK_NEAR(cost.fit, fit / area, 1e-12 + 1e-9 * fit / area);
  CHECK_NEAR(cost.direction, direction / area, 1e-9);
  CHECK_NEAR(cost.size, area, 1e-12 + 1e-9 * area);
  CHECK(cost.shape >= -1.0 && cost.shape <= 1.0);
}

/* Every face of use is in one cluster; clusters hang together, are numbered by their first faces, and none is empty. */
static void check_faces(const clustered *c) {
  size_t n = c->clusters.n_clusters, n_unused = 0, n_next = 0;
  size_t *counts = calloc(n + 1, sizeof *counts);
  uint32_t *root = calloc(c->mesh.n_faces + 1, sizeof *root);
  if (!counts || !root)
    exit(1);
  for (size_t i = 0; i < c->mesh.n_faces; i++) {
    uint32_t cluster = c->clusters.of_face[i];
    root[i] = (uint32_t)i;
    CHECK((cluster == CONIC_NO_CLUSTER) == (c->adjacency.side[i] == 0));
    if (cluster == CONIC_NO_CLUSTER) {
      n_unused++;
      continue;
    }
    CHECK(cluster < n && cluster <= n_next);
    n_next += cluster == n_next;
    counts[cluster]++;
  }
  CHECK(n_unused == c->adjacency.oddities.nan + c->adjacency.oddities.zero);
  CHECK(n_next == n);
  for (int is_changing = 1; is_changing;) { /* the least face that can be reached within the cluster */
    is_changing = 0;
    for (size_t k = 0; k < c->adjacency.n_joints; k++) {
      const uint32_t *f = c->adjacency.joints[k].faces;
      if (c->clusters.of_face[f[0]] != c->clusters.of_face[f[1]] || root[f[0]] == root[f[1]])
        continue;
      root[f[0]] = root[f[1]] = root[f[0]] < root[f[1]] ? root[f[0]] : root[f[1]];
      is_changing = 1;
    }
  }
  size_t n_roots = 0;
  for (size_t i = 0; i < c->mesh.n_faces; i++)
    n_roots += c->clusters.of_face[i] != CONIC_NO_CLUSTER && root[i] == i;
  CHECK(n_roots == n);
  free(root);
  free(counts);
}

static void check_all(const clustered *c) {
  check_faces(c);
  size_t step = 1 + c->clusters.n_clusters / 40;
  for (uint32_t i = 0; i < c->clusters.n_clusters; i += (uint32_t)step)
    check_sums(c, i);
  size_t n_checked = 0;
  for (size_t i = 0; i < c->adjacency.n_joints && n_checked < 40; i += 1 + c->adjacency.n_joints / 400) {
    uint32_t a = c->clusters.of_face[c->adjacency.joints[i].faces[0]];
    uint32_t b = c->clusters.of_face[c->adjacency.joints[i].faces[1]];
    if (a != b) {
      check_cost(c, a, b);
      n_checked++;
    }
  }
}

/* --- meshes that are no closed surfaces --- */

static void make(conic_context *context, size_t n_vertices, size_t n_faces, conic_triangles *mesh) {
  CHECK_OK(conic_triangles_allocate(context, n_faces, n_vertices, 0, mesh));
}

static void put_vertex(conic_triangles *mesh, size_t i, double x, double y, double z) {
  mesh->position[0][i] = (float)x;
  mesh->position[1][i] = (float)y;
  mesh->position[2][i] = (float)z;
}

static void put_face(conic_triangles *mesh, size_t i, uint32_t a, uint32_t b, uint32_t c) {
  mesh->corners[i][0] = a;
  mesh->corners[i][1] = b;
  mesh->corners[i][2] = c;
}

/* Five faces on one edge, one twice, one wound the other way; one that is a line, one a point, one that is not finite.
 */
static void test_odd_faces(conic_context *context) {
  conic_triangles mesh;
  make(context, 10, 9, &mesh);
  put_vertex(&mesh, 0, 0, 0, 0);
  put_vertex(&mesh, 1, 1, 0, 0);
  for (size_t k = 0; k < 4; k++)
    put_vertex(&mesh, 2 + k, 0.5, cos(1.3 * (double)k), sin(1.3 * (double)k));
  put_vertex(&mesh, 6, 0, 0, 0); /* where 0 is */
  put_vertex(&mesh, 7, NAN, 0, 0);
  put_vertex(&mesh, 8, 0.25, 0, 0);
  put_vertex(&mesh, 9, 3, 3, 3);
  for (uint32_t k = 0; k < 4; k++)
    put_face(&mesh, k, k % 2, 1 - k % 2, 2 + k);
  put_face(&mesh, 4, 6, 1, 2); /* face 0 again, by another vertex in the same place */
  put_face(&mesh, 5, 0, 1, 8); /* without area, but three places */
  put_face(&mesh, 6, 0, 6, 1); /* two places */
  put_face(&mesh, 7, 0, 1, 7);
  put_face(&mesh, 8, 9, 9, 9);
  clustered c = cluster(context, &mesh, 0.2, 0.2, 0.05);
  CHECK(c.adjacency.oddities.nan == 1 && c.adjacency.oddities.zero == 2 && c.adjacency.oddities.welded == 1);
  CHECK(c.adjacency.oddities.crowded >= 1);
  check_all(&c);
  release(&c);
}

/* A strip with one half turn: the edge where its ends meet cannot agree. */
static void test_one_sided(conic_context *context) {
  enum { N = 40 };
  conic_triangles mesh;
  make(context, 2 * N, 2 * N, &mesh);
  for (size_t k = 0; k < N; k++)
    for (int side = 0; side < 2; side++) {
      double angle = 2.0 * 3.14159265358979 * (double)k / N, wide = side ? 0.3 : -0.3;
      double r = 1.0 + wide * cos(0.5 * angle);
      put_vertex(&mesh, 2 * k + (size_t)side, r * cos(angle), r * sin(angle), wide * sin(0.5 * angle));
    }
  for (uint32_t k = 0; k < N; k++) {
    uint32_t a = 2 * k, b = a + 1, c = k + 1 < N ? a + 2 : 1, d = k + 1 < N ? a + 3 : 0;
    put_face(&mesh, 2 * k, a, b, c);
    put_face(&mesh, 2 * k + 1, c, b, d);
  }
  clustered c = cluster(context, &mesh, 0.2, -2.0, 0.05);
  CHECK(c.adjacency.oddities.twisted == 1 && c.adjacency.oddities.n_pieces == 1);
  CHECK(c.adjacency.oddities.open == 2 * N);
  check_all(&c);
  release(&c);
}

/* Half of the faces wound the other way: they are turned, and the clusters are those of the mesh as it should be. */
static void test_turned(conic_context *context) {
  conic_triangles straight, mixed;
  uint64_t state = 5;
  hybrid_terrain(context, 30, &straight);
  hybrid_terrain(context, 30, &mixed);
  size_t n_turned = 0;
  for (size_t i = 0; i < mixed.count; i++)
    if (random_unit(&state) < 0.3) {
      uint32_t first = mixed.corners[i][0];
      mixed.corners[i][0] = mixed.corners[i][1];
      mixed.corners[i][1] = first;
      n_turned++;
    }
  clustered a = cluster(context, &straight, 0.12, 0.4, 0.05), b = cluster(context, &mixed, 0.12, 0.4, 0.05);
  CHECK(a.adjacency.oddities.turned == 0 && b.adjacency.oddities.turned == n_turned);
  CHECK(b.adjacency.oddities.twisted == 0);
  CHECK(a.clusters.n_clusters == b.clusters.n_clusters);
  CHECK(memcmp(a.clusters.of_face, b.clusters.of_face, a.mesh.n_faces * sizeof *a.clusters.of_face) == 0);
  check_all(&b);
  release(&a);
  release(&b);
}

/* Faces that have nothing to do with each other. */
static void test_soup(conic_context *context) {
  enum { N = 500 };
  conic_triangles mesh;
  uint64_t state = 11;
  make(context, 3 * N, N, &mesh);
  for (size_t i = 0; i < 3 * N; i++)
    put_vertex(&mesh, i, random_unit(&state), random_unit(&state), random_unit(&state));
  for (uint32_t i = 0; i < N; i++)
    put_face(&mesh, i, 3 * i, 3 * i + 1, 3 * i + 2);
  clustered c = cluster(context, &mesh, 1e6, 1e6, 0.05);
  CHECK(c.clusters.n_clusters == N && c.adjacency.oddities.n_pieces == N && c.adjacency.n_joints == 0);
  check_all(&c);
  release(&c);
}

/* Two unit squares that share a side, flat or at a right angle: costs that can be worked out by hand. */
static void test_two_squares(conic_context *context, int is_bent) {
  conic_triangles mesh;
  make(context, 6, 4, &mesh);
  put_vertex(&mesh, 0, 0, 0, 0);
  put_vertex(&mesh, 1, 0, 1, 0);
  put_vertex(&mesh, 2, 1, 0, 0);
  put_vertex(&mesh, 3, 1, 1, 0);
  put_vertex(&mesh, 4, is_bent ? 1 : 2, 0, is_bent);
  put_vertex(&mesh, 5, is_bent ? 1 : 2, 1, is_bent);
  put_face(&mesh, 0, 0, 2, 1);
  put_face(&mesh, 1, 1, 2, 3);
  put_face(&mesh, 2, 2, 4, 3);
  put_face(&mesh, 3, 3, 4, 5);
  clustered c = cluster(context, &mesh, -2.0, -2.0, 1.0);
  const conic_unit_box box = {{0.0, 0.0, 0.0}, 1.0};
  conic_face_sums faces[4], squares[2];
  for (size_t i = 0; i < 4; i++)
    faces[i] = conic_face_sums_of(&c.mesh, &c.adjacency, &box, i);
  squares[0] = conic_face_sums_join(&faces[0], &faces[1], sqrt(2.0));
  squares[1] = conic_face_sums_join(&faces[2], &faces[3], sqrt(2.0));
  CHECK(c.clusters.n_clusters == 4);
  CHECK_NEAR(squares[0].outline, 4.0, 1e-12);
  CHECK_NEAR(conic_face_sums_raggedness(&squares[0]), 16.0 / (4.0 * 3.14159265358979), 1e-12);
  conic_joining_cost cost = whole_cost(&squares[0], &squares[1], 1.0, 4.0);
  double turn = 1.0 - sqrt(0.5);
  CHECK_NEAR(cost.fit, is_bent ? 1.0 / 24.0 : 0.0, 1e-12); /* ∫ (t - ½)²/2 dt from either side of the ridge */
  CHECK_NEAR(cost.direction, is_bent ? turn * turn : 0.0, 1e-12);
  CHECK_NEAR(cost.shape, 1.0 - 16.0 / (36.0 / 2.0), 1e-12); /* outlines 4 and 6, areas 1 and 2 */
  CHECK_NEAR(cost.size, 0.5, 1e-12);
  check_all(&c);
  release(&c);
}

static void test_file(conic_context *context, const char *path) {
  conic_triangles mesh;
  CHECK_OK(conic_triangles_read(context, path, &mesh));
  clustered c = cluster(context, &mesh, 0.12, 0.4, 0.05);
  CHECK(c.clusters.n_first > c.clusters.n_clusters);
  CHECK(c.clusters.n_evaluations < 100 * c.mesh.n_faces);
  check_all(&c);
  release(&c);
}

int main(int argc, char **argv) {
  const char *source_folder = argc > 1 ? argv[1] : ".";
  conic_context *context = check_context(2);
  test_odd_faces(context);
  test_one_sided(context);
  test_turned(context);
  test_soup(context);
  test_two_squares(context, 0);
  test_two_squares(context, 1);
  const char *path = check_data(source_folder, "cow.obj");
  if (path)
    test_file(context, path);
  conic_context_destroy(context);
  return check_result();
}
