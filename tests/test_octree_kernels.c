/* The loops of building give the same on every instruction set, and what they leave out would change nothing. */
#include "core/memory.h"
#include "lod/octree_kernels.h"
#include "tests/check.h"
#include "tests/fixture.h"

enum { N_DISCS = 1000, ROOM = 1024, N_ARRAYS = 13, N_NODES = 300 };

typedef struct surface {
  float numbers[N_ARRAYS][ROOM], block_numbers[6][ROOM / CONIC_DISC_BLOCK];
  unsigned char taken[ROOM / CONIC_DISC_BLOCK];
  conic_discs discs;
} surface;

/* A wavy sheet of discs about (-1 … 1)², row by row, with a hole in the middle. */
static void lay_sheet(surface *s) {
  conic_discs *discs = &s->discs;
  for (int axis = 0; axis < 3; axis++) {
    discs->center[axis] = s->numbers[axis];
    discs->u[axis] = s->numbers[3 + axis];
    discs->v[axis] = s->numbers[6 + axis];
    discs->half[axis] = s->numbers[9 + axis];
    discs->block_center[axis] = s->block_numbers[axis];
    discs->block_half[axis] = s->block_numbers[3 + axis];
  }
  discs->error = s->numbers[12];
  discs->taken = s->taken;
  discs->count = N_DISCS;
  for (size_t k = 0; k < N_DISCS; k++) {
    float x = (float)(k % 32) / 16.0f - 1.0f, y = (float)(k / 32) / 16.0f - 1.0f;
    int is_hole = x * x + y * y < 0.09f;
    const float place[3] = {is_hole ? 2.0f + x : x, y, 0.05f * x * y};
    for (int axis = 0; axis < 3; axis++) {
      discs->center[axis][k] = place[axis];
      discs->u[axis][k] = axis == 0 ? 0.06f : 0.01f * x;
      discs->v[axis][k] = axis == 1 ? 0.05f : 0.02f * y;
    }
    discs->error[k] = k % 17 == 0 ? 0.004f : 0.0f;
  }
  conic_discs_set_half(discs, 0);
  conic_discs_close(discs);
}

/* A node over the leaves from `begin` on; some are where nothing is. */
static conic_node_disc node_over(const conic_discs *discs, size_t begin, int i) {
  float size = 0.05f + 0.002f * (float)(i % 100), shift = i % 7 == 0 ? 0.3f : 0.0f;
  conic_node_disc node = {.u = {size, 0.0f, 0.02f * size},
                          .v = {0.0f, 0.7f * size, 0.0f},
                          .n = {-0.019996f, 0.0f, 0.99980006f},
                          .enough = 0.3f * size};
  for (int axis = 0; axis < 3; axis++)
    node.center[axis] = discs->center[axis][begin] + shift;
  return node;
}

static void test_cover(void) {
  static surface s;
  conic_disc_samples samples;
  conic_disc_samples_init(&samples);
  lay_sheet(&s);
  conic_cover_function *chosen = conic_octree_kernels_choose().cover;
  int n_enough = 0, n_moved = 0;
  for (int i = 0; i < N_NODES; i++) {
    size_t begin = (size_t)(i * 37) % (N_DISCS - 8), end = begin + 2 + (size_t)(i % 6);
    conic_node_disc node = node_over(&s.discs, begin, i);
    float error = conic_cover_baseline(&samples, &s.discs, begin, end, &node);
    CHECK(error >= node.enough && error < HUGE_VALF);
    CHECK(error == chosen(&samples, &s.discs, begin, end, &node));
    n_enough += error == node.enough;
    /* Whatever of the discs is looked at first. */
    n_moved += error != chosen(&samples, &s.discs, 0, N_DISCS, &node);
  }
  CHECK(n_enough > N_NODES / 10 && n_enough < N_NODES);
  CHECK(n_moved == 0);
}

static void test_inside(void) {
  fixture f = fixture_open(1);
  fixture_scene(&f, CONIC_SCENE_TERRAIN, 4000);
  const conic_node_frame frame = {
      .position = {0.01, 0.02, 0.0}, .u = {0.8, 0.6, 0.0}, .v = {-0.6, 0.8, 0.0}, .n = {0.0, 0.0, 1.0}, .ratio = 0.5};
  conic_inside_function *chosen = conic_octree_kernels_choose().find_inside;
  conic_leaf_reach all = {.cosine = 1.0}, half = {.cosine = 1.0};
  conic_leaf_reach_add(&f.splats, 0, f.splats.count, 1.5, &frame, &all);
  conic_leaf_reach_add(&f.splats, 0, f.splats.count / 2, 1.5, &frame, &half);
  int n_inside = 0, n_wrong = 0;
  for (size_t i = 0; i + CONIC_INSIDE_BATCH <= f.splats.count; i += CONIC_INSIDE_BATCH) {
    unsigned bits = conic_find_inside_baseline(&f.splats, i, 1.5, &frame, &half);
    CHECK(bits == chosen(&f.splats, i, 1.5, &frame, &half));
    n_inside += __builtin_popcount(bits);
    for (size_t k = 0; k < CONIC_INSIDE_BATCH; k++) {
      conic_leaf_reach one = half;
      conic_leaf_reach_add(&f.splats, i + k, i + k + 1, 1.5, &frame, &one);
      n_wrong += (bits >> k & 1u) && memcmp(&one, &half, sizeof one) != 0;
    }
  }
  CHECK(n_inside > 500 && n_inside < 4000);
  CHECK(n_wrong == 0);
  conic_leaf_reach slow = {.cosine = 1.0};
  for (size_t i = 0; i < f.splats.count; i++)
    conic_leaf_reach_add(&f.splats, i, i + 1, 1.5, &frame, &slow);
  CHECK(memcmp(&slow, &all, sizeof slow) == 0);
  fixture_close(&f);
}

int main(void) {
  test_cover();
  test_inside();
  return check_result();
}
