/* How far discs are from those that stand for them: the greatest of all, in whichever order they are looked at, by any
 * instruction set. */
#include "core/base/random.h"
#include "lod/layers/build/layers_thin.h"
#include "lod/layers/format/layers_key.h"
#include "tests/support/check.h"

enum { N = 400, STANDING = 60, N_ORDERS = 8, N_SCENES = 200 };

/* Many discs reach little past those that stand, which are wide: by how they are turned, and so between corners. */
static const double height = 2.0, tilt = 1.0, most_radius = 60.0, standing_radius = 200.0;

static double draw_uniform(uint64_t scene, uint64_t i, uint64_t dimension) {
  return conic_random_uniform(scene, i, dimension);
}

static int order_keys(const void *a, const void *b) {
  uint64_t first = *(const uint64_t *)a, second = *(const uint64_t *)b;
  return (first > second) - (first < second);
}

/* A sheet, on which discs lie as they like. */
static void scatter_keys(uint64_t scene, uint64_t keys[N]) {
  for (uint64_t i = 0; i < N; i++)
    keys[i] =
        conic_layers_key((uint32_t)(1000.0 * draw_uniform(scene, i, 0)), (uint32_t)(1000.0 * draw_uniform(scene, i, 1)),
                         500 + (uint32_t)(height * draw_uniform(scene, i, 2)));
  qsort(keys, N, sizeof *keys, order_keys);
}

static conic_layers_disc disc_at(uint64_t scene, uint64_t key, double radius) {
  conic_layers_disc disc = {.radius = (float)radius};
  double length2 = 0.0, normal[3];
  for (int axis = 0; axis < 3; axis++) {
    normal[axis] = (axis == 2) + tilt * (draw_uniform(scene, key, 4 + (uint64_t)axis) - 0.5);
    length2 += normal[axis] * normal[axis];
    disc.center[axis] = (float)conic_layers_step(key, axis);
  }
  for (int axis = 0; axis < 3; axis++)
    disc.normal[axis] = (float)(normal[axis] / sqrt(length2));
  return disc;
}

/* Some at a time, from one on and round. */
static double part_in_order(const conic_layers_chosen *standing, const conic_layers_disc *discs, size_t first,
                            size_t some) {
  double part = 0.0;
  for (size_t done = 0, at = first; done < N;) {
    size_t n = N - at < some ? N - at : some;
    part = standing->loops.error(standing, discs + at, n, 0.0, part);
    done += n;
    at = (at + n) % N;
  }
  return part;
}

/* Every instruction set gives the same bits, of whole sets and of single discs. */
static void check_loops(conic_layers_chosen standing, const conic_layers_disc *discs, double part) {
  const conic_layers_disc_loops best = standing.loops;
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    if (!conic_isa_is_here((conic_isa)isa))
      continue;
    conic_layers_disc_loops_init(&standing.loops, (conic_isa)isa);
    CHECK(part_in_order(&standing, discs, 7, 5) == part);
    for (size_t i = 3; i < N; i += 50)
      CHECK(standing.loops.off(&discs[i], discs + i - 3, 3, 0.0f) == best.off(&discs[i], discs + i - 3, 3, 0.0f));
  }
}

static void check_sheet(conic_context *context, uint64_t scene) {
  static uint64_t keys[N];
  static conic_layers_disc discs[N], drawn[N];
  static uint8_t is_chosen[N];
  static uint32_t ranks[N];
  conic_thinner *thinner;
  double distance = 80.0;
  size_t n_drawn = 0;
  scatter_keys(scene, keys);
  CHECK_OK(conic_thinner_create(context, N, &thinner));
  conic_thinner_load(thinner, keys, sizeof *keys, N);
  conic_thinner_choose(thinner, STANDING, 2 * STANDING, &distance, is_chosen);
  for (size_t i = 0; i < N; i++) {
    discs[i] = disc_at(scene, keys[i], most_radius * draw_uniform(scene, i, 9));
    if (is_chosen[i])
      drawn[n_drawn++] = disc_at(scene, keys[i], standing_radius);
  }
  size_t n = conic_thinner_numbers(thinner, ranks);
  CHECK(n == n_drawn && n > STANDING / 2);
  conic_layers_chosen standing;
  CHECK_OK(conic_layers_chosen_create(context, thinner, n, &standing));
  for (size_t k = 0; k < n; k++)
    conic_layers_chosen_put(&standing, k, &drawn[ranks[k]]);
  double part = part_in_order(&standing, discs, 0, N), most = 0.0;
  for (size_t i = 0; i < N; i++) {
    double own = standing.loops.error(&standing, &discs[i], 1, 0.0, 0.0);
    most = own > most ? own : most;
  }
  CHECK(part == most && part > 0.0);
  for (size_t i = 1; i < N_ORDERS; i++)
    CHECK(part_in_order(&standing, discs, i * N / N_ORDERS, 1 + i) == part);
  check_loops(standing, discs, part);
  conic_memory_release(context, standing.center[0]);
  conic_thinner_destroy(context, thinner);
}

int main(void) {
  conic_context *context = check_context(1);
  for (uint64_t scene = 0; scene < N_SCENES; scene++)
    check_sheet(context, scene);
  conic_context_destroy(context);
  return check_result();
}
