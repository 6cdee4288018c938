/* What --error draws of models in the shared data is the fewest: no budget, found by halving, has fewer primitives at a
 * smaller error. What is stated holds where triangles and the mesh are measured, and choosing takes at most a fifth of
 * a picture. */
#include "core/base/clock.h"
#include "core/base/vectors.h"
#include "lod/clusters/cluster_seen.h"
#include "lod/mesh/face_tree.h"
#include "tests/support/hybrid_fixture.h"

/* Fewer under a sanitizer. */
#ifdef __SANITIZE_ADDRESS__
enum { N_MODELS = 1 };
#else
enum { N_MODELS = 4 };
#endif

enum { PLACES = 2000, TIMES = 7 };

static const char *const names[] = {"spot.obj", "cow.obj", "fandisk.obj", "bunny.obj"};
static const int sizes[] = {32, 64, 256, 640};
static const double errors_px[] = {0.5, 1.0, 2.0, 4.0};

/* Triangles in boxes. */
typedef struct measured_surface {
  conic_mesh faces;
  conic_adjacency adjacency;
  conic_face_tree tree;
} measured_surface;

typedef struct looking {
  conic_context *context;
  conic_renderer *renderer;
  const char *name;
  int size;
  conic_triangles mesh;
  measured_surface whole; /* the mesh */
  conic_hybrid *hybrid;
  conic_camera camera;
  conic_render_options render;
  conic_hybrid_selection selection;
} looking;

static void open_surface(conic_context *context, const conic_triangles *triangles, measured_surface *s) {
  memset(s, 0, sizeof *s);
  s->faces = (conic_mesh){.n_vertices = triangles->n_vertices, .n_faces = triangles->count};
  s->faces.faces = (const uint32_t(*)[3])triangles->corners;
  for (int axis = 0; axis < 3; axis++)
    s->faces.position[axis] = triangles->position[axis];
  CHECK_OK(conic_adjacency_find(context, &s->faces, &s->adjacency));
  CHECK_OK(conic_face_tree_build(context, &s->faces, &s->adjacency, &s->tree));
}

static void close_surface(conic_context *context, measured_surface *s) {
  conic_face_tree_release(context, &s->tree);
  conic_adjacency_release(context, &s->adjacency);
}

static size_t n_selected(const looking *l) {
  return l->selection.splats.count + l->selection.triangles.count;
}

static conic_status look_with(looking *l, double error_px, uint64_t budget) {
  conic_hybrid_view view;
  conic_hybrid_view_init(&view);
  view.error_px = error_px;
  view.budget = budget;
  return conic_hybrid_select(l->hybrid, &l->camera, &l->render, &view, &l->selection);
}

/* Halves budgets below what the error took, down to the fewest of which that error can be had. */
static void check_budgets(looking *l, double error_px) {
  CHECK_OK(look_with(l, error_px, 0));
  size_t n = n_selected(l), low = 0, high = n;
  double stated_px = l->selection.error_px;
  CHECK(n > 0 && stated_px <= error_px && l->selection.color_error <= CONIC_JUST_VISIBLE);
  for (size_t budget = n - 1; budget > low; budget = low + (high - low) / 2) {
    int is_found = look_with(l, 0.0, budget) == CONIC_OK;
    int is_better = is_found && l->selection.error_px < stated_px && l->selection.color_error <= CONIC_JUST_VISIBLE;
    if (is_better)
      fprintf(stderr, "%s at %d, %.1f px: %zu of %g px, and %zu of %g px can be had\n", l->name, l->size, error_px, n,
              stated_px, n_selected(l), l->selection.error_px);
    CHECK(!is_better);
    *(is_better ? &high : &low) = budget;
  }
}

/* How far some places of one surface are from the other, at most, in pixels of where they are: the middles of faces and
 * of an edge, and a corner. Places count from the origins of both. */
static double off_px(const looking *l, const conic_triangles *from, const conic_triangles *to,
                     const conic_face_tree *tree) {
  double most_px = 0.0;
  for (size_t i = 0; i < from->count; i += 1 + from->count / PLACES)
    for (int k = 0; k < 3; k++) {
      static const double weights[3][3] = {{1.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}};
      double at[3] = {0.0, 0.0, 0.0}, seen[3];
      for (int corner = 0; corner < 3; corner++)
        for (int axis = 0; axis < 3; axis++)
          at[axis] += weights[k][corner] * (double)from->position[axis][from->corners[i][corner]];
      for (int row = 0; row < 3; row++) {
        const double *m = l->camera.cam_from_world[row];
        seen[row] = m[3];
        for (int axis = 0; axis < 3; axis++)
          seen[row] += m[axis] * (at[axis] + from->origin[axis]);
      }
      for (int axis = 0; axis < 3; axis++)
        at[axis] += from->origin[axis] - to->origin[axis];
      double unit = seen[2] * seen[2] / (l->camera.fx * conic_length(seen));
      most_px = conic_face_tree_farther(tree, at, most_px * unit) / unit;
    }
  return most_px;
}

