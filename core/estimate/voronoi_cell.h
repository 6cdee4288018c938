/* A point's Voronoi cell in its tangent plane, cut off at a radius. */
#pragma once

enum { CONIC_CELL_SIDES = 16, CONIC_CELL_CORNERS = CONIC_CELL_SIDES + 64 };

/* A convex polygon around the origin, counter-clockwise. Each cut adds at most one corner, so there is room for 64. */
typedef struct conic_voronoi_cell {
  int n_corners;
  double corners[CONIC_CELL_CORNERS][2];
  double greatest2; /* squared distance of the farthest corner */
} conic_voronoi_cell;

/* The regular polygon with corners at `radius`. */
void conic_voronoi_cell_begin(conic_voronoi_cell *cell, double radius);

/* Cuts off the part that is nearer to (x, y) than to the origin. (x, y) must not be the origin. */
void conic_voronoi_cell_cut(conic_voronoi_cell *cell, double x, double y);

double conic_voronoi_cell_area(const conic_voronoi_cell *cell);
