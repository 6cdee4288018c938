/* From frame to frame: how much a pixel may change when the camera pans by a fraction of a pixel, or slowly moves in. A
 * picture that flickers changes by as much however small the step is; one that does not changes less and less
 * (docs/reference/accuracy.md). */
#define STABILITY_ONE_OF 1 /* the unstable pixels of a zoom are near the limit, so that all count */
#include "tests/support/stability.h"

typedef void set_frame(fixture *f, double t);

/* How pixels changed over a run of frames, of one frame to the next. */
typedef struct run {
  double surface; /* the largest change of colour inside a surface: no edge within two pixels, before or after */
  double edges;   /* the share of the pixels, near edges, that changed by more */
  double flips;   /* the share of the pixels that appeared or vanished */
} run;

/* Whether all within two pixels is covered and belongs to one surface: no step in depth of more than a part in
 * twenty from a pixel to the next. */
static int is_inside(const conic_image *image, int x, int y) {
  const float *z = image->planes[CONIC_PLANE_Z];
  if (x < 2 || y < 2 || x >= image->width - 2 || y >= image->height - 2)
    return 0;
  for (int j = y - 2; j <= y + 2; j++)
    for (int i = x - 2; i <= x + 2; i++) {
      float here = z[j * image->width + i], left = z[j * image->width + (i > x - 2 ? i - 1 : i)],
            above = z[(j > y - 2 ? j - 1 : j) * image->width + i];
      if (here <= 0.0f || fabsf(here - left) > 0.05f * here || fabsf(here - above) > 0.05f * here)
        return 0;
    }
  return 1;
}

static double change_at(const conic_image *a, const conic_image *b, int i) {
  const float *p = (const float *)a->planes[CONIC_PLANE_RGBA] + 4 * i;
  const float *q = (const float *)b->planes[CONIC_PLANE_RGBA] + 4 * i;
  double change = 0.0;
  for (int c = 0; c < 3; c++)
    change = fmax(change, fabs((double)p[c] - (double)q[c]));
  return change;
}

static void add_step(const conic_image *a, const conic_image *b, double most, run *r) {
  int n_covered = 0, n_edges = 0, n_flips = 0;
  for (int y = 0; y < a->height; y++)
    for (int x = 0; x < a->width; x++) {
      int in_a = stability_covers(a, x, y), in_b = stability_covers(b, x, y);
      n_covered += in_a || in_b;
      n_flips += in_a != in_b;
      if (!in_a || !in_b)
        continue;
      double change = change_at(a, b, y * a->width + x);
      if (is_inside(a, x, y) && is_inside(b, x, y))
        r->surface = fmax(r->surface, change);
      else
        n_edges += change > most;
    }
  r->edges = fmax(r->edges, (double)n_edges / n_covered);
  r->flips = fmax(r->flips, (double)n_flips / n_covered);
}

/* Where not null, splats are drawn as patches: the samples of each frame. */
static conic_patches *patches;

static conic_image draw_frame(fixture *f) {
  conic_patch_selection selection;
  conic_splats own = f->splats;
  if (!patches)
    return stability_draw(f);
  CHECK_OK(conic_patches_select(patches, &f->camera, &f->options, &selection));
  f->splats = selection.splats;
  conic_image image = stability_draw(f);
  f->splats = own;
  return image;
}

static run play(fixture *f, set_frame *set, int n_frames, double step, double most) {
  run r = {0};
  conic_image last = {0};
  for (int i = 0; i < n_frames; i++) {
    set(f, i * step);
    conic_image image = draw_frame(f);
    if (i)
      add_step(&last, &image, most, &r);
    conic_image_release(f->context, &last);
    last = image;
  }
  conic_image_release(f->context, &last);
  return r;
}

static void check_frames(fixture *f, const char *name, const char *method, set_frame *set, int n_frames, double step,
                         run most) {
  run r = play(f, set, n_frames, step, most.surface);
  printf("%-34s %-7s step %-8.3g surfaces change by %.4f, more so %.3f %% at edges, coverage %.3f %%\n", name, method,
         step, r.surface, 100.0 * r.edges, 100.0 * r.flips);
  CHECK(r.surface <= most.surface);
  CHECK(r.edges <= most.edges);
  CHECK(r.flips <= most.flips);
  CHECK(r.surface > 0.0);
}

/* No frame may do more than `most` says, whatever the method. */
static void check_run(fixture *f, const char *name, set_frame *set, int n_frames, double step, run most) {
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    if (!stability_fills(method))
      continue;
    f->options.method = (conic_method)method;
    check_frames(f, name, conic_method_name((conic_method)method), set, n_frames, step, most);
  }
}

static void options_of(fixture *f, int width, int height, double focal_px) {
  conic_render_options_init(&f->options);
  fixture_camera(f, width, height, focal_px);
}

/* Pans by t pixels: the whole picture moves. */
static void pan(fixture *f, double t) {
  f->camera.cx = 64.0 + t;
  f->camera.cy = 48.0 + 0.37 * t;
}

/* A splat that comes in at its cutoff brings e^(-9/8) of its peak at once: with discs of 1.5 spacings, some 7 % of a
 * pixel's weight. That is what is left however small the step; with a cutoff of 3, where a splat begins at e^(-9/2), it
 * is a tenth of it. */
