/* Splats and triangles in memory that are joined for an error or a budget: what is stated holds, both ways; a budget is
 * kept; where nothing can be left out, all is drawn as it was; and what a folder keeps is what would be built.
 *
 * test_lean_drawing SOURCES [FILE …] also measures files, and prints what it finds. */
#include "core/base/vectors.h"
#include "lod/mesh/mesh.h"
#include "tests/support/fixture.h"
#include "tests/support/folder.h"
#include "tests/support/sanitized.h"

enum { MADE = 48 };

/* On each of the two that are compared; more of files. */
static int n_places = 100;

typedef struct measuring {
  const conic_camera *camera;
  uint64_t random;
} measuring;

static void corner_at(const conic_triangles *t, size_t i, int corner, double at[3]) {
  for (int axis = 0; axis < 3; axis++)
    at[axis] = t->origin[axis] + (double)t->position[axis][t->corners[i][corner]];
}

/* A place on primitive i, splats first. */
static void place_on(measuring *m, const conic_drawing *d, size_t i, double at[3]) {
  const conic_splats *s = d->splats;
  double a = fixture_random(&m->random), b = fixture_random(&m->random), corner[3][3];
  if (i < s->count) {
    double radius = 1.5 * sqrt(a), x = radius * cos(2.0 * 3.14159265358979 * b);
    double y = radius * sin(2.0 * 3.14159265358979 * b);
    for (int axis = 0; axis < 3; axis++)
      at[axis] = s->origin[axis] + (double)s->position[axis][i] + x * (double)s->tangent_u[axis][i] +
                 y * (double)s->tangent_v[axis][i];
    return;
  }
  for (int k = 0; k < 3; k++)
    corner_at(d->triangles, i - s->count, k, corner[k]);
  if (a + b > 1.0) {
    a = 1.0 - a;
    b = 1.0 - b;
  }
  for (int axis = 0; axis < 3; axis++)
    at[axis] = corner[0][axis] + a * (corner[1][axis] - corner[0][axis]) + b * (corner[2][axis] - corner[0][axis]);
}

/* No more than how far a disc is from a place, by the lesser of two of its points: the one towards the place, and the
 * nearest of its inscribed circle. */
static double distance_to_disc(const conic_splats *s, size_t i, const double at[3], double known) {
  double p[3], u[3], v[3], n[3], apart[3];
  conic_vector_at(s->position, i, p);
  conic_vector_at(s->tangent_u, i, u);
  conic_vector_at(s->tangent_v, i, v);
  for (int axis = 0; axis < 3; axis++)
    apart[axis] = at[axis] - s->origin[axis] - p[axis];
  double uu = conic_dot(u, u), vv = conic_dot(v, v), away = conic_length(apart);
  if (away - 1.5 * sqrt(uu > vv ? uu : vv) > known)
    return known;
  conic_cross(u, v, n);
  if (!conic_normalize(n))
    return known;
  double high = conic_dot(apart, n), flat2 = away * away - high * high, flat = sqrt(flat2 > 0.0 ? flat2 : 0.0);
  double x = conic_dot(apart, u) / uu, y = conic_dot(apart, v) / vv, out = sqrt(x * x + y * y) / 1.5;
  double past = out > 1.0 ? flat * (1.0 - 1.0 / out) : 0.0, round = flat - 1.5 * sqrt(uu < vv ? uu : vv);
  past = round < past ? round > 0.0 ? round : 0.0 : past;
  return sqrt(high * high + past * past);
}

static double distance_to(const conic_drawing *d, const double at[3]) {
  double least = HUGE_VAL;
  for (size_t i = 0; i < d->splats->count; i++) {
    double found = distance_to_disc(d->splats, i, at, least);
    least = found < least ? found : least;
  }
  for (size_t i = 0; i < d->triangles->count; i++) {
    double corner[3][3];
    for (int k = 0; k < 3; k++)
      corner_at(d->triangles, i, k, corner[k]);
    double found = sqrt(conic_distance2_to_triangle(at, corner[0], corner[1], corner[2]));
    least = found < least ? found : least;
  }
  return least;
}

/* The pixels of a length at a place; below 0: it is out of sight. */
static double pixels_at(const conic_camera *camera, const double at[3], double length) {
  double p[3];
  for (int row = 0; row < 3; row++)
    p[row] = conic_dot(camera->cam_from_world[row], at) + camera->cam_from_world[row][3];
  double x = p[0] / p[2] * camera->fx + camera->cx, y = p[1] / p[2] * camera->fy + camera->cy;
  int is_seen = p[2] > 0.0 && x >= 0.0 && y >= 0.0 && x <= camera->width && y <= camera->height;
  return is_seen ? length * camera->fx / p[2] : -1.0;
}

