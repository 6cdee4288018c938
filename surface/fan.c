#include "surface/fan.h"

#include "core/base/vectors.h"
#include "core/estimate/voronoi_cell.h"

enum { N_NEIGHBOURS = 24 };

/* Up to rounding, a corner of the cell is as far from the neighbours that made it as from the point. */
static const double SAME_DISTANCE = 1e-7;

/* Normals turned by more than this (107°) belong to the other side of a thin part. */
static const double LEAST_COSINE = -0.3;

/* The neighbours in the tangent plane, about the point. */
typedef struct outlook {
  size_t n;
  double places[N_NEIGHBOURS][2];
  uint32_t slots[N_NEIGHBOURS];
} outlook;

/* Two axes perpendicular to a unit normal. */
static void make_axes(const double n[3], double u[3], double v[3]) {
  int least = fabs(n[0]) <= fabs(n[1]) ? (fabs(n[0]) <= fabs(n[2]) ? 0 : 2) : (fabs(n[1]) <= fabs(n[2]) ? 1 : 2);
  double along = n[least], length2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (axis == least ? 1.0 : 0.0) - along * n[axis];
    length2 += u[axis] * u[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    u[axis] /= sqrt(length2);
  conic_cross(n, u, v);
}

static int is_other_side(float *const normals[3], uint32_t slot, uint32_t other) {
  double along = 0.0;
  for (int axis = 0; axis < 3 && normals; axis++)
    along += (double)normals[axis][slot] * (double)normals[axis][other];
  return along < LEAST_COSINE;
}

/* Lays the neighbours into the plane at their distance in space, so that those on the other side of a bend or of a thin
 * part do not come near. */
static void look_around(const conic_neighbours *tree, float *const normals[3], uint32_t slot, const double normal[3],
                        double limit, outlook *around) {
  uint32_t slots[N_NEIGHBOURS];
  double distances2[N_NEIGHBOURS], center[3], u[3], v[3];
  conic_vector_at(tree->position, slot, center);
  size_t n = conic_neighbours_nearest(tree, center, slot, N_NEIGHBOURS, limit * limit, slots, distances2);
  make_axes(normal, u, v);
  around->n = 0;
  for (size_t i = 0; i < n; i++) {
    double offset[3];
    for (int axis = 0; axis < 3; axis++)
      offset[axis] = (double)tree->position[axis][slots[i]] - center[axis];
    double x = conic_dot(offset, u), y = conic_dot(offset, v), flat2 = x * x + y * y;
    if (!(flat2 > 0.25 * distances2[i]) || is_other_side(normals, slot, slots[i]))
      continue; /* above or below: another sheet */
    double stretch = sqrt(distances2[i] / flat2);
    around->places[around->n][0] = x * stretch;
    around->places[around->n][1] = y * stretch;
    around->slots[around->n++] = slots[i];
  }
}

/* The neighbours on the circle about a corner of the cell, counter-clockwise about the point. */
static size_t find_touching(const outlook *around, const double corner[2], double radius2,
                            size_t touching[N_NEIGHBOURS]) {
  size_t n = 0;
  for (size_t i = 0; i < around->n; i++) {
    const double *place = around->places[i];
    double x = place[0] - corner[0], y = place[1] - corner[1];
    if (!(fabs(x * x + y * y - radius2) <= SAME_DISTANCE * radius2))
      continue;
    size_t at = n++;
    for (; at > 0; at--) {
      const double *before = around->places[touching[at - 1]];
      if (before[0] * place[1] - before[1] * place[0] > 0.0)
        break;
      touching[at] = touching[at - 1];
    }
    touching[at] = i;
  }
  return n;
}

static void add_pair(const outlook *around, size_t first, size_t second, conic_fan *fan) {
  const double *a = around->places[first], *b = around->places[second];
  uint32_t pair[2] = {around->slots[first], around->slots[second]};
  if (!(a[0] * b[1] - a[1] * b[0] > 0.0))
    return;
  for (int i = 0; i < fan->n; i++)
    if (fan->pairs[i][0] == pair[0] && fan->pairs[i][1] == pair[1])
      return;
  if (fan->n < CONIC_FAN_TRIANGLES)
    memcpy(fan->pairs[fan->n++], pair, sizeof pair);
}

void conic_fan_find(const conic_neighbours *tree, float *const normals[3], uint32_t slot, const double normal[3],
                    double most, conic_fan *fan) {
  outlook around;
  conic_voronoi_cell cell;
  fan->n = 0;
  look_around(tree, normals, slot, normal, 2.0 * most, &around);
  conic_voronoi_cell_begin(&cell, 2.0 * most);
  for (size_t i = 0; i < around.n; i++)
    conic_voronoi_cell_cut(&cell, around.places[i][0], around.places[i][1]);
  for (int i = 0; i < cell.n_corners; i++) {
    size_t touching[N_NEIGHBOURS];
    double radius2 = cell.corners[i][0] * cell.corners[i][0] + cell.corners[i][1] * cell.corners[i][1];
    if (!(radius2 <= most * most))
      continue;
    size_t n = find_touching(&around, cell.corners[i], radius2, touching);
    for (size_t k = 0; k + 1 < n; k++)
      add_pair(&around, touching[k], touching[k + 1], fan);
  }
}
