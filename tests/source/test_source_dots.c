/* Dots in a source: each picture sees them round, whichever way their axes lie and whatever was drawn before. */
#include "conic/octree.h"
#include "core/splats/columns.h"
#include "tests/support/cloud_fixture.h"
#include "tests/support/files.h"
#include "tests/support/fixture.h"
#include "tests/support/random_numbers.h"

enum { SIZE = 64, N = 3 };

/* Half way between two dots at the ends of the x axis, an ellipse; all lie in the plane across x, which the first
 * camera sees edge-on. */
static conic_source *make_source(fixture *f, int has_dots) {
  static const double v[3] = {0, 0.1, 0}, w[3] = {0, 0, 0.1};
  conic_splats splats;
  conic_source *source;
  unsigned fields = CONIC_SPLATS_TANGENTS | (has_dots ? CONIC_SPLATS_DOTS : 0);
  CHECK_OK(conic_splats_allocate(f->context, N, fields, &splats));
  for (int i = 0; i < N; i++) {
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = axis == 0 ? (float)i - 1 : 0;
      splats.tangent_u[axis][i] = (float)v[axis];
      splats.tangent_v[axis][i] = (float)w[axis];
    }
    if (has_dots)
      splats.dot[i] = i != 1;
  }
  CHECK_OK(conic_source_of_drawing(f->context, &splats, NULL, &source));
  return source;
}

static void frame(fixture *f, conic_source *source, double azimuth_deg) {
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = framing.height = SIZE;
  framing.azimuth_deg = azimuth_deg;
  framing.elevation_deg = 0;
  CHECK_OK(conic_source_frame(source, &framing, &f->camera));
}

static uint64_t draw(fixture *f, conic_source *source, double azimuth_deg) {
  frame(f, source, azimuth_deg);
  if (!f->image.width)
    CHECK_OK(conic_image_allocate(f->context, SIZE, SIZE, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ID, &f->image));
  CHECK_OK(conic_source_draw(source, f->renderer, &f->camera, &f->options, NULL, &f->image, &f->statistics));
  return conic_image_hash(&f->image, CONIC_PLANE_RGBA);
}

/* Pixels of a splat, and the width and height of their box. */
static int measure(const fixture *f, uint32_t splat, int *width, int *height) {
  const uint32_t *ids = f->image.planes[CONIC_PLANE_ID];
  int n = 0, low[2] = {SIZE, SIZE}, high[2] = {-1, -1};
  for (int y = 0; y < SIZE; y++)
    for (int x = 0; x < SIZE; x++)
      if (ids[y * SIZE + x] == splat) {
        n++;
        low[0] = x < low[0] ? x : low[0];
        low[1] = y < low[1] ? y : low[1];
        high[0] = x > high[0] ? x : high[0];
        high[1] = y > high[1] ? y : high[1];
      }
  *width = high[0] - low[0] + 1;
  *height = high[1] - low[1] + 1;
  return n;
}

static void check_round(const fixture *f, uint32_t splat) {
  int width, height, n = measure(f, splat, &width, &height);
  fprintf(stderr, "dot %u: %d pixels in %d x %d\n", splat, n, width, height);
  CHECK(n > 30 && abs(width - height) <= 1);
  CHECK_NEAR((double)n, 3.1416 / 4 * width * height, 0.2 * width * height);
}

static void check_pictures(fixture *f) {
  conic_source *with = make_source(f, 1), *without = make_source(f, 0);
  int width, height;
  const conic_source_scale *scale = conic_source_measure(with);
  CHECK(scale->splat_length == conic_source_measure(without)->splat_length);
  uint64_t first = draw(f, with, 0);
  check_round(f, 0);
  check_round(f, 2);
  CHECK(measure(f, 1, &width, &height) < 30); /* edge-on */
  uint64_t aside = draw(f, with, 50);
  check_round(f, 2);
  CHECK(aside != first && draw(f, with, 0) == first);
  CHECK(draw(f, without, 0) != first);
  CHECK(measure(f, 0, &width, &height) < 30);
  CHECK(conic_source_chosen(with)->is_all && conic_source_chosen(without)->is_all);
  conic_source_close(with);
  conic_source_close(without);
}

/* A cloud of points about which there is no surface, in a file. */
static void check_files(fixture *f) {
  const char *const path = "ball.xyz";
  conic_source_options options;
  conic_source *source;
  uint64_t state = 1;
  FILE *file = fopen(path, "w");
  for (int i = 0; i < 2000; i++)
    fprintf(file, "%g %g %g\n", random_unit(&state), random_unit(&state), random_unit(&state));
  fclose(file);
  conic_source_options_init(&options);
  CHECK(!options.finds_dots);
  for (int k = 0; k < 3; k++) {
    size_t n_dots = 0;
    options.finds_dots = k > 0;
    options.as = k == 2 ? CONIC_AS_PATCHES : CONIC_AS_POINTS;
    CHECK_OK(conic_source_open(f->context, &path, 1, &options, &source));
    draw(f, source, 30);
    if (k < 2)
      n_dots = conic_splats_count_dots(conic_source_chosen(source)->drawing.splats);
    CHECK(k == 1 ? n_dots > 1900 : n_dots == 0);
    conic_source_close(source);
  }
}

/* An octree draws the dots of its splats as they draw them themselves: all of them, or leaf by leaf. */
static void check_octree(fixture *f) {
  conic_splats cloud, copy = {0}, faced;
  conic_octree *octree;
  conic_source *source, *plain;
  conic_source_view view;
  conic_octree_options options;
  size_t n_dots = 0;
  conic_octree_options_init(&options);
  cloud_fixture(f->context, 300, 200, 0, &cloud);
  memcpy(copy.origin, cloud.origin, sizeof copy.origin);
  CHECK_OK(conic_splats_append(f->context, &copy, &cloud));
  CHECK_OK(conic_splats_allocate(f->context, cloud.count, CONIC_SPLATS_TANGENTS, &faced));
  CHECK_OK(conic_octree_build(f->context, &copy, &options, &octree));
  CHECK_OK(conic_source_of_octree(f->context, octree, &source));
  conic_source_view_init(&view);
  view.error_px = 1e-9;
  for (int k = 0; k < 2; k++) {
    frame(f, source, 70.0 * k);
    CHECK_OK(conic_splats_face(f->context, &cloud, &f->camera, faced.tangent_u, faced.tangent_v));
    CHECK_OK(conic_source_choose(source, &f->camera, &f->options, &view));
    const conic_source_choice *choice = conic_source_chosen(source);
    for (size_t i = 0; i < choice->drawing.splats->count; i++) {
      uint32_t id = choice->ids[i];
      CHECK(id < cloud.count);
      for (int axis = 0; axis < 3 && cloud.dot[id] != 0.0f; axis++)
        CHECK(choice->drawing.splats->tangent_v[axis][i] == faced.tangent_v[axis][id]);
      n_dots += cloud.dot[id] != 0.0f;
    }
  }
  CHECK(n_dots > 100);
  CHECK_OK(conic_source_of_drawing(f->context, &cloud, NULL, &plain));
  for (int k = 0; k < 3; k++)
    CHECK(draw(f, source, 70.0 * k) == draw(f, plain, 70.0 * k));
  conic_source_close(source);
  conic_source_close(plain);
  conic_splats_release(f->context, &faced);
}

int main(void) {
  fixture f = fixture_open(2);
  check_pictures(&f);
  check_files(&f);
  check_octree(&f);
  fixture_close(&f);
  return check_result();
}
