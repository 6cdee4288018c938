/* Pictures of triangles, alone and among splats, against the oracle. */
#include "tests/support/triangle_fixture.h"

static void check(fixture *f, const conic_triangles *t, const char *what, int samples) {
  const conic_drawing drawing = {f->splats.count ? &f->splats : NULL, t};
  conic_reference reference;
  conic_oracle_verdict verdict;
  CHECK_OK(triangles_render(f, t, samples));
  CHECK_OK(conic_oracle_render_drawing(f->context, &drawing, &f->camera, &f->options, CONIC_ORACLE_METHOD, samples,
                                       &reference));
  CHECK_OK(conic_oracle_compare(f->context, &reference, &f->image, &verdict));
  printf("%s: %zu covered, %zu unstable, rgba %.1e, Z %.1e, N %.1e\n", what, verdict.covered_pixels,
         verdict.unstable_pixels, verdict.planes[CONIC_PLANE_RGBA].max_abs, verdict.planes[CONIC_PLANE_Z].max_abs,
         verdict.planes[CONIC_PLANE_NORMAL].max_abs);
  if (!verdict.pass)
    fprintf(stderr, "%s: pixel %d,%d, %s: %g, not %g to %g; %zu unbounded\n", what, verdict.worst.x, verdict.worst.y,
            conic_plane_describe((conic_plane)verdict.worst.plane)->name, verdict.worst.found, verdict.worst.low,
            verdict.worst.high, reference.unbounded_pixels);
  CHECK(verdict.pass);
  CHECK(verdict.covered_pixels > 1000);
  conic_reference_release(f->context, &reference);
}

int main(void) {
  fixture f = fixture_open(2);
  conic_triangles t = triangles_wild(&f, 1200);
  fixture_camera(&f, 96, 72, 55.0);
  f.options.shading = CONIC_SHADE_PHONG;
  f.options.near_z = 0.05;
  check(&f, &t, "wild", 1);
  f.options.cull_back = 1;
  check(&f, &t, "wild, culled, samples", 2);
  f.options.cull_back = 0;
  triangles_torus_of_splats(&f, 1500);
  f.camera.cam_from_world[2][3] = 3.0;
  check(&f, &t, "wild and a torus", 1);
  f.options.method = CONIC_METHOD_RAY;
  f.options.epsilon = 0.3;
  check(&f, &t, "with a fixed tolerance", 1);
  f.options.passes = 1;
  check(&f, &t, "in one pass", 1);
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
  return check_result();
}
