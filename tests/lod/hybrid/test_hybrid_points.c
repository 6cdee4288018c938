/* Hybrid models of splats: the same for every number of threads, sound, without a hole that the splats have not; and
 * what stays a splat is drawn as it was. */
#include "lod/hybrid/model/hybrid_layout.h"
#include "tests/support/cloud_fixture.h"
#include "tests/support/files.h"
#include "tests/support/hybrid_fixture.h"

enum { SIZE = 160 };

static conic_hybrid *build(conic_context *context, size_t n_leaves, size_t n_dots, conic_hybrid_report *report) {
  conic_hybrid_options options;
  conic_splats cloud;
  conic_hybrid *hybrid;
  cloud_fixture(context, n_leaves, n_dots, 1, &cloud);
  conic_hybrid_options_init(&options);
  CHECK_OK(conic_hybrid_build_points(context, &cloud, &options, &hybrid, report));
  CHECK(cloud.count == 0 && !cloud.position[0]);
  return hybrid;
}

static void draw(conic_context *context, const conic_splats *splats, const conic_triangles *triangles,
                 const conic_camera *camera, conic_image *image) {
  conic_render_options options;
  conic_renderer *renderer;
  const conic_drawing drawing = {splats, triangles};
  conic_render_options_init(&options);
  CHECK_OK(conic_image_allocate(context, SIZE, SIZE, CONIC_DRAWN_PLANES, image));
  CHECK_OK(conic_renderer_create(context, &renderer));
  CHECK_OK(conic_render_drawing(context, renderer, &drawing, camera, &options, 1, image, NULL));
  conic_renderer_destroy(renderer);
}

/* The cloud with its dots turned to the camera. */
static void draw_cloud(conic_context *context, size_t n_leaves, size_t n_dots, const conic_camera *camera,
                       conic_image *image) {
  conic_splats cloud;
  cloud_fixture(context, n_leaves, n_dots, 1, &cloud);
  CHECK_OK(conic_splats_face(context, &cloud, camera, cloud.tangent_u, cloud.tangent_v));
  draw(context, &cloud, NULL, camera, image);
  conic_splats_release(context, &cloud);
}

static void draw_hybrid(conic_context *context, const conic_hybrid *hybrid, double error_px, const conic_camera *camera,
                        conic_image *image) {
  conic_hybrid_selection selection;
  conic_render_options options;
  conic_hybrid_view view;
  memset(&selection, 0, sizeof selection);
  conic_render_options_init(&options);
  conic_hybrid_view_init(&view);
  view.error_px = error_px;
  CHECK_OK(conic_hybrid_select(hybrid, camera, &options, &view, &selection));
  draw(context, &selection.splats, &selection.triangles, camera, image);
  conic_hybrid_selection_release(context, &selection);
}

/* Whether the image covers all pixels so near to a place. */
static int covers(const conic_image *image, int x, int y, int margin) {
  const uint32_t *id = image->planes[CONIC_PLANE_ID];
  for (int j = y - margin; j <= y + margin; j++)
    for (int i = x - margin; i <= x + margin; i++)
      if (i < 0 || j < 0 || i >= SIZE || j >= SIZE || id[j * SIZE + i] == CONIC_NO_ID)
        return 0;
  return 1;
}

/* Outlines may move by the error; the prefilter alone widens splats by 1.5 pixels, and triangles by none. */
static void test_holes(conic_context *context, const conic_hybrid *hybrid, size_t n_leaves, size_t n_dots) {
  static const double errors_px[] = {0.0, 1.0, 3.0};
  conic_hybrid_info info;
  size_t n_covered = 0, n_holes = 0;
  CHECK_OK(conic_hybrid_describe(hybrid, &info));
  for (int direction = 0; direction < HYBRID_DIRECTIONS; direction += 3)
    for (size_t k = 0; k < 3; k++) {
      conic_camera camera;
      conic_image before, after;
      hybrid_look(context, direction, SIZE, 1.0, info.minimum, info.maximum, &camera);
      draw_cloud(context, n_leaves, n_dots, &camera, &before);
      draw_hybrid(context, hybrid, errors_px[k], &camera, &after);
      for (int i = 0; i < SIZE * SIZE; i++)
        if (covers(&before, i % SIZE, i / SIZE, 2 + (int)errors_px[k])) {
          n_covered++;
          n_holes += !covers(&after, i % SIZE, i / SIZE, 0);
        }
      conic_image_release(context, &before);
      conic_image_release(context, &after);
    }
  CHECK(n_covered > 60000);
  CHECK(n_holes == 0);
}

