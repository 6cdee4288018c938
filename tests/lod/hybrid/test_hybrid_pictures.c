/* Hybrid models are watertight: wherever the mesh itself covers a pixel, so does each way to draw the model of it.
 *   test_hybrid_pictures SOURCE_FOLDER [all]
 * With `all` from 26 directions at three scales (scripts/hybrid-watertight); else a cheap part of that. */
#include "tests/support/hybrid_fixture.h"

typedef struct watching {
  conic_context *context;
  conic_renderer *renderer;
  conic_hybrid *hybrid;
  conic_hybrid_info info;
  conic_triangles mesh;
  conic_hybrid_selection selection;
  conic_render_options options;
  const char *name;
  long n_pictures, n_covered, n_holes, n_deep;
  size_t n_joined; /* clusters for which nodes stood */
} watching;

static void draw(watching *w, const conic_drawing *drawing, const conic_camera *camera, conic_image *image) {
  CHECK_OK(conic_image_allocate(w->context, camera->width, camera->height,
                                1u << CONIC_PLANE_ID | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_RGBA, image));
  CHECK_OK(conic_render_drawing(w->context, w->renderer, drawing, camera, &w->options, 1, image, NULL));
}

/* Whether the mesh covers all pixels up to `reach` away, at depths that hang together. */
static int is_inside(const conic_image *mesh, int x, int y, int reach, double depth) {
  const uint32_t *id = mesh->planes[CONIC_PLANE_ID];
  const float *z = mesh->planes[CONIC_PLANE_Z];
  for (int v = y - reach; v <= y + reach; v++)
    for (int u = x - reach; u <= x + reach; u++) {
      int at = v * mesh->width + u;
      if (u < 0 || v < 0 || u >= mesh->width || v >= mesh->height || id[at] == CONIC_NO_ID ||
          fabs((double)z[at] - (double)z[y * mesh->width + x]) > depth)
        return 0;
    }
  return 1;
}

/* A pixel of the mesh that shows nothing is a hole; where there may be an error, one that lies farther inside of one
 * surface than that (two outlines that meet in the picture may part). One that shows what lies deeper by `depth` is a
 * look inside. */
static void compare(watching *w, const conic_image *mesh, const conic_image *image, int reach, double depth) {
  const uint32_t *found = image->planes[CONIC_PLANE_ID];
  const float *near_z = mesh->planes[CONIC_PLANE_Z], *z = image->planes[CONIC_PLANE_Z];
  for (int i = 0; i < mesh->width * mesh->height; i++) {
    int x = i % mesh->width, y = i / mesh->width;
    if (!is_inside(mesh, x, y, reach, 0.4 * depth))
      continue;
    w->n_covered++;
    w->n_holes += found[i] == CONIC_NO_ID;
    int is_deep = found[i] != CONIC_NO_ID && (double)z[i] > (double)near_z[i] + depth;
    w->n_deep += is_deep && is_inside(mesh, x, y, reach + 1, depth);
  }
  w->n_pictures++;
}

static void watch(watching *w, int direction, const conic_camera *camera, const conic_hybrid_view *view,
                  const conic_image *mesh) {
  conic_image image;
  double square = 0.0;
  for (int axis = 0; axis < 3; axis++)
    square += (w->info.maximum[axis] - w->info.minimum[axis]) * (w->info.maximum[axis] - w->info.minimum[axis]);
  CHECK_OK(conic_hybrid_select(w->hybrid, camera, &w->options, view, &w->selection));
  const conic_drawing drawing = {&w->selection.splats, &w->selection.triangles};
  long before = w->n_holes, deep_before = w->n_deep;
  w->n_joined += w->selection.n_joined;
  draw(w, &drawing, camera, &image);
  compare(w, mesh, &image, (int)ceil(view->error_px), 0.05 * sqrt(square));
  if (w->n_holes > before || w->n_deep > deep_before)
    fprintf(stderr, "%s, %d pixels wide, direction %d, error %g, kind %d: %ld holes, %ld looks inside\n", w->name,
            camera->width, direction, view->error_px, view->only_kind, w->n_holes - before, w->n_deep - deep_before);
  conic_image_release(w->context, &image);
}

/* The largest errors, at which nodes stand for clusters, only in the smallest pictures, if not for all. */
static void watch_direction(watching *w, int direction, int size, int is_all) {
  static const double errors[] = {0.0, 0.5, 1.0, 3.0, 6.0, 16.0};
  size_t n_errors = is_all ? 6 : size > 64 ? 4 : 5;
  conic_camera camera;
  conic_image mesh;
  const conic_drawing drawing = {NULL, &w->mesh};
  hybrid_look(w->context, direction, size, 1.0, w->info.minimum, w->info.maximum, &camera);
  draw(w, &drawing, &camera, &mesh);
  for (size_t i = 0; i < n_errors; i++) {
    conic_hybrid_view view;
    conic_hybrid_view_init(&view);
    view.error_px = errors[i];
    watch(w, direction, &camera, &view, &mesh);
  }
  for (int kind = 0; kind < 2 && is_all; kind++) {
    conic_hybrid_view view;
    conic_hybrid_view_init(&view);
    view.only_kind = kind;
    watch(w, direction, &camera, &view, &mesh);
  }
  conic_image_release(w->context, &mesh);
}

static void watch_mesh(conic_context *context, const char *name, const char *path, int is_all) {
  static const int sizes[] = {64, 192, 512};
  watching w = {.context = context, .name = name};
  conic_hybrid_options options;
  conic_triangles copy;
  conic_hybrid_options_init(&options);
  conic_render_options_init(&w.options);
  w.options.shading = CONIC_SHADE_NONE;
  hybrid_mesh(context, path, is_all ? 315 : 60, &w.mesh);
  hybrid_mesh(context, path, is_all ? 315 : 60, &copy);
  CHECK_OK(conic_renderer_create(context, &w.renderer));
  CHECK_OK(conic_hybrid_build(context, &copy, &options, &w.hybrid, NULL));
  CHECK_OK(conic_hybrid_describe(w.hybrid, &w.info));
  w.options.near_z = w.info.near_z;
  w.options.splat_length = w.info.splat_length;
  for (int direction = 0; direction < HYBRID_DIRECTIONS; direction += is_all ? 1 : 9)
    for (int i = 0; i < (is_all ? 3 : 2); i++)
      watch_direction(&w, direction, sizes[i], is_all);
  fprintf(stderr, "%s: %ld pictures, %ld pixels of the mesh, %ld holes, %ld looks inside\n", name, w.n_pictures,
          w.n_covered, w.n_holes, w.n_deep);
  CHECK(w.n_covered > 1000);
  CHECK(w.n_joined > 0);
  CHECK(w.n_holes == 0);
  CHECK(w.n_deep == 0 || is_all);
  conic_hybrid_selection_release(context, &w.selection);
  conic_hybrid_destroy(w.hybrid);
  conic_renderer_destroy(w.renderer);
  conic_triangles_release(context, &w.mesh);
}

int main(int argc, char **argv) {
  static const char *const names[] = {"cow.obj", "bunny.obj", "fandisk.obj", "spot.obj"};
  const char *source_folder = argc > 1 ? argv[1] : ".";
  int is_all = argc > 2 && strcmp(argv[2], "all") == 0;
  conic_context *context = check_context(2);
  watch_mesh(context, "terrain", NULL, is_all);
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    const char *path = check_data(source_folder, names[i]);
    if (path && (is_all || i != 1))
      watch_mesh(context, names[i], path, is_all);
  }
  conic_context_destroy(context);
  return check_result();
}
