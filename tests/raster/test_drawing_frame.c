/* Cameras that a drawing just fits: its corners, projected one by one, fill nine tenths of the picture, in its middle;
 * and so does the largest picture of a turntable. */
#include "tests/support/fixture.h"
#include "tests/support/random_numbers.h"

enum { N_POINTS = 500, N_TURNS = 8 };

/* Splats in an ellipsoid that lies askew and off the origin, each of which is a round disc. */
static void scatter(fixture *f, double radius) {
  uint64_t state = 7;
  fixture_splats(f, N_POINTS);
  for (size_t i = 0; i < N_POINTS; i++) {
    double at[3], u[3] = {radius, 0.0, 0.0}, v[3] = {0.0, 0.6 * radius, 0.8 * radius};
    double a = random_unit(&state) - 0.5, b = random_unit(&state) - 0.5, c = random_unit(&state) - 0.5;
    at[0] = 3.0 * a + b + 10.0;
    at[1] = a - 2.0 * b;
    at[2] = c + 0.3 * a - 40.0;
    fixture_set(f, i, at, u, v, 1, 1, 1);
  }
}

/* The box of what is drawn, in parts of the picture's width and height from its middle. */
static void find_box(const fixture *f, double cutoff, double low[2], double high[2]) {
  const conic_camera *camera = &f->camera;
  low[0] = low[1] = 1e30;
  high[0] = high[1] = -1e30;
  for (size_t i = 0; i < f->splats.count; i++)
    for (int k = 0; k < 64; k++) {
      double angle = 6.283185307179586 * k / 64, seen[3];
      for (int row = 0; row < 3; row++) {
        seen[row] = camera->cam_from_world[row][3];
        for (int axis = 0; axis < 3; axis++)
          seen[row] +=
              camera->cam_from_world[row][axis] * ((double)f->splats.position[axis][i] + f->splats.origin[axis] +
                                                   cutoff * (cos(angle) * (double)f->splats.tangent_u[axis][i] +
                                                             sin(angle) * (double)f->splats.tangent_v[axis][i]));
      }
      CHECK(seen[2] > 0.0);
      double at[2] = {camera->fx * seen[0] / seen[2] / camera->width, camera->fy * seen[1] / seen[2] / camera->height};
      for (int axis = 0; axis < 2; axis++) {
        low[axis] = fmin(low[axis], at[axis]);
        high[axis] = fmax(high[axis], at[axis]);
      }
    }
}

static void frame(fixture *f, const conic_framing *framing, double cutoff, int n_turns) {
  const conic_drawing drawing = {.splats = &f->splats};
  CHECK_OK(conic_drawing_frame(f->context, &drawing, (float)cutoff, framing, n_turns, &f->camera, NULL));
}

static void test_outline_fills_picture(double radius, double cutoff, int width, int height) {
  fixture f = fixture_open(2);
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = width;
  framing.height = height;
  scatter(&f, radius);
  for (int i = 0; i < 12; i++) {
    double low[2], high[2];
    framing.azimuth_deg = 30.0 * i;
    framing.elevation_deg = 15.0 * i - 80.0;
    framing.up[0] = 0.1 * i;
    frame(&f, &framing, cutoff, 1);
    find_box(&f, cutoff, low, high);
    double greatest = fmax(high[0] - low[0], high[1] - low[1]);
    CHECK_NEAR(greatest, 0.9, 2e-3);
    for (int axis = 0; axis < 2; axis++)
      CHECK_NEAR(0.5 * (low[axis] + high[axis]), 0.0, 2e-3);
  }
  fixture_close(&f);
}

static void test_turntable_keeps_its_distance(void) {
  fixture f = fixture_open(2);
  conic_framing framing;
  double widest = 0.0, eye_height = 0.0;
  conic_framing_init(&framing);
  scatter(&f, 0.05);
  for (int i = 0; i < N_TURNS; i++) {
    double low[2], high[2];
    framing.azimuth_deg = 30.0 + 360.0 * i / N_TURNS;
    frame(&f, &framing, 1.5, N_TURNS);
    find_box(&f, 1.5, low, high);
    for (int axis = 0; axis < 2; axis++) {
      widest = fmax(widest, 2.0 * fmax(-low[axis], high[axis]));
      CHECK(low[axis] > -0.4501 && high[axis] < 0.4501);
    }
    double eye_up = 0.0;
    for (int row = 0; row < 3; row++)
      eye_up -= f.camera.cam_from_world[row][1] * f.camera.cam_from_world[row][3];
    if (i > 0)
      CHECK_NEAR(eye_up, eye_height, 1e-9);
    eye_height = eye_up;
  }
  CHECK_NEAR(widest, 0.9, 5e-3);
  fixture_close(&f);
}

/* Zoom is of the lens alone; a point alone, or points in a line with the eye, are seen from some way off. */
static void test_zoom_and_points(void) {
  fixture f = fixture_open(1);
  conic_framing framing;
  conic_framing_init(&framing);
  scatter(&f, 0.05);
  frame(&f, &framing, 1.5, 1);
  conic_camera before = f.camera;
  framing.zoom = 3.0;
  frame(&f, &framing, 1.5, 1);
  CHECK(f.camera.fx == 3.0 * before.fx);
  CHECK(memcmp(f.camera.cam_from_world, before.cam_from_world, sizeof before.cam_from_world) == 0);
  fixture_splats(&f, 2);
  framing.azimuth_deg = framing.elevation_deg = 0.0;
  for (size_t i = 0; i < 2; i++)
    fixture_set(&f, i, (double[3]){1, 2, 3.0 * (double)i}, (double[3]){0, 0, 0}, (double[3]){0, 0, 0}, 1, 1, 1);
  frame(&f, &framing, 1.5, 1);
  CHECK(f.camera.cam_from_world[2][3] - 3.0 > 0.1); /* of the nearer one; forward is -z */
  f.splats.position[0][0] = NAN;
  f.splats.count = 1;
  frame(&f, &framing, 1.5, 1);
  CHECK(conic_drawing_frame(f.context, &(conic_drawing){0}, 1.5f, &framing, 0, &f.camera, NULL) ==
        CONIC_ERROR_ARGUMENT);
  fixture_close(&f);
}

/* One point in a thousand that a scanner threw far away is not what is framed; near goes with what is. */
static void test_strays(void) {
  fixture f = fixture_open(1);
  conic_framing framing;
  double near_z;
  conic_framing_init(&framing);
  scatter(&f, 0.05);
  frame(&f, &framing, 1.5, 1);
  conic_camera before = f.camera;
  f.splats.position[0][7] = 1e5f;
  f.splats.position[2][9] = -3e4f;
  const conic_drawing drawing = {.splats = &f.splats};
  CHECK_OK(conic_drawing_frame(f.context, &drawing, 1.5f, &framing, 1, &f.camera, &near_z));
  CHECK(near_z < 1e-3 && conic_drawing_near(&drawing) > 1.0);
  for (int row = 0; row < 3; row++)
    CHECK_NEAR(f.camera.cam_from_world[row][3], before.cam_from_world[row][3], 0.3);
  fixture_close(&f);
}

int main(void) {
  test_outline_fills_picture(0.05, 1.5, 400, 400);
  test_outline_fills_picture(0.5, 3.0, 1920, 300);
  test_outline_fills_picture(0.001, 1.5, 200, 900);
  test_turntable_keeps_its_distance();
  test_zoom_and_points();
  test_strays();
  return check_result();
}
