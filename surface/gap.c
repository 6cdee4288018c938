#include "surface/gap.h"

#include <math.h>
#include <string.h>

#include "core/base/vectors.h"
#include "core/estimate/voronoi_cell.h"

enum { N_NEIGHBOURS = 32 };

/* Corners are as far from the neighbours that made them as from the point, up to rounding. */
static const double SAME_DISTANCE = 1e-7;

/* The cosine of the widest angle, seen from a gap's centre, between one neighbour and the next: 150°. At a border the
 * outer side is open. */
static const double WIDEST_ANGLE = -0.86602540378443865;

/* Neighbours in the tangent plane. */
typedef struct outlook {
  size_t n;
  double places[N_NEIGHBOURS + 1][2]; /* the point itself, at the origin, is the last */
  double u[3], v[3];
} outlook;

/* Two axes across a unit normal. */
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

/* Neighbours as they lie in the plane, at their distance in space: those on the other side of a bend or of a thin part
 * are not drawn near by being flattened. */
static void look_around(const conic_neighbours *tree, uint32_t slot, const double center[3], const double normal[3],
                        double limit, outlook *around) {
  uint32_t slots[N_NEIGHBOURS];
  double distances2[N_NEIGHBOURS];
  size_t n = conic_neighbours_nearest(tree, center, slot, N_NEIGHBOURS, limit * limit, slots, distances2);
  make_axes(normal, around->u, around->v);
  around->n = 0;
  for (size_t i = 0; i < n; i++) {
    double x = 0.0, y = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double offset = (double)tree->position[axis][slots[i]] - center[axis];
      x += offset * around->u[axis];
      y += offset * around->v[axis];
    }
    double flat2 = x * x + y * y;
    if (!(flat2 > 0.25 * distances2[i]))
      continue; /* above or below: another sheet */
    double stretch = sqrt(distances2[i] / flat2);
    around->places[around->n][0] = x * stretch;
    around->places[around->n++][1] = y * stretch;
  }
}

/* Whether a corner is the centre of a circle through the point and two others: the cell's first outline has corners
 * too.
 */
static int is_vertex(const outlook *around, const double corner[2], double radius2) {
  int n_touching = 0;
  for (size_t i = 0; i < around->n; i++) {
    double x = around->places[i][0] - corner[0], y = around->places[i][1] - corner[1];
    n_touching += fabs(x * x + y * y - radius2) <= SAME_DISTANCE * radius2;
  }
  return n_touching >= 2;
}

/* Whether the neighbours within twice the radius surround the centre. */
static int is_surrounded(outlook *around, const double corner[2], double radius2) {
  around->places[around->n][0] = around->places[around->n][1] = 0.0;
  for (size_t i = 0; i <= around->n; i++) {
    double x = around->places[i][0] - corner[0], y = around->places[i][1] - corner[1], length2 = x * x + y * y;
    int has_next = 0;
    if (length2 > 4.0 * radius2)
      continue;
    for (size_t j = 0; j <= around->n && !has_next; j++) {
      double to_x = around->places[j][0] - corner[0], to_y = around->places[j][1] - corner[1];
      double to_length2 = to_x * to_x + to_y * to_y;
      has_next = to_length2 <= 4.0 * radius2 && x * to_y - y * to_x > 0.0 &&
                 x * to_x + y * to_y >= WIDEST_ANGLE * sqrt(length2 * to_length2);
    }
    if (!has_next)
      return 0;
  }
  return 1;
}

void conic_gap_find(const conic_neighbours *tree, uint32_t slot, const double center[3], const double normal[3],
                    double least, double most, conic_gap *gap) {
  outlook around;
  conic_voronoi_cell cell;
  double widest2 = least * least;
  const double *found = NULL;
  gap->radius = 0.0;
  if (!(most > least))
    return;
  look_around(tree, slot, center, normal, 4.0 * most, &around);
  conic_voronoi_cell_begin(&cell, 2.0 * most);
  for (size_t i = 0; i < around.n; i++)
    conic_voronoi_cell_cut(&cell, around.places[i][0], around.places[i][1]);
  for (int i = 0; i < cell.n_corners; i++) {
    const double *corner = cell.corners[i];
    double radius2 = corner[0] * corner[0] + corner[1] * corner[1];
    if (radius2 > widest2 && radius2 <= most * most && is_vertex(&around, corner, radius2) &&
        is_surrounded(&around, corner, radius2)) {
      widest2 = radius2;
      found = corner;
    }
  }
  if (!found)
    return;
  gap->radius = sqrt(widest2);
  for (int axis = 0; axis < 3; axis++)
    gap->center[axis] = center[axis] + found[0] * around.u[axis] + found[1] * around.v[axis];
}