static void test_pans(fixture *f) {
  const double eye[3] = {1.2, 0.9, 2.0}, forward[3] = {-1.2, -0.9, -2.0};
  options_of(f, 128, 96, 110.0);
  fixture_scene(f, CONIC_SCENE_SPHERE, 6000);
  stability_look(f, eye, forward, 0.0);
  check_run(f, "a sphere, panned", pan, 17, 1.0 / 16, (run){0.1, 0.001, 0.005});
  check_run(f, "a sphere, panned", pan, 17, 1.0 / 256, (run){0.08, 0.0005, 0.001});
  f->options.kernel.cutoff = 3.0f;
  check_run(f, "a sphere, panned, cutoff 3", pan, 17, 1.0 / 256, (run){0.01, 0.002, 0.001});
  stability_sheet floor = stability_floor(0.4, 0.0, 3.0, 120);
  options_of(f, 128, 96, 110.0);
  f->options.near_z = 1e-3;
  fixture_splats(f, 120 * 120);
  stability_fill(f, 0, &floor);
  check_run(f, "a floor to the horizon, panned", pan, 17, 1.0 / 16, (run){0.03, 0.0005, 0.0005});
  check_run(f, "a floor to the horizon, panned", pan, 17, 1.0 / 256, (run){0.03, 0.0005, 0.0005});
}

/* Moves in by t of the distance. */
static void move_in(fixture *f, double t) {
  const double at = 2.2 * (1.0 - t), eye[3] = {0.3 * at, 0.5 * at, at}, forward[3] = {-0.3, -0.5, -1.0};
  stability_look(f, eye, forward, 0.0);
}

static void test_zooms(fixture *f) {
  options_of(f, 128, 96, 110.0);
  fixture_scene(f, CONIC_SCENE_KNOT, 6000);
  check_run(f, "a knot, moved towards", move_in, 17, 1e-3, (run){0.06, 0.002, 0.002});
  check_run(f, "a knot, moved towards", move_in, 17, 1e-4, (run){0.045, 0.0005, 0.0005});
}

/* Lowers the eye over a board of large discs: one after the other is handed over from conic to ray, and then reaches
 * near. */
static void sink(fixture *f, double t) {
  const double eye[3] = {0.0, -1.0 + t, 0.0}, forward[3] = {0.0, 0.55, 1.0};
  stability_look(f, eye, forward, 0.0);
}

static void test_hand_over(fixture *f) {
  stability_sheet floor = stability_floor(0.0, 0.0, 4.0, 14);
  options_of(f, 128, 96, 80.0);
  f->options.shading = CONIC_SHADE_NONE;
  f->options.near_z = 1e-3;
  fixture_splats(f, 14 * 14);
  stability_fill(f, 0, &floor);
  uint64_t fewest = UINT64_MAX, most = 0;
  for (int i = 0; i <= 8; i++) {
    f->options.method = CONIC_METHOD_CONIC;
    sink(f, 0.1 * i);
    fixture_render(f);
    uint64_t by_ray = f->statistics.splats_by_method[CONIC_METHOD_RAY];
    fewest = by_ray < fewest ? by_ray : fewest;
    most = by_ray > most ? by_ray : most;
    if (i % 4 == 0)
      stability_agree(f, "a zoom through the hand-over", 0.02);
  }
  printf("%-44s %llu to %llu of 196 by ray\n", "a zoom through the hand-over", (unsigned long long)fewest,
         (unsigned long long)most);
  CHECK(most > fewest + 10);
  check_run(f, "a zoom through the hand-over", sink, 41, 0.02, (run){0.25, 0.01, 0.02});
  check_run(f, "a zoom through the hand-over", sink, 81, 1e-3, (run){0.15, 0.001, 0.004});
}

/* Patches of a torus: panned, and moved towards while its points turn from splats into patches, grid by grid. */
static void approach(fixture *f, double t) {
  const double at = 6.6 * (1.0 - t), eye[3] = {0.3 * at, 0.5 * at, at}, forward[3] = {-0.3, -0.5, -1.0};
  stability_look(f, eye, forward, 0.0);
}

/* While half of them do. */
static void from_there(fixture *f, double t) {
  approach(f, 0.25 + t);
}

static void test_patches(fixture *f) {
  const double eye[3] = {1.2, 1.5, 2.0}, forward[3] = {-1.2, -1.5, -2.0};
  double length;
  options_of(f, 128, 96, 110.0);
  fixture_scene(f, CONIC_SCENE_TORUS, 1000);
  CHECK_OK(conic_splats_length(f->context, &f->splats, &length));
  CHECK_OK(conic_patches_create(f->context, &f->splats, NULL, &patches));
  f->options.method = CONIC_METHOD_AUTO;
  f->options.epsilon = (double)f->options.kernel.cutoff * length;
  stability_look(f, eye, forward, 0.0);
  check_frames(f, "a torus, panned", "patch", pan, 9, 1.0 / 16, (run){0.04, 0.001, 0.005});
  check_frames(f, "a torus, panned", "patch", pan, 9, 1.0 / 256, (run){0.02, 0.0005, 0.001});
  conic_patch_selection selection;
  size_t n_first, n_last;
  approach(f, 0.0);
  CHECK_OK(conic_patches_select(patches, &f->camera, &f->options, &selection));
  n_first = selection.n_patches;
  approach(f, 0.5);
  CHECK_OK(conic_patches_select(patches, &f->camera, &f->options, &selection));
  n_last = selection.n_patches;
  printf("%-42s %zu, then %zu of 1000\n", "from splats to patches", n_first, n_last);
  CHECK(n_first < 100 && n_last > n_first + 500);
  check_frames(f, "from splats to patches", "patch", from_there, 31, 5e-3, (run){0.11, 0.004, 0.03});
  check_frames(f, "from splats to patches", "patch", from_there, 41, 1e-3, (run){0.07, 0.004, 0.01});
  conic_patches_destroy(patches);
  patches = NULL;
}

int main(void) {
  fixture f = fixture_open(2);
  test_pans(&f);
  test_zooms(&f);
  test_hand_over(&f);
  test_patches(&f);
  fixture_close(&f);
  return check_result();
}
