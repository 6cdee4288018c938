/* Darts: places in triangles that no point is near, found by trying a fine lattice of each triangle in turn. */
#ifndef CONIC_DARTS_H
#define CONIC_DARTS_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

/* Three corners with their unit normals, and its own; `is_bent` where a place in the triangle is lifted to where the
 * corners' normals say that the surface is. */
typedef struct conic_dart_triangle {
  double corners[3][3], normals[3][3], across[3];
  int is_bent;
} conic_dart_triangle;

typedef struct conic_dart {
  double place[3];
  double shares[2]; /* of the corners 0 and 1; that of corner 2 is the rest */
  uint32_t triangle;
} conic_dart;

/* What lies near a place: a hash table of cells whose sides are two radii. */
typedef struct conic_dart_board {
  conic_context *context;
  double radius, inverse_side;
  double (*places)[3];
  uint32_t *next, *heads; /* lists of places by cell; 1 + number, 0: the end */
  size_t n, room, n_heads;
  uint32_t last; /* the place that covered the last one asked for */
} conic_dart_board;

/* Errors: MEMORY. */
conic_status conic_dart_board_begin(conic_context *context, double radius, size_t n_expected, conic_dart_board *board);
void conic_dart_board_end(conic_dart_board *board);
/* Errors: MEMORY. */
conic_status conic_dart_board_add(conic_dart_board *board, const double place[3]);
/* Whether a place of the board is nearer than its radius. */
int conic_dart_board_covers(conic_dart_board *board, const double place[3]);

/* A list that grows. */
typedef struct conic_darts {
  conic_dart *list;
  size_t n, room;
} conic_darts;

/* The greatest distance of a place in the triangle from its nearest corner, at most. */
double conic_dart_reach(const conic_dart_triangle *triangle);

/* Throws a dart at each place of the triangle's lattice that the board does not cover, and adds it to the board; no
 * more than `limit` in all. Errors: MEMORY. */
conic_status conic_darts_throw(conic_dart_board *board, const conic_dart_triangle *triangle, uint32_t number,
                               size_t limit, conic_darts *darts);

#endif
