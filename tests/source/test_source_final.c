/* What every kind of source can do in final pictures: it moves as one piece, as a camera and lights that move the other
 * way show it, and as the same splats that move; and it lets light through where it keeps opacities. */
#include "conic/gaussians.h"
#include "tests/support/gaussian_fixture.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/layers_fixture.h"
#include "tests/support/octree_fixture.h"

enum { SIZE = 64, N_SPLATS = 3000 };

static const double turn[3][4] = {{0.8, -0.6, 0.0, 0.3}, {0.48, 0.64, -0.6, -0.2}, {0.36, 0.48, 0.8, 0.5}};

static conic_source *open_file(fixture *f, const char *path, const conic_source_options *options) {
  conic_source *source;
  CHECK_OK(conic_source_open(f->context, &path, 1, options, &source));
  return source;
}

static void set_opacity(fixture *f, float opacity) {
  f->splats.opacity = malloc(f->splats.count * sizeof *f->splats.opacity);
  for (size_t i = 0; i < f->splats.count; i++)
    f->splats.opacity[i] = opacity;
}

static conic_source *as_drawing(fixture *f) {
  conic_splats copy = octree_copy(f->context, &f->splats);
  conic_source *source;
  CHECK_OK(conic_source_of_drawing(f->context, &copy, NULL, &source));
  return source;
}

static conic_source *as_octree(fixture *f, int quantize) {
  conic_source *source;
  CHECK_OK(conic_source_of_octree(f->context, octree_build(f->context, &f->splats, quantize), &source));
  return source;
}

static conic_source *as_layers(fixture *f, const conic_source_options *opening) {
  const char *path = files_path("final.lpc");
  conic_layers_options options;
  conic_layers_builder *builder;
  conic_layers_statistics statistics;
  conic_layers_options_init(&options);
  options.keeps_all = 1;
  options.cloud_size = 64;
  CHECK_OK(conic_layers_builder_open(f->context, path, &options, &builder));
  CHECK_OK(conic_layers_builder_append(builder, &f->splats));
  CHECK_OK(conic_layers_builder_finish(builder, &statistics));
  return open_file(f, path, opening);
}

static conic_source *as_hybrid(fixture *f) {
  conic_hybrid_options options;
  conic_triangles mesh;
  conic_hybrid *hybrid;
  conic_source *source;
  conic_hybrid_options_init(&options);
  hybrid_terrain(f->context, 16, &mesh);
  CHECK_OK(conic_hybrid_build(f->context, &mesh, &options, &hybrid, NULL));
  CHECK_OK(conic_source_of_hybrid(f->context, hybrid, &source));
  return source;
}

static conic_source *as_gaussians(fixture *f) {
  const char *path = files_path("final.ply");
  conic_gaussians made = gaussians_random(f->context, 200, 1, 0);
  conic_source_options options;
  conic_gaussian_options profile;
  conic_source_options_init(&options);
  conic_gaussian_options_init(&profile);
  options.gaussians = &profile;
  CHECK_OK(conic_gaussians_write(f->context, path, &made, NULL));
  conic_gaussians_release(f->context, &made);
  return open_file(f, path, &options);
}

static conic_image draw_final(fixture *f, conic_source *source, const conic_source_view *view) {
  conic_image image;
  CHECK_OK(conic_image_allocate(f->context, SIZE, SIZE, ALL_PLANES, &image));
  CHECK_OK(conic_source_draw(source, f->renderer, &f->camera, &f->options, view, &image, NULL));
  return image;
}

/* --- motion --- */

static void turn_back(const double of_world[3], double of_rest[3]) {
  for (int i = 0; i < 3; i++)
    of_rest[i] = turn[0][i] * of_world[0] + turn[1][i] * of_world[1] + turn[2][i] * of_world[2];
}

static void light_scene(conic_lighting *lighting) {
  memset(lighting, 0, sizeof *lighting);
  lighting->is_given = 1;
  lighting->n_lights = 2;
  lighting->lights[0] = (conic_light){CONIC_LIGHT_WORLD, {0.5f, 0.6f, 0.3f}, {0.3, 0.9, 0.2}};
  lighting->lights[1] = (conic_light){CONIC_LIGHT_CAMERA, {0.2f, 0.1f, 0.4f}, {-0.5, 0.2, 0.6}};
  lighting->sky[2] = 0.4f;
  lighting->ground[0] = 0.3f;
  lighting->up[1] = 1.0;
}

