/* The triangles that each splat makes with its neighbours in its own plane (Delaunay's there). */

#include "core/base/vectors.h"
#include "surface/fan.h"
#include "surface/skin/skin_search.h"

enum { SLOTS_A_TASK = 64 };

/* The least cosine between the normals of a triangle and of a corner. */
static const double LEAST_COSINE = 0.3;

/* The middle of a triangle's circle is within its corners' ellipses, enlarged by this. */
static const double COVERED = 1.1;

typedef struct fan_pass {
  conic_skin_search *search;
  conic_fan *fans; /* by slot */
} fan_pass;

static void find_skin_fans(void *data, size_t i_item) {
  const fan_pass *pass = data;
  const conic_skin_search *search = pass->search;
  for (size_t slot = i_item * SLOTS_A_TASK; slot < (i_item + 1) * SLOTS_A_TASK && slot < search->tree.n_slots; slot++) {
    double normal[3], u[3], v[3];
    conic_vector_at(search->normal, (uint32_t)slot, normal);
    pass->fans[slot].n = 0;
    if (!(conic_dot(normal, normal) > 0.0) || !conic_skin_ellipse(search, (uint32_t)slot, u, v))
      continue;
    double longest = 1.0 / sqrt(fmin(conic_dot(u, u), conic_dot(v, v)));
    conic_fan_find(&search->tree, search->normal, (uint32_t)slot, normal, COVERED * longest, &pass->fans[slot]);
  }
}

static int has_corner_pair(const conic_fan *fan, uint32_t a, uint32_t b) {
  for (int i = 0; i < fan->n; i++)
    if (fan->pairs[i][0] == a && fan->pairs[i][1] == b)
      return 1;
  return 0;
}

/* The middle of the circle through the corners, and its radius; infinite where they are on a line. */
static double circle_of(double at[3][3], const double across[3], double middle[3]) {
  double u[3], v[3], cross_u[3], cross_v[3], twice = 2.0 * conic_dot(across, across);
  conic_subtract(at[1], at[0], u);
  conic_subtract(at[2], at[0], v);
  conic_cross(across, u, cross_u);
  conic_cross(v, across, cross_v);
  double uu = conic_dot(u, u), vv = conic_dot(v, v), offset[3];
  for (int axis = 0; axis < 3; axis++) {
    offset[axis] = (vv * cross_u[axis] + uu * cross_v[axis]) / twice;
    middle[axis] = at[0][axis] + offset[axis];
  }
  return twice > 0.0 ? conic_length(offset) : HUGE_VAL;
}

int conic_skin_is_covered(const conic_skin_search *search, double least_cosine, double enlarged,
                          conic_skin_triangle *triangle) {
  double at[3][3], u[3], v[3], across[3], middle[3];
  for (int k = 0; k < 3; k++)
    conic_vector_at(search->tree.position, triangle->slots[k], at[k]);
  conic_subtract(at[1], at[0], u);
  conic_subtract(at[2], at[0], v);
  conic_cross(u, v, across);
  triangle->reach = (float)circle_of(at, across, middle);
  if (!(triangle->reach < HUGE_VALF))
    return 0;
  double length = conic_length(across);
  for (int k = 0; k < 3; k++) {
    double normal[3], way[3];
    conic_vector_at(search->normal, triangle->slots[k], normal);
    conic_subtract(middle, at[k], way);
    if (!(conic_dot(normal, across) >= least_cosine * length) || !conic_skin_ellipse(search, triangle->slots[k], u, v))
      return 0;
    double x = conic_dot(way, u), y = conic_dot(way, v);
    if (!(x * x + y * y <= enlarged * enlarged))
      return 0;
  }
  return 1;
}

/* Takes a triangle of a slot's fan if this slot lists it: it is the first corner whose fan has it. */
static int take_pair(const fan_pass *pass, uint32_t slot, const uint32_t pair[2], conic_skin_triangle *triangle) {
  const uint32_t all[3] = {slot, pair[0], pair[1]};
  int first = 0;
  triangle->n_votes = 1;
  for (int k = 1; k < 3; k++) {
    int has = has_corner_pair(&pass->fans[all[k]], all[(k + 1) % 3], all[(k + 2) % 3]);
    if (has && all[k] < slot)
      return 0;
    triangle->n_votes += has;
  }
  for (int k = 1; k < 3; k++)
    first = all[k] < all[first] ? k : first;
  for (int k = 0; k < 3; k++)
    triangle->slots[k] = all[(first + k) % 3];
  return conic_skin_is_covered(pass->search, LEAST_COSINE, COVERED, triangle);
}

conic_status conic_skin_candidates(conic_skin_search *search) {
  size_t n_slots = search->tree.n_slots, room = 0;
  fan_pass pass = {search, conic_memory_allocate(search->context, n_slots, sizeof *pass.fans)};
  conic_status status = pass.fans ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    conic_parallel_for(search->context, (n_slots + SLOTS_A_TASK - 1) / SLOTS_A_TASK, find_skin_fans, &pass);
  for (size_t slot = 0; slot < n_slots && status == CONIC_OK; slot++)
    for (int i = 0; i < pass.fans[slot].n && status == CONIC_OK; i++) {
      status = conic_memory_reserve(search->context, &search->triangles, search->n_triangles, search->n_triangles + 1,
                                    &room, sizeof *search->triangles);
      if (status == CONIC_OK)
        search->n_triangles +=
            (size_t)take_pair(&pass, (uint32_t)slot, pass.fans[slot].pairs[i], &search->triangles[search->n_triangles]);
    }
  conic_memory_release(search->context, pass.fans);
  return status;
}
