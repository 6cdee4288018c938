#include "core/estimate/voronoi_cell.h"

#include <string.h>

/* Cosines of 0°, 22.5°, 45°, 67.5° and 90°. */
static const double COSINES[5] = {1.0, 0.92387953251128674, 0.70710678118654752, 0.38268343236508977, 0.0};

static void measure_cell(conic_voronoi_cell *cell) {
  cell->greatest2 = 0.0;
  for (int i = 0; i < cell->n_corners; i++) {
    double x = cell->corners[i][0], y = cell->corners[i][1], distance2 = x * x + y * y;
    cell->greatest2 = distance2 > cell->greatest2 ? distance2 : cell->greatest2;
  }
}

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

void conic_voronoi_cell_cut(conic_voronoi_cell *cell, double x, double y) {
  double corners[CONIC_CELL_CORNERS][2], half2 = 0.5 * (x * x + y * y);
  /* Corners no farther than half way can't lie beyond the bisector. */
  if (0.5 * half2 >= cell->greatest2)
    return;
  int n_corners = 0, last = cell->n_corners - 1;
  double before = cell->corners[last][0] * x + cell->corners[last][1] * y - half2;
  for (int i = 0; i < cell->n_corners; last = i++) {
    double here = cell->corners[i][0] * x + cell->corners[i][1] * y - half2;
    if ((before > 0.0) != (here > 0.0) && n_corners < CONIC_CELL_CORNERS) {
      double t = before / (before - here);
      corners[n_corners][0] = cell->corners[last][0] + t * (cell->corners[i][0] - cell->corners[last][0]);
      corners[n_corners++][1] = cell->corners[last][1] + t * (cell->corners[i][1] - cell->corners[last][1]);
    }
    if (!(here > 0.0) && n_corners < CONIC_CELL_CORNERS) {
      corners[n_corners][0] = cell->corners[i][0];
      corners[n_corners++][1] = cell->corners[i][1];
    }
    before = here;
  }
  memcpy(cell->corners, corners, (size_t)n_corners * sizeof corners[0]);
  cell->n_corners = n_corners;
  measure_cell(cell);
}

double conic_voronoi_cell_area(const conic_voronoi_cell *cell) {
  double twice = 0.0;
  for (int i = 0; i < cell->n_corners; i++) {
    const double *p = cell->corners[i], *q = cell->corners[i + 1 < cell->n_corners ? i + 1 : 0];
    twice += p[0] * q[1] - p[1] * q[0];
  }
  return 0.5 * twice;
}