/* By how much a plane of floats differs, b's vectors turned as the source is where it has some. */
static double apart(const conic_image *a, const conic_image *b, conic_plane plane, int is_turned) {
  const float *first = a->planes[plane], *second = b->planes[plane];
  size_t n = (size_t)conic_plane_describe(plane)->n_channels;
  double most = 0.0;
  for (size_t i = 0; i < n * SIZE * SIZE; i++) {
    const float *v = second + i / n * n;
    const double *row = turn[i % 3];
    double there =
        !is_turned ? (double)second[i] : row[0] * (double)v[0] + row[1] * (double)v[1] + row[2] * (double)v[2];
    most = fmax(most, fabs((double)first[i] - there));
  }
  return most;
}

/* The picture of the source at rest by what is put against it by hand. */
static conic_image draw_opposite(fixture *f, conic_source *source) {
  const conic_camera camera = f->camera;
  const conic_lighting lighting = f->options.lighting;
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++) {
      double *to = &f->camera.cam_from_world[row][column];
      *to = column == 3 ? camera.cam_from_world[row][3] : 0.0;
      for (int k = 0; k < 3; k++)
        *to += camera.cam_from_world[row][k] * turn[k][column];
    }
  turn_back(lighting.lights[0].direction, f->options.lighting.lights[0].direction);
  turn_back(lighting.up, f->options.lighting.up);
  conic_image image = draw_final(f, source, NULL);
  f->camera = camera;
  f->options.lighting = lighting;
  return image;
}

static conic_image check_carried(fixture *f, conic_source *source) {
  static const conic_plane exact[] = {CONIC_PLANE_ID, CONIC_PLANE_COUNT};
  conic_source_pose poses[2];
  double low[3], high[3];
  conic_image rest = draw_opposite(f, source);
  conic_image before = draw_final(f, source, NULL);
  conic_source_pose_init(&poses[0]);
  memcpy(poses[0].world_from_rest, turn, sizeof turn);
  CHECK_OK(conic_source_move(source, poses, 1));
  conic_image moved = draw_final(f, source, NULL);
  CHECK(apart(&moved, &rest, CONIC_PLANE_RGBA, 0) < 1e-6 && apart(&moved, &rest, CONIC_PLANE_Z, 0) < 1e-5);
  CHECK(apart(&moved, &rest, CONIC_PLANE_NORMAL, 1) < 1e-6);
  for (int i = 0; i < 2; i++)
    CHECK(conic_image_hash(&moved, exact[i]) == conic_image_hash(&rest, exact[i]));
  CHECK(apart(&moved, &before, CONIC_PLANE_RGBA, 0) > 0.1);
  conic_source_box(source, low, high);
  const conic_source_scale *scale = conic_source_measure(source);
  for (int row = 0; row < 3; row++) {
    double middle = turn[row][3], half = 0.0;
    for (int k = 0; k < 3; k++) {
      middle += 0.5 * turn[row][k] * (scale->minimum[k] + scale->maximum[k]);
      half += 0.5 * fabs(turn[row][k]) * (scale->maximum[k] - scale->minimum[k]);
    }
    CHECK_NEAR(low[row], middle - half, 1e-9);
    CHECK_NEAR(high[row], middle + half, 1e-9);
  }
  poses[1] = poses[0];
  CHECK_OK(conic_source_move(source, poses, 2));
  poses[1].world_from_rest[0][3] += 0.1;
  CHECK(conic_source_move(source, poses, 2) == CONIC_ERROR_UNSUPPORTED);
  poses[0].world_from_rest[0][0] = 1.5; /* sheared */
  CHECK(conic_source_move(source, poses, 1) == CONIC_ERROR_UNSUPPORTED);
  conic_source_pose_init(&poses[0]);
  poses[0].shapes[1] = source;
  CHECK(conic_source_move(source, poses, 1) == CONIC_ERROR_UNSUPPORTED);
  CHECK_OK(conic_source_move(source, NULL, 0));
  conic_image after = draw_final(f, source, NULL);
  CHECK(conic_image_hash(&before, CONIC_PLANE_RGBA) == conic_image_hash(&after, CONIC_PLANE_RGBA));
  conic_image_release(f->context, &before);
  conic_image_release(f->context, &after);
  conic_image_release(f->context, &rest);
  conic_source_close(source);
  return moved;
}

