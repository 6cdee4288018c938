/* The pass of hiding: the depth from which on splats and triangles hide. */
#include "core/lanes/instruction_sets.h"
#include "raster/view/part.h"
#include "tests/support/triangle_fixture.h"

enum { WIDTH = 111, HEIGHT = 83 };

static void draw_z(fixture *f, const conic_drawing *drawing, int passes, conic_isa isa, int tile, conic_image *image) {
  conic_render_options options = f->options;
  options.passes = passes;
  options.isa = isa;
  options.tile = tile;
  CHECK_OK(conic_render_drawing(f->context, f->renderer, drawing, &f->camera, &options, 1, image, NULL));
}

/* The nearer of the nearest triangle and what conic_render_hiding says of the splats. */
static void check_against_parts(fixture *f, const conic_triangles *t) {
  static float hiding[WIDTH * HEIGHT];
  const conic_drawing both = {&f->splats, t}, triangles = {NULL, t};
  conic_image image, of_triangles;
  long n_splats = 0, n_triangles = 0;
  memset(hiding, 0, sizeof hiding);
  CHECK_OK(conic_image_allocate(f->context, WIDTH, HEIGHT, 1u << CONIC_PLANE_Z, &image));
  CHECK_OK(conic_image_allocate(f->context, WIDTH, HEIGHT, 1u << CONIC_PLANE_Z, &of_triangles));
  CHECK_OK(conic_render_hiding(f->renderer, &f->splats, &f->camera, &f->options, hiding));
  draw_z(f, &triangles, 1, CONIC_ISA_AUTO, 64, &of_triangles);
  const float *z = image.planes[CONIC_PLANE_Z], *z_triangle = of_triangles.planes[CONIC_PLANE_Z];
  for (int isa = 0; isa < CONIC_N_ISAS; isa++) {
    if (!conic_isa_is_here((conic_isa)isa))
      continue;
    draw_z(f, &both, CONIC_PASS_OF_HIDING, (conic_isa)isa, 8 << isa % 4, &image);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
      float splat = hiding[i] > 0.0f ? 1.0f / hiding[i] : 0.0f, expected = splat;
      if (z_triangle[i] > 0.0f && (!(splat > 0.0f) || z_triangle[i] < splat))
        expected = z_triangle[i];
      CHECK(z[i] == expected);
      n_splats += expected > 0.0f && expected == splat;
      n_triangles += expected > 0.0f && expected != splat;
    }
  }
  printf("%ld pixels of splats, %ld of triangles\n", n_splats, n_triangles);
  CHECK(n_splats > 1000 && n_triangles > 100);
  draw_z(f, &triangles, CONIC_PASS_OF_HIDING, CONIC_ISA_AUTO, 64, &image);
  CHECK(conic_image_hash(&image, CONIC_PLANE_Z) == conic_image_hash(&of_triangles, CONIC_PLANE_Z));
  conic_image_release(f->context, &image);
  conic_image_release(f->context, &of_triangles);
}

/* It is ε behind a disc that is seen from straight ahead. */
static void check_disc(fixture *f) {
  const double p[3] = {0.0, 0.0, 4.0}, u[3] = {0.5, 0.0, 0.0}, v[3] = {0.0, 0.5, 0.0};
  const conic_drawing drawing = {&f->splats, NULL};
  conic_image image;
  fixture_splats(f, 1);
  fixture_set(f, 0, p, u, v, 1, 1, 1);
  CHECK_OK(conic_image_allocate(f->context, WIDTH, HEIGHT, 1u << CONIC_PLANE_Z, &image));
  draw_z(f, &drawing, CONIC_PASS_OF_HIDING, CONIC_ISA_AUTO, 64, &image);
  CHECK_NEAR((double)((float *)image.planes[CONIC_PLANE_Z])[HEIGHT / 2 * WIDTH + WIDTH / 2], 4.0 + 1.5 * 0.5, 1e-4);
  conic_image_release(f->context, &image);
}

int main(void) {
  fixture f = fixture_open(2);
  conic_render_options_init(&f.options);
  fixture_camera(&f, WIDTH, HEIGHT, 80.0);
  check_disc(&f);
  conic_triangles t = triangles_make(&f, 1, 3, 0);
  triangles_torus_of_splats(&f, 3000);
  f.camera.cam_from_world[2][3] = 1.5;
  triangles_corner(&t, 0, 0, 1, 2);
  for (size_t i = 0; i < 3; i++)
    triangles_vertex(&t, i, i == 1 ? 5.0 : -3.0, i == 2 ? 5.0 : -3.0, i == 1 ? 0.5 : 2.2);
  check_against_parts(&f, &t);
  f.options.passes = CONIC_PASS_OF_HIDING;
  CHECK_OK(conic_image_allocate(f.context, WIDTH, HEIGHT, ALL_PLANES, &f.image));
  CHECK(conic_render(f.renderer, &f.splats, &f.camera, &f.options, &f.image, NULL) == CONIC_ERROR_ARGUMENT);
  conic_triangles_release(f.context, &t);
  fixture_close(&f);
  return check_result();
}
