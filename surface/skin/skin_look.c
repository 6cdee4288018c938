/* What the picture shows where a splat lies: all splats over it blend. */
#include <math.h>

#include "core/base/threads.h"
#include "core/base/vectors.h"
#include "surface/skin/skin_search.h"

enum { N_SEEN = 24, SPLATS_A_TASK = 64 };

/* Normals turned away by more than this are of the other side of something thin. */
static const double LEAST_COSINE = -0.3;

typedef struct look_pass {
  const conic_skin_search *search;
  conic_skin *skin;
} look_pass;

static double weight_at(const conic_skin_search *search, uint32_t slot, const double place[3]) {
  double at[3], way[3], u[3], v[3];
  if (!conic_skin_ellipse(search, slot, u, v))
    return 0.0;
  conic_skin_place(search, slot, at);
  conic_subtract(place, at, way);
  double x = conic_dot(way, u), y = conic_dot(way, v), q = x * x + y * y;
  return q < 1.0 ? exp(-0.5 * search->cutoff * search->cutoff * q) : 0.0;
}

static void look_at_slot(const look_pass *pass, uint32_t slot) {
  const conic_skin_search *search = pass->search;
  uint32_t near[N_SEEN + 1];
  double distances2[N_SEEN], place[3], own[3], sum = 0.0, normal[3] = {0}, color[3] = {0};
  conic_skin_place(search, slot, place);
  conic_skin_normal(search, slot, own);
  size_t n = conic_neighbours_nearest(&search->tree, place, slot, N_SEEN, HUGE_VAL, near, distances2);
  near[n++] = slot;
  for (size_t i = 0; i < n; i++) {
    double facing[3], weight = weight_at(search, near[i], place);
    uint32_t splat = search->tree.point_of_slot[near[i]];
    conic_skin_normal(search, near[i], facing);
    if (conic_dot(own, facing) < LEAST_COSINE)
      continue;
    sum += weight;
    for (int axis = 0; axis < 3; axis++) {
      normal[axis] += weight * facing[axis];
      color[axis] += weight * (search->splats->color[0] ? (double)search->splats->color[axis][splat] : 1.0);
    }
  }
  uint32_t splat = search->tree.point_of_slot[slot];
  conic_normalize(normal);
  for (int axis = 0; axis < 3; axis++) {
    pass->skin->normal[splat][axis] = (float)normal[axis];
    pass->skin->color[splat][axis] = sum > 0.0 ? (float)(color[axis] / sum) : 0.0f;
  }
}

static void look_task(void *data, size_t i_item, int i_thread) {
  const look_pass *pass = data;
  (void)i_thread;
  for (size_t i = i_item * SPLATS_A_TASK; i < (i_item + 1) * SPLATS_A_TASK && i < pass->search->tree.n_slots; i++)
    look_at_slot(pass, (uint32_t)i);
}

void conic_skin_look(const conic_skin_search *search, conic_skin *skin) {
  look_pass pass = {search, skin};
  conic_parallel_for(search->context, (search->tree.n_slots + SPLATS_A_TASK - 1) / SPLATS_A_TASK, look_task, &pass);
}
