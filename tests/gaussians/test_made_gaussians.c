/* The scene that is made: sound, like a trained one in what matters for speed, and the same whoever makes it. */
#include <string.h>

#include "conic/gaussian_render.h"
#include "gaussians/scene/made_gaussians.h"
#include "tests/support/check.h"

enum { N = 20000 };

static void test_sound(conic_context *context) {
  conic_gaussians set;
  conic_gaussians_defects defects;
  double low[3], high[3];
  CHECK_OK(conic_gaussians_make(context, N, 3, 0, &set));
  conic_gaussians_find_defects(&set, &defects);
  CHECK(defects.positions + defects.scales + defects.rotations + defects.opacities + defects.harmonics == 0);
  CHECK(set.sh_degree == 3 && strcmp(set.frame, "rdf") == 0 && conic_gaussians_bounds(&set, low, high) == N);
  size_t n_faint = 0, n_flat = 0, n_on_floor = 0;
  for (size_t i = 0; i < N; i++) {
    n_faint += set.opacity[i] < 0.33f;
    n_flat += set.scale[2][i] < 0.35f * set.scale[0][i];
    n_on_floor += set.position[1][i] > 0.7f;
  }
  for (int axis = 0; axis < 3; axis++)
    CHECK(low[axis] < -0.6 && low[axis] > -3.5 && high[axis] > 0.6 && high[axis] < 3.5);
  CHECK(n_faint > N / 4 && n_faint < N / 2 && n_flat > N * 9 / 10 && n_on_floor > N * 2 / 5 && n_on_floor < N * 3 / 5);
  conic_gaussians_release(context, &set);
}

/* Looked at from above, its floor covers everything. */
static void test_covers(conic_context *context) {
  enum { EDGE = 32 };
  float transparency[EDGE * EDGE];
  conic_gaussians set;
  conic_gaussian_planes planes = {.width = EDGE, .height = EDGE, .transparency = transparency};
  conic_camera camera = {.width = EDGE, .height = EDGE, .fx = EDGE, .fy = EDGE, .cx = EDGE / 2, .cy = EDGE / 2};
  camera.cam_from_world[0][0] = 1.0;
  camera.cam_from_world[1][2] = -1.0;
  camera.cam_from_world[2][1] = 1.0;
  camera.cam_from_world[2][3] = 2.5;
  double worst = 0.0;
  CHECK_OK(conic_gaussians_make(context, N, 0, 0, &set));
  CHECK_OK(conic_gaussians_render(context, &set, &camera, NULL, &planes, NULL));
  for (int i = 0; i < EDGE * EDGE; i++)
    worst = transparency[i] > worst ? transparency[i] : worst;
  CHECK(worst < 0.5);
  conic_gaussians_release(context, &set);
}

static void test_same(conic_context *context) {
  conic_context *alone = check_context(1);
  conic_gaussians sets[3];
  conic_gaussians_differences differences;
  CHECK_OK(conic_gaussians_make(context, N, 2, 5, &sets[0]));
  CHECK_OK(conic_gaussians_make(alone, N, 2, 5, &sets[1]));
  CHECK_OK(conic_gaussians_make(context, N, 2, 6, &sets[2]));
  CHECK_OK(conic_gaussians_compare(context, &sets[0], &sets[1], &differences));
  CHECK(differences.is_same);
  CHECK_OK(conic_gaussians_compare(context, &sets[0], &sets[2], &differences));
  CHECK(!differences.is_same && differences.position > 0.1 && differences.harmonics > 0.01);
  for (int i = 0; i < 3; i++)
    conic_gaussians_release(i == 1 ? alone : context, &sets[i]);
  CHECK(conic_gaussians_make(context, 0, 3, 0, &sets[0]) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_gaussians_make(context, N, 5, 0, &sets[0]) == CONIC_ERROR_ARGUMENT);
  conic_context_destroy(alone);
}

int main(void) {
  conic_context *context = check_context(3);
  test_sound(context);
  test_covers(context);
  test_same(context);
  conic_context_destroy(context);
  return check_result();
}