/* All of the model is in sight. Where there are surfels too, only triangles are measured. */
static void check_places(looking *l) {
  const conic_triangles *drawn = &l->selection.triangles;
  double stated = l->selection.error_px * (1.0 + 1e-4), off = off_px(l, drawn, &l->mesh, &l->whole.tree);
  CHECK(off <= stated);
  if (l->selection.splats.count > 0)
    return;
  measured_surface s;
  open_surface(l->context, drawn, &s);
  double back = off_px(l, &l->mesh, drawn, &s.tree);
  close_surface(l->context, &s);
  fprintf(stderr, "  %.3f px stated, %.3f and %.3f measured\n", stated, off, back);
  CHECK(back <= stated);
}

/* The least of some runs: of choosing and copying, and with drawing. */
static void measure_times(looking *l, double error_px, double seconds[2]) {
  conic_image image;
  CHECK_OK(conic_image_allocate(l->context, l->camera.width, l->camera.height,
                                1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z, &image));
  seconds[0] = seconds[1] = HUGE_VAL;
  for (int i = 0; i < TIMES; i++) {
    double start = conic_seconds_now();
    CHECK_OK(look_with(l, error_px, 0));
    double chosen = conic_seconds_now();
    const conic_drawing drawing = {&l->selection.splats, &l->selection.triangles};
    CHECK_OK(conic_render_drawing(l->context, l->renderer, &drawing, &l->camera, &l->render, 1, &image, NULL));
    seconds[0] = fmin(seconds[0], chosen - start);
    seconds[1] = fmin(seconds[1], conic_seconds_now() - start);
  }
  conic_image_release(l->context, &image);
}

static void check_model(looking *l) {
  conic_hybrid_info info;
  double share = 0.0, all[2] = {0.0, 0.0};
  CHECK_OK(conic_hybrid_describe(l->hybrid, &info));
  l->render.near_z = info.near_z;
  l->render.splat_length = info.splat_length;
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    l->size = sizes[i];
    hybrid_look(l->context, 17, sizes[i], 1.0, info.minimum, info.maximum, &l->camera);
    for (size_t k = 0; k < sizeof errors_px / sizeof *errors_px; k++) {
      double seconds[2];
      check_budgets(l, errors_px[k]);
      measure_times(l, errors_px[k], seconds);
      fprintf(stderr, "%s %d %.1f px: %zu + %zu, choosing %.0f of %.0f us\n", l->name, sizes[i], errors_px[k],
              l->selection.triangles.count, l->selection.splats.count, 1e6 * seconds[0], 1e6 * seconds[1]);
      check_places(l);
      share = fmax(share, seconds[0] / seconds[1]);
      all[0] += seconds[0];
      all[1] += seconds[1];
    }
  }
  fprintf(stderr, "%s: choosing takes %.2f of a picture, at most %.2f\n", l->name, all[0] / all[1], share);
  CHECK(all[0] <= 0.2 * all[1]);
}

int main(int argc, char **argv) {
  looking l = {.context = check_context(1)};
  conic_hybrid_options options;
  conic_hybrid_options_init(&options);
  conic_render_options_init(&l.render);
  CHECK_OK(conic_renderer_create(l.context, &l.renderer));
  for (size_t i = 0; i < N_MODELS; i++) {
    const char *path = check_data(argc > 1 ? argv[1] : ".", names[i]);
    conic_triangles taken;
    if (!path)
      continue;
    l.name = names[i];
    CHECK_OK(conic_triangles_read(l.context, path, &l.mesh));
    CHECK_OK(conic_triangles_read(l.context, path, &taken));
    open_surface(l.context, &l.mesh, &l.whole);
    CHECK_OK(conic_hybrid_build(l.context, &taken, &options, &l.hybrid, NULL));
    check_model(&l);
    conic_hybrid_selection_release(l.context, &l.selection);
    conic_hybrid_destroy(l.hybrid);
    close_surface(l.context, &l.whole);
    conic_triangles_release(l.context, &l.mesh);
  }
  conic_renderer_destroy(l.renderer);
  conic_context_destroy(l.context);
  return check_result();
}
