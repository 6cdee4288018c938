#include "core/estimate/voronoi_cell.h"

#include <string.h>

/* Cosines of 0°, 22.5°, 45°, 67.5° and 90°. */
static const double COSINES[5] = {1.0, 0.92387953251128674, 0.70710678118654752, 0.38268343236508977, 0.0};

typedef double conic_corner __attribute__((vector_size(16)));

void conic_voronoi_cell_begin(conic_voronoi_cell *cell, double radius) {
  cell->n_corners = CONIC_CELL_SIDES;
  for (int i = 0; i < 4; i++) {
    double x = radius * COSINES[i], y = radius * COSINES[4 - i];
    const double quarter[4][2] = {{x, y}, {-y, x}, {-x, -y}, {y, -x}};
    for (int turn = 0; turn < 4; turn++)
      memcpy(cell->corners[4 * turn + i], quarter[turn], sizeof quarter[turn]);
  }
  cell->greatest2 = radius * radius;
}

/* Nothing here branches on where single corners lie, which cannot be foreseen. */
void conic_voronoi_cell_cut(conic_voronoi_cell *cell, double x, double y) {
  double beyond[CONIC_CELL_CORNERS + 1], parts[CONIC_CELL_CORNERS]; /* the bisector; beyond[0] is the last corner's */
  double half2 = 0.5 * (x * x + y * y);
  const int n = cell->n_corners;
  int n_beyond = 0;
  /* Corners no farther than half way can't lie beyond the bisector. */
  if (0.5 * half2 >= cell->greatest2)
    return;
  for (int i = 0; i < n; i++) {
    beyond[i + 1] = cell->corners[i][0] * x + cell->corners[i][1] * y - half2;
    n_beyond += beyond[i + 1] > 0.0;
  }
  if (n_beyond == 0)
    return;
  beyond[0] = beyond[n];
  for (int i = 0; i < n; i++)
    parts[i] = beyond[i] / (beyond[i] - beyond[i + 1]);
  conic_corner left[2 * CONIC_CELL_CORNERS], last, here;
  memcpy(&last, cell->corners[n - 1], sizeof last);
  int n_left = 0, was_beyond = beyond[0] > 0.0;
  for (int i = 0; i < n; i++) {
    int is_beyond = beyond[i + 1] > 0.0;
    memcpy(&here, cell->corners[i], sizeof here);
    left[n_left] = last + parts[i] * (here - last);
    n_left += was_beyond != is_beyond;
    left[n_left] = here;
    n_left += !is_beyond;
    was_beyond = is_beyond;
    last = here;
  }
  cell->n_corners = n_left < CONIC_CELL_CORNERS ? n_left : CONIC_CELL_CORNERS;
  double greatest2 = 0.0;
  for (int i = 0; i < cell->n_corners; i++) {
    double distance2 = left[i][0] * left[i][0] + left[i][1] * left[i][1];
    memcpy(cell->corners[i], &left[i], sizeof left[i]);
    greatest2 = distance2 > greatest2 ? distance2 : greatest2;
  }
  cell->greatest2 = greatest2;
}

double conic_voronoi_cell_area(const conic_voronoi_cell *cell) {
  double twice = 0.0;
  for (int i = 0; i < cell->n_corners; i++) {
    const double *p = cell->corners[i], *q = cell->corners[i + 1 < cell->n_corners ? i + 1 : 0];
    twice += p[0] * q[1] - p[1] * q[0];
  }
  return 0.5 * twice;
}
