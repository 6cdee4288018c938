/* Where the near plane cuts an edge, the triangles on its two sides get the same new corner, to the bit: else there are
 * gaps between them. */
#include "raster/triangles/triangle_frame.h"
#include "tests/support/triangle_fixture.h"

static const double near_z = 0.1;

/* How many corners of one polygon are at near and, to the bit, corners of the other. */
static int shared_at_near(const conic_clip_corner *a, int n_a, const conic_clip_corner *b, int n_b) {
  int n = 0;
  for (int i = 0; i < n_a; i++)
    for (int k = 0; k < n_b; k++)
      n += a[i].p[2] == near_z && memcmp(a[i].p, b[k].p, sizeof a[i].p) == 0;
  return n;
}

/* Two triangles about an edge from before the plane to behind it, each with a third corner of its own. */
static void fill_pair(conic_triangles *pair, uint64_t *state) {
  for (size_t i = 0; i < 4; i++) {
    double z = i == 0 ? -1.0 : i == 1 ? 1.0 : i == 2 ? -0.5 : 1.5;
    triangles_vertex(pair, i, fixture_random(state) - 0.5, fixture_random(state) - 0.5,
                     near_z + z * (0.1 + fixture_random(state)));
  }
  triangles_corner(pair, 0, 0, 1, 2);
  triangles_corner(pair, 1, 1, 0, 3);
}

int main(void) {
  enum { N_PAIRS = 1000 };
  fixture f = fixture_open(1);
  conic_triangles pair = triangles_make(&f, 2, 4, 0);
  conic_triangle_frame frame;
  conic_view view;
  uint64_t state = 9;
  memset(&frame, 0, sizeof frame);
  fixture_camera(&f, 200, 200, 2.0); /* wide, so that nothing is near the guard band */
  fixture_splats(&f, 1);
  CHECK_OK(conic_view_init(f.context, &f.splats, &f.camera, &f.options, near_z, 1.0, &view));
  for (int i = 0; i < N_PAIRS; i++) {
    conic_clip_corner corners[2][CONIC_CLIPPED_CORNERS];
    fill_pair(&pair, &state);
    conic_triangle_frame_begin(&frame, f.context, &pair, &view, &f.camera);
    int n_first = conic_triangle_clip(&frame, 0, corners[0]), n_second = conic_triangle_clip(&frame, 1, corners[1]);
    CHECK(n_first == 3 && n_second == 4);
    CHECK(shared_at_near(corners[0], n_first, corners[1], n_second) == 1);
  }
  conic_triangle_frame_release(f.context, &frame);
  conic_triangles_release(f.context, &pair);
  fixture_close(&f);
  return check_result();
}