/* How far places of one are from the other, at most, in pixels. */
static double measure(measuring *m, const conic_drawing *of, const conic_drawing *from) {
  const size_t n = of->splats->count + of->triangles->count;
  double most = 0.0;
  for (int k = 0; k < n_places && n; k++) {
    double at[3];
    place_on(m, of, (size_t)(fixture_random(&m->random) * (double)n), at);
    double px = pixels_at(m->camera, at, 1.0);
    px = px > 0.0 ? px * distance_to(from, at) : 0.0;
    most = px > most ? px : most;
  }
  return most;
}

static void fill_camera(const conic_source *source, int size, conic_camera *camera) {
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = framing.height = size;
  CHECK_OK(conic_source_frame(source, &framing, camera));
}

static uint64_t hash_of(fixture *f, conic_source *source, const conic_source_view *view) {
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height,
                                1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_ID, &f->image));
  CHECK_OK(conic_source_draw(source, f->renderer, &f->camera, &f->options, view, &f->image, NULL));
  return conic_image_hash(&f->image, CONIC_PLANE_RGBA) ^ 3 * conic_image_hash(&f->image, CONIC_PLANE_Z) ^
         5 * conic_image_hash(&f->image, CONIC_PLANE_ID);
}

static size_t count_of(const conic_source *source) {
  const conic_drawing *drawing = &conic_source_chosen(source)->drawing;
  return drawing->splats->count + drawing->triangles->count;
}

/* Two sources of one thing: all of it, and what is chosen. */
static void check_errors(fixture *f, const char *name, conic_source *all, conic_source *lean, int is_alone,
                         const int *sizes, int n_sizes) {
  static const double errors[] = {0.5, 1.0, 2.0, 4.0};
  measuring m = {&f->camera, 7};
  for (int k = 0; k < 4 * n_sizes; k++) {
    conic_source_view view;
    conic_source_view_init(&view);
    fill_camera(all, sizes[k / 4], &f->camera);
    CHECK_OK(conic_source_choose(all, &f->camera, &f->options, &view));
    view.error_px = errors[k % 4];
    view.is_alone = is_alone;
    CHECK_OK(conic_source_choose(lean, &f->camera, &f->options, &view));
    const conic_source_choice *chosen = conic_source_chosen(lean), *whole = conic_source_chosen(all);
    double there = measure(&m, &chosen->drawing, &whole->drawing),
           back = measure(&m, &whole->drawing, &chosen->drawing);
    printf("%s %d^2 --error %g%s: %zu of %zu, stated %.3f, measured %.3f and %.3f px\n", name, sizes[k / 4],
           errors[k % 4], is_alone ? ", alone" : "", count_of(lean), count_of(all), chosen->error_px, there, back);
    CHECK(chosen->error_px <= view.error_px && there <= chosen->error_px + 1e-9 && back <= chosen->error_px + 1e-9);
    CHECK(chosen->is_all ? count_of(lean) == count_of(all) : count_of(lean) < count_of(all));
  }
}

/* All is drawn where all is needed, to the bit; a budget is kept, and the picture is the same every time. */
static void check_bounds(fixture *f, conic_source *all, conic_source *lean) {
  conic_source_view view;
  conic_source_view_init(&view);
  fill_camera(all, 64, &f->camera);
  uint64_t whole = hash_of(f, all, &view);
  for (int is_alone = 0; is_alone < 2; is_alone++) {
    view.is_alone = is_alone;
    view.error_px = 1e-7;
    CHECK(hash_of(f, lean, &view) == whole);
    CHECK(conic_source_chosen(lean)->is_all && conic_source_chosen(lean)->error_px == 0.0);
    view.error_px = 3.0;
    uint64_t first = hash_of(f, lean, &view);
    CHECK(first != whole && !conic_source_chosen(lean)->is_all && hash_of(f, lean, &view) == first);
  }
  view.error_px = 0.0;
  view.budget = count_of(all);
  CHECK(hash_of(f, lean, &view) == whole);
  double last_px = 0.0;
  for (view.budget = count_of(all) / 2; view.budget > 60; view.budget /= 3) {
    CHECK_OK(conic_source_choose(lean, &f->camera, &f->options, &view));
    double px = conic_source_chosen(lean)->error_px;
    CHECK(count_of(lean) <= view.budget && px >= last_px);
    last_px = px;
  }
}

/* --- made models --- */

static double bump(double x, double y) {
  return 0.05 * sin(9.0 * x) * cos(7.0 * y);
}

