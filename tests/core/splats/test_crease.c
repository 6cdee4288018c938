/* Normals of corners: round over flat edges, sharp over steep ones, whichever vertices the corners name. */
#include "core/base/memory.h"
#include "tests/support/triangle_fixture.h"

static void normal_at(const conic_triangles *t, size_t triangle, int corner, double normal[3]) {
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = (double)t->normal[axis][t->normal_corners[triangle][corner]];
}

/* A prism of n sides from y = -1 to 1 without ends, of vertices that triangles have in common, or each its own. */
static conic_triangles make_prism(fixture *f, int n, int is_soup) {
  conic_triangles t = triangles_make(f, 2 * (size_t)n, (size_t)n * (is_soup ? 6 : 2), 0);
  for (int i = 0; i < n; i++) {
    const int places[2][3] = {{2 * i, 2 * ((i + 1) % n), 2 * ((i + 1) % n) + 1},
                              {2 * i, 2 * ((i + 1) % n) + 1, 2 * i + 1}};
    for (int half = 0; half < 2; half++)
      for (int k = 0; k < 3; k++) {
        int place = places[half][k];
        uint32_t vertex = (uint32_t)(is_soup ? 6 * i + 3 * half + k : place);
        double angle = 6.283185307179586 * (place / 2) / n;
        triangles_vertex(&t, vertex, cos(angle), place % 2 ? 1.0 : -1.0, -sin(angle));
        t.corners[2 * i + half][k] = vertex;
      }
  }
  return t;
}

/* Edges of 360°/n are round from that angle on, and sharp below. */
static void test_prism(fixture *f, int is_soup) {
  enum { N = 12 };
  conic_triangles t = make_prism(f, N, is_soup);
  double normal[3];
  CHECK_OK(conic_triangles_crease(f->context, &t, 31.0));
  CHECK(t.n_normals == 2 * N);
  for (size_t i = 0; i < t.count; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t vertex = t.corners[i][k];
      normal_at(&t, i, k, normal);
      double out = normal[0] * (double)t.position[0][vertex] + normal[2] * (double)t.position[2][vertex];
      CHECK(out > 0.98 && fabs(normal[1]) < 1e-6);
    }
  CHECK_OK(conic_triangles_crease(f->context, &t, 29.0));
  CHECK(t.n_normals == 4 * N);
  for (size_t i = 0; i < t.count; i++)
    for (int k = 0; k < 3; k++) {
      double middle = 6.283185307179586 * (double)(i / 2 * 2 + 1) / (2.0 * N);
      normal_at(&t, i, k, normal);
      CHECK_NEAR(normal[0] * cos(middle) - normal[2] * sin(middle), 1.0, 1e-6);
    }
  CHECK_OK(conic_triangles_check(f->context, &t, "prism"));
  conic_triangles_release(f->context, &t);
}

/* A field whose rows are as high as `row` by turns; four places in its middle are higher, so that a few edges between
 * them, with an end at either side, are over 30°. */
static conic_triangles make_field(fixture *f, double row, double higher) {
  enum { N = 20, MIDDLE = 10 };
  conic_triangles t = triangles_make(f, 2 * (size_t)(N - 1) * (N - 1), (size_t)N * N, 0);
  for (int i = 0; i < N * N; i++) {
    int x = i % N, z = i / N, is_higher = z == MIDDLE && x >= MIDDLE - 2 && x < MIDDLE + 2;
    triangles_vertex(&t, (uint32_t)i, x, (z % 2 ? 0.0 : row) + (is_higher ? higher : 0.0), z);
  }
  for (uint32_t i = 0, n = 0; i < N * (N - 1); i++)
    if (i % N < N - 1) {
      triangles_corner(&t, n++, i, i + N, i + N + 1);
      triangles_corner(&t, n++, i, i + N + 1, i + 1);
    }
  return t;
}

/* Where most edges bend by 20°, a few steeper ones are round; where the others are flat, they are a crease. */
static void test_rounds(fixture *f) {
  conic_triangles rounded = make_field(f, 0.176, 0.15), flat = make_field(f, 0.0, 0.5);
  CHECK_OK(conic_triangles_crease(f->context, &rounded, 30.0));
  CHECK(rounded.n_normals == 400);
  CHECK_OK(conic_triangles_crease(f->context, &rounded, 15.0)); /* then all are steep, and end at the border */
  CHECK(rounded.n_normals > 700);
  CHECK_OK(conic_triangles_crease(f->context, &flat, 30.0));
  CHECK(flat.n_normals > 400 && flat.n_normals < 420);
  conic_triangles_release(f->context, &rounded);
  conic_triangles_release(f->context, &flat);
}

/* Triangles without an area, not finite ones, and a vertex of very many. */
static void test_odd(fixture *f) {
  enum { N = 600 };
  conic_triangles t = triangles_make(f, N + 2, N + 2, 0);
  triangles_vertex(&t, 0, 0.0, 0.5, 0.0);
  for (uint32_t i = 0; i < N; i++) {
    triangles_vertex(&t, 1 + i, cos(0.01 * i), 0.0, -sin(0.01 * i));
    triangles_corner(&t, i, 0, 1 + i, 1 + (i + 1) % N);
  }
  triangles_vertex(&t, N + 1, NAN, 0.0, 0.0);
  triangles_corner(&t, N, 1, 2, N + 1);
  triangles_corner(&t, N + 1, 3, 3, 4);
  CHECK_OK(conic_triangles_crease(f->context, &t, 30.0));
  CHECK_OK(conic_triangles_check(f->context, &t, "fan"));
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < t.n_normals; i++)
      CHECK(isfinite(t.normal[axis][i]));
  CHECK(conic_triangles_crease(f->context, &t, 91.0) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_triangles_crease(f->context, &t, NAN) == CONIC_ERROR_ARGUMENT);
  conic_triangles_release(f->context, &t);
}

int main(void) {
  fixture f = fixture_open(2);
  test_prism(&f, 0);
  test_prism(&f, 1);
  test_rounds(&f);
  test_odd(&f);
  fixture_close(&f);
  return check_result();
}
