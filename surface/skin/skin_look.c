/* What the picture shows at a splat: all splats over it blend, and the picture shows their mean. */

#include "core/base/vectors.h"
#include "surface/skin/skin_search.h"

enum { N_SEEN = 40, SPLATS_A_TASK = 64 };

/* Normals turned by more than the first belong to the other side of a thin part; planes turned by more than the second,
 * to another side of an edge. */
static const double LEAST_COSINE = -0.3, LEAST_OF_PLANES = 0.5;

/* How far a splat counts, squared, in outlines: for normals, as it blends; for colours; for planes. A plane farther off
 * than FARTHEST of its splat's longer half axis does not count. */
static const double NORMALS = 1.0, COLORS = 2.25, PLANES = 9.0, FARTHEST = 0.7;

typedef struct look_pass {
  const conic_skin_search *search;
  conic_skin *skin;
} look_pass;

/* A splat seen from a place: q is below 1 within its outline; `lift` is how far along `normal` its plane is from the
 * place. */
typedef struct seen_splat {
  double facing[3], q, lift;
  int has_plane;
} seen_splat;

static int see_splat(const conic_skin_search *search, uint32_t slot, const double place[3], const double normal[3],
                     seen_splat *seen) {
  double at[3], way[3], u[3], v[3];
  if (!conic_skin_ellipse(search, slot, u, v))
    return 0;
  conic_vector_at(search->tree.position, slot, at);
  conic_vector_at(search->normal, slot, seen->facing);
  conic_subtract(at, place, way);
  double x = conic_dot(way, u), y = conic_dot(way, v), along = conic_dot(seen->facing, normal);
  double uu = conic_dot(u, u), vv = conic_dot(v, v), steep2 = uu < vv ? uu : vv;
  seen->q = x * x + y * y;
  seen->lift = conic_dot(seen->facing, way) / along;
  seen->has_plane = along >= LEAST_OF_PLANES && seen->lift * seen->lift * steep2 <= FARTHEST * FARTHEST;
  return along >= LEAST_COSINE;
}

static double falling(double q, double end) {
  double rest = 1.0 - q / end;
  return rest > 0.0 ? rest * rest : 0.0;
}

/* The mean normal about a slot, or its own; returns 0 where it has none. */
static int find_mean_normal(const conic_skin_search *search, const uint32_t *near, size_t n, const double place[3],
                            double normal[3]) {
  double own[3], sum[3] = {0.0, 0.0, 0.0};
  conic_vector_at(search->normal, near[0], own);
  for (size_t i = 0; i < n; i++) {
    seen_splat seen;
    if (see_splat(search, near[i], place, own, &seen))
      for (int axis = 0; axis < 3; axis++)
        sum[axis] += falling(seen.q, NORMALS) * seen.facing[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = sum[axis];
  return conic_normalize(normal);
}

static void look_at_slot(const look_pass *pass, uint32_t slot) {
  const conic_skin_search *search = pass->search;
  uint32_t near[N_SEEN + 1] = {slot}, splat = search->tree.point_of_slot[slot];
  double distances2[N_SEEN], place[3], normal[3], color[3] = {0.0, 0.0, 0.0}, sums[2] = {0.0, 0.0}, lift = 0.0;
  conic_vector_at(search->tree.position, slot, place);
  size_t n = 1 + conic_neighbours_nearest(&search->tree, place, slot, N_SEEN, HUGE_VAL, near + 1, distances2);
  if (!find_mean_normal(search, near, n, place, normal))
    return;
  for (size_t i = 0; i < n; i++) {
    uint32_t other = search->tree.point_of_slot[near[i]];
    seen_splat seen;
    if (!see_splat(search, near[i], place, normal, &seen))
      continue;
    double weight = falling(seen.q, COLORS), weight_of_plane = seen.has_plane ? falling(seen.q, PLANES) : 0.0;
    sums[0] += weight;
    sums[1] += weight_of_plane;
    lift += weight_of_plane > 0.0 ? weight_of_plane * seen.lift : 0.0;
    for (int channel = 0; channel < 3 && search->splats->color[0]; channel++)
      color[channel] += weight * (double)search->splats->color[channel][other];
  }
  pass->skin->lift[splat] = sums[1] > 0.0 ? (float)(lift / sums[1]) : 0.0f;
  for (int axis = 0; axis < 3; axis++) {
    pass->skin->normal[splat][axis] = (float)normal[axis];
    pass->skin->color[splat][axis] = sums[0] > 0.0 ? (float)(color[axis] / sums[0]) : 0.0f;
  }
}

static void look_task(void *data, size_t i_item) {
  const look_pass *pass = data;
  for (size_t i = i_item * SPLATS_A_TASK; i < (i_item + 1) * SPLATS_A_TASK && i < pass->search->tree.n_slots; i++)
    look_at_slot(pass, (uint32_t)i);
}

void conic_skin_look(const conic_skin_search *search, conic_skin *skin) {
  look_pass pass = {search, skin};
  conic_parallel_for(search->context, (search->tree.n_slots + SPLATS_A_TASK - 1) / SPLATS_A_TASK, look_task, &pass);
}
