/* Darts: places in triangles without a point nearby, found by trying a fine lattice in each triangle. */
#pragma once

#include "core/base/base.h"

/* Three corners with their unit normals, and the triangle's own. If `is_bent`, places in the triangle are lifted to
 * where the corners' normals put the surface. */
typedef struct conic_dart_triangle {
  double corners[3][3], normals[3][3], across[3];
  int is_bent;
} conic_dart_triangle;

typedef struct conic_dart {
  double place[3];
  double shares[2]; /* of the corners 0 and 1; corner 2 has the rest */
  uint32_t triangle;
} conic_dart;

/* Finds what lies near a place: a hash table of cells with sides of two radii. */
typedef struct conic_dart_board {
  conic_context *context;
  double radius, inverse_side;
  double (*places)[3];
  uint32_t *next, *heads; /* lists of places by cell: 1 + number; 0: the end */
  size_t n, room, n_heads;
  uint32_t last; /* the place that covered the last query */
} conic_dart_board;

/* Errors: MEMORY. */
conic_status conic_dart_board_begin(conic_context *context, double radius, size_t n_expected, conic_dart_board *board);
void conic_dart_board_end(conic_dart_board *board);
/* Errors: MEMORY. */
conic_status conic_dart_board_add(conic_dart_board *board, const double place[3]);
/* Whether a place of the board is nearer than the board's radius. */
int conic_dart_board_covers(conic_dart_board *board, const double place[3]);

/* A list that grows. */
typedef struct conic_darts {
  conic_dart *list;
  size_t n, room;
} conic_darts;

/* An upper bound of the distance from a place in the triangle to its nearest corner. */
double conic_dart_reach(const conic_dart_triangle *triangle);

/* Throws a dart at each place of the triangle's lattice that the board does not cover, and adds it to the board; at
 * most `limit` in all. Errors: MEMORY. */
conic_status conic_darts_throw(conic_dart_board *board, const conic_dart_triangle *triangle, uint32_t number,
                               size_t limit, conic_darts *darts);
