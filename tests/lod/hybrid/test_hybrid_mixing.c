/* Where both kinds are drawn: over ground that the camera stands on triangles in front and surfels behind, which a
 * cluster that surrounds the eye must not hide; and nodes that stand at once, which may only where they take less than
 * all of their clusters could. */
#include "lod/hybrid/draw/hybrid_offers.h"
#include "tests/support/hybrid_fixture.h"

/* Low over the flat part of the terrain, along it. */
static void stand_on_ground(conic_camera *camera) {
  static const double eye[3] = {0.85, 0.05, 0.1}, rotation[3][3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  memset(camera, 0, sizeof *camera);
  camera->width = camera->height = 256;
  camera->fx = camera->fy = 350.0;
  camera->cx = camera->cy = 128.0;
  for (int row = 0; row < 3; row++)
    for (int axis = 0; axis < 3; axis++) {
      camera->cam_from_world[row][axis] = rotation[row][axis];
      camera->cam_from_world[row][3] -= rotation[row][axis] * eye[axis];
    }
}

static void test_ground(conic_context *context) {
  conic_triangles mesh;
  conic_hybrid *hybrid;
  conic_hybrid_options options;
  conic_render_options render;
  conic_hybrid_view view;
  conic_hybrid_selection selection;
  conic_camera camera;
  memset(&selection, 0, sizeof selection);
  conic_hybrid_options_init(&options);
  conic_render_options_init(&render);
  conic_hybrid_view_init(&view);
  hybrid_terrain(context, 100, &mesh);
  options.most_area = 0.004; /* clusters of some 80 triangles */
  CHECK_OK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL));
  stand_on_ground(&camera);
  view.error_px = 10.0;
  CHECK_OK(conic_hybrid_select(hybrid, &camera, &render, &view, &selection));
  printf("%zu triangles, %zu surfels, %g px\n", selection.triangles.count, selection.splats.count, selection.error_px);
  CHECK(selection.n_clusters[CONIC_HYBRID_TRIANGLES] > 0 && selection.n_clusters[CONIC_HYBRID_SURFELS] > 0);
  CHECK(selection.error_px <= 10.0);
  conic_hybrid_selection_release(context, &selection);
  conic_hybrid_destroy(hybrid);
}

/* A node of a point that would be a pixel wide, of so many clusters, `across` to the side. */
static int stands(const conic_hybrid_camera *view, uint32_t n_clusters, double across, double *saved_ns) {
  conic_hybrid hybrid;
  conic_hybrid_node node;
  conic_hybrid_offer offer;
  memset(&hybrid, 0, sizeof hybrid);
  memset(&node, 0, sizeof node);
  node.bound.center[0] = (float)across;
  node.bound.center[2] = 10.0f;
  node.bound.radius = node.point.radius = node.point.error = 0.01f;
  node.end = n_clusters;
  return conic_hybrid_stands_at_once(&hybrid, view, &node, 2.0, &offer, saved_ns);
}

static void test_at_once(void) {
  conic_hybrid hybrid;
  conic_hybrid_camera view;
  conic_camera camera;
  conic_render_options render;
  double saved_ns = 0.0;
  memset(&hybrid, 0, sizeof hybrid);
  memset(&camera, 0, sizeof camera);
  camera.width = camera.height = 512;
  camera.fx = camera.fy = 700.0;
  camera.cx = camera.cy = 256.0;
  for (int i = 0; i < 3; i++)
    camera.cam_from_world[i][i] = 1.0;
  conic_render_options_init(&render);
  render.near_z = 0.1;
  conic_hybrid_camera_init(&hybrid, &camera, &render, &view);
  CHECK(!stands(&view, 0, 0.0, &saved_ns));
  CHECK(saved_ns <= 0.0);
  CHECK(stands(&view, 4, 0.0, &saved_ns));
  CHECK(saved_ns > 3.0 * CONIC_HYBRID_LEAST_NS && saved_ns < 4.0 * CONIC_HYBRID_LEAST_NS);
  CHECK(!stands(&view, 4, 10.0 * 258.3 / 700.0, &saved_ns)); /* splats reach in from 2.5 pixels */
}

int main(void) {
  conic_context *context = check_context(2);
  test_ground(context);
  test_at_once();
  conic_context_destroy(context);
  return check_result();
}