/* The same splats move by themselves in memory. */
static void check_like_drawing(fixture *f, const conic_image *carried, double tolerance) {
  conic_source *source = as_drawing(f);
  conic_source_pose pose;
  conic_source_pose_init(&pose);
  memcpy(pose.world_from_rest, turn, sizeof turn);
  CHECK_OK(conic_source_move(source, &pose, 1));
  conic_image image = draw_final(f, source, NULL);
  const float *a = image.planes[CONIC_PLANE_RGBA], *b = carried->planes[CONIC_PLANE_RGBA];
  size_t n_apart = 0;
  for (size_t i = 0; i < 4 * SIZE * SIZE; i++)
    n_apart += fabs((double)a[i] - (double)b[i]) > tolerance;
  CHECK(n_apart <= 40); /* where a splat begins to hide another */
  conic_image_release(f->context, &image);
  conic_source_close(source);
}

static void test_carried(fixture *f) {
  conic_image image;
  fixture_scene(f, CONIC_SCENE_KNOT, N_SPLATS);
  fixture_camera(f, SIZE, SIZE, 60.0);
  f->camera.cam_from_world[2][3] = 6.0;
  light_scene(&f->options.lighting);
  f->options.shading = CONIC_SHADE_LAMBERT;
  image = check_carried(f, as_octree(f, 0));
  check_like_drawing(f, &image, 1e-4);
  conic_image_release(f->context, &image);
  if (!layers_are_missing()) {
    image = check_carried(f, as_layers(f, NULL));
    check_like_drawing(f, &image, 0.1);
    conic_image_release(f->context, &image);
  }
  image = check_carried(f, as_gaussians(f));
  conic_image_release(f->context, &image);
  f->camera.cam_from_world[2][3] = 2.0;
  image = check_carried(f, as_hybrid(f));
  conic_image_release(f->context, &image);
  conic_render_options_init(&f->options);
}

/* --- transparency --- */

static int count_not(const conic_image *image, double alpha, double tolerance) {
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  int n = 0;
  for (int y = SIZE / 2 - 6; y < SIZE / 2 + 6; y++)
    for (int x = SIZE / 2 - 6; x < SIZE / 2 + 6; x++)
      n += !(fabs((double)rgba[4 * (y * SIZE + x) + 3] - alpha) <= tolerance);
  return n;
}

/* Light passes two shells. */
static void check_shell(fixture *f, conic_source *source, double tolerance) {
  conic_source_view view;
  conic_source_view_init(&view);
  view.transparency = CONIC_TRANSPARENCY_LAYERS;
  view.occlusion = CONIC_OCCLUSION_ON;
  conic_image image = draw_final(f, source, &view);
  CHECK(count_not(&image, 0.51, tolerance) == 0);
  conic_image_release(f->context, &image);
  view.transparency = CONIC_TRANSPARENCY_CHANCE;
  view.chance = 0.999;
  image = draw_final(f, source, &view);
  CHECK(count_not(&image, 1.0, 0.0) > 0);
  conic_image_release(f->context, &image);
  conic_source_close(source);
}

/* What keeps no opacities is drawn as it is without, also where it is coarser. */
static void check_opaque(fixture *f, conic_source *source) {
  conic_source_view view;
  for (int is_coarse = 0; is_coarse < 2; is_coarse++) {
    conic_source_view_init(&view);
    view.error_px = is_coarse ? 4.0 : 0.0;
    conic_image plain = draw_final(f, source, &view);
    view.transparency = CONIC_TRANSPARENCY_LAYERS;
    conic_image image = draw_final(f, source, &view);
    for (int i = 0; i < CONIC_N_PLANES; i++)
      CHECK(!image.planes[i] || conic_image_hash(&image, (conic_plane)i) == conic_image_hash(&plain, (conic_plane)i));
    conic_image_release(f->context, &image);
    conic_image_release(f->context, &plain);
  }
  conic_source_close(source);
}

static void check_refused(fixture *f, conic_source *source, double error_px, conic_status expected) {
  conic_source_view view;
  conic_image image;
  conic_source_view_init(&view);
  view.transparency = CONIC_TRANSPARENCY_LAYERS;
  view.error_px = error_px;
  CHECK_OK(conic_image_allocate(f->context, SIZE, SIZE, ALL_PLANES, &image));
  CHECK(conic_source_draw(source, f->renderer, &f->camera, &f->options, &view, &image, NULL) == expected);
  conic_image_release(f->context, &image);
  conic_source_close(source);
}