/* A sheet with hills, with a hole; or its vertices as splats. */
static conic_source *make_source(fixture *f, int has_splats, int has_triangles, const conic_source_options *options) {
  conic_splats splats = {0};
  conic_triangles triangles = {0};
  conic_source *source;
  (void)options;
  enum { SIDE = MADE + 1 };
  if (has_splats) {
    fixture_scene(f, CONIC_SCENE_TERRAIN, 6000);
    splats = f->splats;
    memset(&f->splats, 0, sizeof f->splats);
  } else
    CHECK_OK(conic_splats_allocate(f->context, 0, CONIC_SPLATS_TANGENTS, &splats));
  if (has_triangles) {
    size_t n = 0;
    CHECK_OK(conic_triangles_allocate(f->context, 2 * MADE * MADE, SIDE * SIDE, 0, &triangles));
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
      double x = 2.0 * (i % SIDE) / MADE - 1.0, y = 2.0 * (i / SIDE) / MADE - 1.0;
      const double at[3] = {x, 0.8 + bump(x, y), y};
      for (int axis = 0; axis < 3; axis++)
        triangles.position[axis][i] = (float)at[axis];
      if (i % SIDE == MADE || i / SIDE == MADE || (i % SIDE > 20 && i % SIDE < 26 && i / SIDE > 30 && i / SIDE < 40))
        continue;
      const uint32_t both[2][3] = {{i, i + SIDE, i + SIDE + 1}, {i, i + SIDE + 1, i + 1}};
      memcpy(triangles.corners[n], both, sizeof both);
      n += 2;
    }
    triangles.count = n;
  }
  CHECK_OK(conic_source_of_drawing(f->context, &splats, has_triangles ? &triangles : NULL, &source));
  return source;
}

static void check_made(fixture *f) {
  static const int sizes[] = {64, 256};
  static const char *const names[] = {"", "splats", "triangles", "both"};
  for (int what = IS_SANITIZED ? 3 : 1; what < 4; what++) {
    conic_source *all = make_source(f, what & 1, what & 2, NULL), *lean = make_source(f, what & 1, what & 2, NULL);
    for (int is_alone = 0; is_alone < 2; is_alone++)
      check_errors(f, names[what], all, lean, is_alone, sizes, IS_SANITIZED ? 1 : 2);
    check_bounds(f, all, lean);
    conic_source_close(all);
    conic_source_close(lean);
  }
}

/* --- files --- */

static conic_source *open_file(fixture *f, const char *path, const char *cache) {
  conic_source_options options;
  conic_source *source;
  conic_source_options_init(&options);
  options.as = CONIC_AS_AUTO;
  options.finds_dots = 1;
  options.cache = cache;
  return conic_source_open(f->context, &path, 1, &options, &source) == CONIC_OK ? source : NULL;
}

static void check_file(fixture *f, const char *path) {
  static const int sizes[] = {64, 256, 640};
  conic_source *all = open_file(f, path, NULL), *lean = open_file(f, path, NULL);
  CHECK(all && lean);
  const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
  for (int is_alone = 0; is_alone < 2 && all && lean; is_alone++)
    check_errors(f, name, all, lean, is_alone, sizes, 3);
  conic_source_close(all);
  conic_source_close(lean);
}

/* What is read from the folder draws what was built; what is spoiled there is built again; and where nothing can be
 * written, as a folder has the file's name, the picture is drawn all the same. */
static void check_cache(fixture *f, const char *path) {
  char folder[FOLDER_ROOM], cache[FOLDER_ROOM + 16], command[3 * FOLDER_ROOM + 96];
  conic_source_view view;
  uint64_t hashes[5];
  folder_make(folder);
  snprintf(cache, sizeof cache, "%s/cache", folder);
  conic_source_view_init(&view);
  view.error_px = 2.0;
  for (int i = 0; i < 5; i++) {
    conic_source *source = open_file(f, path, i ? cache : NULL);
    fill_camera(source, 64, &f->camera);
    hashes[i] = hash_of(f, source, &view);
    CHECK(hashes[i] == hashes[0] && !conic_source_chosen(source)->is_all);
    conic_source_close(source);
    snprintf(command, sizeof command, "test $(ls -d %s/*.chy 2> %s/log | wc -l) = %d", cache, folder, i > 0);
    CHECK(system(command) == 0);
    snprintf(command, sizeof command, "for f in %s/*.chy; do truncate -s 1000 $f; done", cache);
    CHECK(i != 2 || system(command) == 0);
    snprintf(command, sizeof command, "for f in %s/*.chy; do rm $f && mkdir $f; done", cache);
    CHECK(i != 3 || system(command) == 0);
  }
  snprintf(command, sizeof command, "rm -r %s", folder);
  CHECK(system(command) == 0);
}

int main(int argc, char **argv) {
  fixture f = fixture_open(2);
  if (argc > 2) {
    n_places = 250;
    for (int i = 2; i < argc; i++)
      check_file(&f, argv[i]);
  } else {
    const char *path = check_data(argc > 1 ? argv[1] : ".", "spot.obj");
    check_made(&f);
    if (path)
      check_cache(&f, path);
  }
  fixture_close(&f);
  return check_result();
}