/* Leaves and dots alone are what they were, in another order. */
static void test_kept(conic_context *context) {
  conic_hybrid_report report;
  conic_hybrid_info info;
  conic_camera camera;
  conic_image before, after;
  conic_splats cloud, leaves;
  conic_hybrid *hybrid;
  conic_hybrid_options options;
  conic_hybrid_options_init(&options);
  cloud_fixture(context, 400, 200, 0, &cloud);
  CHECK_OK(
      conic_splats_allocate(context, 600, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_DOTS, &leaves));
  for (int axis = 0; axis < 3; axis++) {
    memcpy(leaves.position[axis], cloud.position[axis] + CLOUD_GROUND, 600 * sizeof(float));
    memcpy(leaves.tangent_u[axis], cloud.tangent_u[axis] + CLOUD_GROUND, 600 * sizeof(float));
    memcpy(leaves.tangent_v[axis], cloud.tangent_v[axis] + CLOUD_GROUND, 600 * sizeof(float));
    memcpy(leaves.color[axis], cloud.color[axis] + CLOUD_GROUND, 600 * sizeof(float));
  }
  memcpy(leaves.dot, cloud.dot + CLOUD_GROUND, 600 * sizeof(float));
  conic_splats_release(context, &cloud);
  CHECK_OK(conic_splats_append(context, &cloud, &leaves));
  CHECK_OK(conic_hybrid_build_points(context, &leaves, &options, &hybrid, &report));
  CHECK(report.n_points == 600 && report.n_kept == 600 && report.n_faces == 0);
  CHECK_OK(conic_hybrid_describe(hybrid, &info));
  CHECK(info.n_triangles == 0 && info.n_surfels == 600 && info.n_vertices == 0);
  hybrid_look(context, 3, SIZE, 1.0, info.minimum, info.maximum, &camera);
  CHECK_OK(conic_splats_face(context, &cloud, &camera, cloud.tangent_u, cloud.tangent_v));
  draw(context, &cloud, NULL, &camera, &before);
  draw_hybrid(context, hybrid, 0.0, &camera, &after);
  const float *a = before.planes[CONIC_PLANE_RGBA], *b = after.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < (size_t)4 * SIZE * SIZE; i++)
    CHECK(fabsf(a[i] - b[i]) <= 1e-5f);
  conic_image_release(context, &before);
  conic_image_release(context, &after);
  conic_hybrid_destroy(hybrid);
  conic_splats_release(context, &cloud);
}

static void test_refused(conic_context *context) {
  conic_splats none;
  conic_hybrid *hybrid;
  conic_hybrid_options options;
  conic_hybrid_options_init(&options);
  CHECK_OK(conic_splats_allocate(context, 2, 0, &none));
  memset(none.position[0], 0, 2 * sizeof(float));
  CHECK(conic_hybrid_build_points(context, &none, &options, &hybrid, NULL) == CONIC_ERROR_ARGUMENT && !hybrid);
  CHECK(none.count == 0);
  CHECK_OK(conic_splats_allocate(context, 2, CONIC_SPLATS_TANGENTS, &none));
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < 2; i++)
      none.position[axis][i] = none.tangent_u[axis][i] = none.tangent_v[axis][i] = 0.0f; /* spans no plane */
  CHECK(conic_hybrid_build_points(context, &none, &options, &hybrid, NULL) == CONIC_ERROR_INPUT && !hybrid);
}

int main(void) {
  conic_context *context = check_context(2), *other = files_context();
  conic_hybrid_report report;
  conic_hybrid_defects defects, no_defects;
  conic_hybrid_info info;
  conic_hybrid *hybrid = build(context, 300, 100, &report), *again = build(other, 300, 100, NULL), *read;
  memset(&no_defects, 0, sizeof no_defects);
  CHECK_OK(conic_hybrid_describe(hybrid, &info));
  CHECK(info.n_bytes == conic_hybrid_file_bytes(again) && report.n_kept >= 400 && report.n_kept < 900);
  CHECK(info.n_triangles > 3000 && info.n_surfels >= report.n_kept);
  CHECK_OK(conic_hybrid_check(hybrid, &defects));
  CHECK(memcmp(&defects, &no_defects, sizeof defects) == 0);
  test_holes(context, hybrid, 300, 100);
  const char *path = files_path("points.chy");
  CHECK_OK(conic_hybrid_write(hybrid, path));
  CHECK_OK(conic_hybrid_read(context, path, &read));
  CHECK(read->n_surfels == hybrid->n_surfels && read->n_triangles == hybrid->n_triangles);
  CHECK(memcmp(read->mapping.bytes + CONIC_FILE_HEADER_BYTES, (const char *)again->owned + CONIC_FILE_HEADER_BYTES,
               info.n_bytes - CONIC_FILE_HEADER_BYTES) == 0);
  conic_hybrid_destroy(read);
  CHECK(remove(path) == 0);
  conic_hybrid_destroy(again);
  conic_hybrid_destroy(hybrid);
  test_kept(context);
  test_refused(context);
  files_end(other);
  conic_context_destroy(context);
  return check_result();
}