static void test_transparent(fixture *f) {
  int has_layers = !layers_are_missing();
  conic_layers_access access;
  conic_source_options opening;
  conic_layers_access_init(&access);
  conic_source_options_init(&opening);
  opening.access = &access;
  access.memory_bytes = 1 << 20;
  fixture_scene(f, CONIC_SCENE_SPHERE, N_SPLATS);
  f->camera.cam_from_world[2][3] = 4.0;
  check_opaque(f, as_octree(f, 0));
  if (has_layers)
    check_opaque(f, as_layers(f, &opening)); /* in windows */
  set_opacity(f, 0.3f);
  check_shell(f, as_octree(f, 0), 1e-6);
  check_shell(f, as_octree(f, 1), 5e-3);
  f->camera.fx = f->camera.fy = 400.0; /* so near that the hind wall could be left out as hidden */
  if (has_layers)
    check_shell(f, as_layers(f, NULL), 5e-5);
  if (has_layers)
    check_refused(f, as_layers(f, &opening), 0.0, CONIC_ERROR_MEMORY);
  check_refused(f, as_octree(f, 0), 4.0, CONIC_ERROR_UNSUPPORTED);
  check_refused(f, as_hybrid(f), 0.0, CONIC_ERROR_UNSUPPORTED);
  check_refused(f, as_gaussians(f), 0.0, CONIC_ERROR_UNSUPPORTED);
  free(f->splats.opacity);
  f->splats.opacity = NULL;
}

/* Of a PLY's vertices, coded as colours are; where all are opaque, there is none. */
static void test_alpha_of_vertices(fixture *f) {
  static const struct {
    const char *type, *values[3];
    float expected[3];
  } files[] = {{"uchar", {"0", "51", "255"}, {0.0f, 0.2f, 1.0f}},
               {"ushort", {"65535", "0", "13107"}, {1.0f, 0.0f, 0.2f}},
               {"float", {"0.25", "1", "0.5"}, {0.25f, 1.0f, 0.5f}},
               {"uchar", {"255", "255", "255"}, {1.0f, 1.0f, 1.0f}}};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    char text[400];
    const char *const *v = files[i].values;
    snprintf(
        text, sizeof text,
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty %s "
        "alpha\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 %s\n1 0 0 %s\n0 1 0 %s\n"
        "3 0 1 2\n",
        files[i].type, v[0], v[1], v[2]);
    const char *path = files_write("final.ply", text);
    for (int keeps_alpha = 0; keeps_alpha < 2; keeps_alpha++) {
      conic_source_options options;
      conic_source_options_init(&options);
      options.as = CONIC_AS_AUTO;
      options.keeps_alpha = keeps_alpha;
      conic_source *source = open_file(f, path, &options);
      CHECK_OK(conic_source_choose(source, &f->camera, &f->options, NULL));
      const float *alpha = conic_source_chosen(source)->drawing.triangles->alpha;
      CHECK((alpha != NULL) == (keeps_alpha && i < 3));
      for (int k = 0; alpha && k < 3; k++)
        CHECK_NEAR((double)alpha[k], (double)files[i].expected[k], 1e-7);
      conic_source_close(source);
    }
  }
  const char *opaque = files_write("opaque.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
                                                 "float y\nproperty float z\nelement face 1\nproperty list uchar int "
                                                 "vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const char *both[2] = {opaque, files_write("final.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                                          "property float y\nproperty float z\nproperty float alpha\n"
                                                          "element face 1\nproperty list uchar int vertex_indices\n"
                                                          "end_header\n0 0 1 0\n1 0 1 0\n0 1 1 0.5\n3 0 1 2\n")};
  conic_source_options options;
  conic_source *source;
  conic_source_options_init(&options);
  options.as = CONIC_AS_AUTO;
  options.keeps_alpha = 1;
  CHECK_OK(conic_source_open(f->context, both, 2, &options, &source));
  CHECK_OK(conic_source_choose(source, &f->camera, &f->options, NULL));
  const float *alpha = conic_source_chosen(source)->drawing.triangles->alpha;
  CHECK(alpha && alpha[0] == 1.0f && alpha[2] == 1.0f && alpha[3] == 0.0f && alpha[5] == 0.5f);
  conic_source_close(source);
  CHECK(unlink(opaque) == 0);
}

int main(void) {
  conic_context *context = files_context();
  fixture f = {.context = context};
  CHECK_OK(conic_renderer_create(context, &f.renderer));
  conic_render_options_init(&f.options);
  test_carried(&f);
  test_transparent(&f);
  test_alpha_of_vertices(&f);
  fixture_close(&f);
  remove(files_path("final.lpc"));
  remove(files_path("final.ply"));
  CHECK(rmdir(files_folder) == 0);
  return check_result();
}
