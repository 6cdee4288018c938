/* From frame to frame: how much a pixel may change when the camera pans by a fraction of a pixel, or slowly moves in. A
 * picture that flickers changes by as much however small the step is; one that does not changes less and less
 * (docs/stability.md). */
#include "tests/stability.h"

typedef void set_frame(fixture *f, double t);

/* How a pixel changed over a run of frames. */
typedef struct run {
  double largest, p999; /* of the colour, of one frame to the next, where both cover the pixel */
  double most_flips;    /* share of the covered pixels that appear or vanish in one step */
} run;

static run play(fixture *f, set_frame *set, int n_frames, double step) {
  run r = {0};
  conic_image last = {0};
  for (int i = 0; i < n_frames; i++) {
    set(f, i * step);
    conic_image image = stability_draw(f);
    if (i) {
      stability_difference d = stability_compare(&last, &image);
      r.largest = fmax(r.largest, d.color);
      r.p999 = fmax(r.p999, d.color_p999);
      r.most_flips = fmax(r.most_flips, (double)d.coverage / (double)d.both);
    }
    conic_image_release(f->context, &last);
    last = image;
  }
  conic_image_release(f->context, &last);
  return r;
}

/* What a sequence of a given step may do at most. */
typedef struct bound {
  double largest, p999, flips;
} bound;

static void check_run(fixture *f, const char *name, set_frame *set, int n_frames, double step, bound most) {
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    f->options.method = (conic_method)method;
    run r = play(f, set, n_frames, step);
    printf("%-44s %-7s step %-8.3g largest change %.4f (p99.9 %.4f)  coverage %.2f %%\n", name,
           conic_method_name((conic_method)method), step, r.largest, r.p999, 100.0 * r.most_flips);
    CHECK(r.largest <= most.largest);
    CHECK(r.p999 <= most.p999);
    CHECK(r.most_flips <= most.flips);
    CHECK(r.largest > 0.0);
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

static void test_pans(fixture *f) {
  const double eye[3] = {1.2, 0.9, 2.0}, forward[3] = {-1.2, -0.9, -2.0};
  options_of(f, 128, 96, 110.0);
  fixture_scene(f, CONIC_SCENE_SPHERE, 6000);
  stability_look(f, eye, forward, 0.0);
  check_run(f, "a sphere, panned", pan, 17, 1.0 / 16, (bound){0.06, 0.05, 0.02});
  check_run(f, "a sphere, panned", pan, 17, 1.0 / 256, (bound){0.06, 0.05, 0.02});
  stability_sheet floor = stability_floor(0.4, 0.0, 3.0, 120);
  options_of(f, 128, 96, 110.0);
  f->options.near_z = 1e-3;
  fixture_splats(f, 120 * 120);
  stability_fill(f, 0, &floor);
  check_run(f, "a floor to the horizon, panned", pan, 17, 1.0 / 16, (bound){0.06, 0.05, 0.02});
  check_run(f, "a floor to the horizon, panned", pan, 17, 1.0 / 256, (bound){0.06, 0.05, 0.02});
}

/* Moves in by t of the distance. */
static void move_in(fixture *f, double t) {
  const double at = 2.2 * (1.0 - t), eye[3] = {0.3 * at, 0.5 * at, at}, forward[3] = {-0.3, -0.5, -1.0};
  stability_look(f, eye, forward, 0.0);
}

static void test_zooms(fixture *f) {
  options_of(f, 128, 96, 110.0);
  fixture_scene(f, CONIC_SCENE_KNOT, 6000);
  check_run(f, "a knot, moved towards", move_in, 17, 1e-3, (bound){0.06, 0.05, 0.02});
  check_run(f, "a knot, moved towards", move_in, 17, 1e-4, (bound){0.06, 0.05, 0.02});
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
  check_run(f, "a zoom through the hand-over", sink, 41, 0.02, (bound){0.3, 0.2, 0.02});
  check_run(f, "a zoom through the hand-over", sink, 81, 1e-3, (bound){0.3, 0.2, 0.02});
}

int main(void) {
  fixture f = fixture_open(2);
  test_pans(&f);
  test_zooms(&f);
  test_hand_over(&f);
  fixture_close(&f);
  return check_result();
}
