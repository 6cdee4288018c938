/* The triangles that splats make with their neighbours: all of a ground, none over its hole, none among leaves. */
#include "surface/skin/skin.h"

#include "tests/support/cloud_fixture.h"

static size_t count_inner(const conic_skin *skin, size_t n) {
  size_t n_inner = 0;
  for (size_t i = 0; i < n; i++)
    n_inner += skin->is_inner[i];
  return n_inner;
}

/* No half of an edge is of two triangles. Returns how many are without another half: the border's. */
static size_t check_edges(const conic_skin *skin, size_t n_splats) {
  uint32_t(*ends)[24] = calloc(n_splats, sizeof *ends);
  size_t n_open = 0;
  for (size_t i = 0; i < 3 * skin->n_triangles; i++) {
    uint32_t from = skin->corners[i / 3][i % 3], to = skin->corners[i / 3][(i + 1) % 3], k = 0;
    for (; k < 23 && ends[from][k]; k++)
      CHECK(ends[from][k] != to + 1);
    ends[from][k] = to + 1;
  }
  for (size_t from = 0; from < n_splats; from++)
    for (size_t k = 0; k < 24 && ends[from][k]; k++) {
      uint32_t to = ends[from][k] - 1, other = 0;
      while (other < 24 && ends[to][other] != from + 1)
        other++;
      n_open += other == 24;
    }
  free(ends);
  return n_open;
}

static void test_ground(conic_context *context) {
  conic_splats cloud;
  conic_skin skin;
  cloud_fixture(context, 0, 0, 0, &cloud);
  CHECK_OK(conic_skin_find(context, &cloud, 1.5, &skin));
  size_t n_open = check_edges(&skin, cloud.count), n = cloud.count;
  CHECK(n_open >= 4 * (CLOUD_SIDE - 1) - 40 && n_open <= 4 * (CLOUD_SIDE - 1) + 60);
  CHECK(skin.n_triangles + n_open + 2 == 2 * n); /* Euler: one piece, one border, every splat */
  CHECK(count_inner(&skin, n) == n - n_open);
  for (size_t i = 0; i < skin.n_triangles; i++) { /* as their normals see them, which point up */
    const uint32_t *c = skin.corners[i];
    float ax = cloud.position[0][c[1]] - cloud.position[0][c[0]],
          az = cloud.position[2][c[1]] - cloud.position[2][c[0]];
    float bx = cloud.position[0][c[2]] - cloud.position[0][c[0]],
          bz = cloud.position[2][c[2]] - cloud.position[2][c[0]];
    CHECK(az * bx - ax * bz > 0.0f);
  }
  conic_skin_release(context, &skin);
  conic_splats_release(context, &cloud);
}

/* What splats leave open stays open, with their outlines about it. */
static void test_hole(conic_context *context) {
  conic_splats cloud;
  conic_skin skin;
  cloud_fixture(context, 0, 0, 1, &cloud);
  CHECK_OK(conic_skin_find(context, &cloud, 1.5, &skin));
  for (size_t i = 0; i < skin.n_triangles; i++) {
    double middle[2] = {0.0, 0.0};
    for (int k = 0; k < 3; k++) {
      middle[0] += (double)cloud.position[0][skin.corners[i][k]] / 3.0;
      middle[1] += (double)cloud.position[2][skin.corners[i][k]] / 3.0;
    }
    CHECK(fabs(middle[0] - 0.5) > 0.06 || fabs(middle[1] - 0.5) > 0.06);
  }
  for (size_t i = 0; i < cloud.count; i++) {
    double x = fabs((double)cloud.position[0][i] - 0.5), z = fabs((double)cloud.position[2][i] - 0.5);
    CHECK(!(x < 0.11 && z < 0.11) || !skin.is_inner[i]);
  }
  conic_skin_release(context, &skin);
  conic_splats_release(context, &cloud);
}

/* Where every seventh splat stands out of a ground, gaps that it makes are filled. */
static void test_rough(conic_context *context) {
  conic_splats cloud;
  conic_skin skin;
  cloud_fixture(context, 0, 0, 0, &cloud);
  for (size_t i = 0; i < cloud.count; i += 7)
    cloud.position[1][i] += 1.5f / CLOUD_SIDE;
  CHECK_OK(conic_skin_find(context, &cloud, 1.5, &skin));
  check_edges(&skin, cloud.count);
  CHECK(count_inner(&skin, cloud.count) > 1850); /* 1720 before */
  conic_skin_release(context, &skin);
  conic_splats_release(context, &cloud);
}

/* Leaves and dots have no triangle, and open none of the ground. */
static void test_leaves(conic_context *context) {
  conic_splats cloud;
  conic_skin skin;
  cloud_fixture(context, 300, 100, 0, &cloud);
  for (size_t i = CLOUD_GROUND + 300; i < cloud.count; i++) /* dots lie on the ground */
    for (int axis = 0; axis < 3; axis++)
      cloud.position[axis][i] =
          0.9f * cloud.position[axis][9 * i % CLOUD_GROUND] + 0.1f * cloud.position[axis][9 * i % CLOUD_GROUND + 1];
  CHECK_OK(conic_skin_find(context, &cloud, 1.5, &skin));
  for (size_t i = 0; i < 3 * skin.n_triangles; i++)
    CHECK(skin.corners[i / 3][i % 3] < CLOUD_GROUND);
  CHECK(skin.n_triangles + check_edges(&skin, cloud.count) + 2 == 2 * (size_t)CLOUD_GROUND);
  for (size_t i = CLOUD_GROUND; i < cloud.count; i++)
    CHECK(!skin.is_inner[i]);
  conic_skin_release(context, &skin);
  cloud.count = 0; /* none */
  CHECK_OK(conic_skin_find(context, &cloud, 1.5, &skin));
  CHECK(skin.n_triangles == 0);
  conic_skin_release(context, &skin);
  conic_splats_release(context, &cloud);
}

int main(void) {
  conic_context *context = check_context(2);
  test_ground(context);
  test_hole(context);
  test_rough(context);
  test_leaves(context);
  conic_context_destroy(context);
  return check_result();
}
