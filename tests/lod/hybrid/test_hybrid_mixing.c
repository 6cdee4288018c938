/* Where both kinds are drawn: over ground that the camera stands on triangles in front and surfels behind, which a
 * cluster that surrounds the eye must not hide. */
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

int main(void) {
  conic_context *context = check_context(2);
  test_ground(context);
  conic_context_destroy(context);
  return check_result();
}
