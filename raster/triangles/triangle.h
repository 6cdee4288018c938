/* Triangles on the screen: what a frame keeps of each, and the arithmetic that says which samples it covers, shared by
 * all that must agree in every bit (docs/reference/picture.md, Triangles).
 *
 * Vertices are snapped to 1/256 pixel; from there on coverage is exact, in integers. */
#pragma once

#include <math.h>
#include <stdint.h>

#include "raster/project/projected.h"
#include "raster/tiles/band.h"

/* Stands before the type of whatever a frame or a set of triangles holds. A device has a memory of its own for it,
 * which it names here (opencl/triangle_set.cl). */
#ifndef CONIC_STORED
#define CONIC_STORED
#endif

#define CONIC_SUBPIXELS 256
#define CONIC_SUBPIXEL_BITS 8

/* No projected vertex is farther out than so many pixels: what is, is clipped there. Differences of snapped coordinates
 * then stay below 2²⁶, their products below 2⁵³. */
#define CONIC_GUARD_PX 131000

/* Why a vertex has no place on the screen. A triangle all of whose vertices share a reason is not seen. */
enum {
  CONIC_VERTEX_NEAR = 1,
  CONIC_VERTEX_LEFT = 2,
  CONIC_VERTEX_RIGHT = 4,
  CONIC_VERTEX_ABOVE = 8,
  CONIC_VERTEX_BELOW = 16,
  CONIC_VERTEX_BAD = 32 /* not finite, or so far out or near that floats do not hold it: no triangle with it is drawn */
};

/* How far inside a plane a point of camera space is, scaled by its depth: near, then the four sides of the guard band.
 */
enum { CONIC_TRIANGLE_PLANES = 5 };

static inline double conic_triangle_inside(const conic_view *view, int i_plane, const double p[3]) {
  const double guard = (double)CONIC_GUARD_PX;
  switch (i_plane) {
  case 0:
    return p[2] - view->near_z;
  case 1:
    return view->fx * p[0] + (guard + view->cx) * p[2];
  case 2:
    return (guard - view->cx) * p[2] - view->fx * p[0];
  case 3:
    return view->fy * p[1] + (guard + view->cy) * p[2];
  default:
    return (guard - view->cy) * p[2] - view->fy * p[1];
  }
}

/* What floats hold with room to spare. */
#define CONIC_LEAST_IZ 1e-30
#define CONIC_GREATEST_IZ 1e30

typedef struct conic_screen_vertex {
  int32_t x, y;     /* in 1/256 px; 0 where it has no place */
  float iz;         /* 1/z */
  uint32_t outside; /* bits of CONIC_VERTEX_… */
} conic_screen_vertex;

#define CONIC_NO_PIECE UINT32_MAX

/* A triangle, or a piece of one that was clipped, wound so that its area is positive. A cache line. */
typedef struct conic_triangle_record {
  int32_t x[3], y[3];
  float iz[3];
  uint32_t index;      /* in the set */
  uint32_t piece;      /* of the frame's pieces, or CONIC_NO_PIECE */
  uint32_t is_swapped; /* its second and third corner have changed places */
  double part;         /* one over twice its area */
  conic_box box;       /* the pixels whose centres its box holds, within the image */
} conic_triangle_record;

/* Where a piece's corners lie in the triangle: weights of its second and third corner. */
typedef struct conic_triangle_piece {
  float at[3][2];
} conic_triangle_piece;

/* An edge as a function of the place: inside where it is not negative. e(x, y) = a·x + b·y + c is 0 on the edge from
 * corner k + 1 to corner k + 2, and the area's double at corner k. */
typedef struct conic_triangle_edges {
  int64_t a[3], b[3], c[3];
  int64_t bias[3]; /* 0; or -1 where samples on the edge are not the triangle's: it is neither top nor left */
} conic_triangle_edges;

static inline void conic_triangle_edges_of(const conic_triangle_record *record, conic_triangle_edges *edges) {
  for (int k = 0; k < 3; k++) {
    int from = k == 2 ? 0 : k + 1, to = k == 0 ? 2 : k - 1;
    int64_t a = (int64_t)record->y[from] - record->y[to], b = (int64_t)record->x[to] - record->x[from];
    edges->a[k] = a;
    edges->b[k] = b;
    edges->c[k] = -(a * record->x[from] + b * record->y[from]);
    edges->bias[k] = a > 0 || (a == 0 && b > 0) ? 0 : -1;
  }
}

/* The edge's value at the centre of a pixel. */
static inline int64_t conic_triangle_edge_at(const conic_triangle_edges *edges, int k, int x, int y) {
  enum { HALF = CONIC_SUBPIXELS / 2 };
  return edges->a[k] * ((int64_t)x * CONIC_SUBPIXELS + HALF) + edges->b[k] * ((int64_t)y * CONIC_SUBPIXELS + HALF) +
         edges->c[k];
}

/* A value of an edge in whole steps from pixel to pixel: what is not negative stays so. Beyond what a block's pixels
 * can change it is cut off. */
static inline int32_t conic_triangle_steps(int64_t value) {
  const int64_t most = INT64_C(1) << 30;
  value >>= CONIC_SUBPIXEL_BITS;
  return (int32_t)(value < -most ? -most : value > most ? most : value);
}

/* A function that is affine on the screen, from a block's first pixel on. */
typedef struct conic_affine {
  float at, by_x, by_y;
} conic_affine;

static inline float conic_affine_at(const conic_affine *f, float column, float row) {
  return (f->at + f->by_y * row) + f->by_x * column;
}

/* The inverse depth: at the block's first pixel from the exact edges, so that it is as precise for a sliver as for any
 * other; and within the block by its gradient. */
static inline conic_affine conic_triangle_depth(const conic_triangle_record *record, const conic_triangle_edges *edges,
                                                int64_t e1, int64_t e2) {
  double d1 = (double)record->iz[1] - (double)record->iz[0], d2 = (double)record->iz[2] - (double)record->iz[0];
  double step = record->part * (double)CONIC_SUBPIXELS;
  conic_affine iz = {
      (float)((double)record->iz[0] + ((double)e1 * d1 + (double)e2 * d2) * record->part),
      (float)(((double)edges->a[1] * d1 + (double)edges->a[2] * d2) * step),
      (float)(((double)edges->b[1] * d1 + (double)edges->b[2] * d2) * step),
  };
  return iz;
}

/* The range of the corners' inverse depths, which no rounding leaves. */
static inline float conic_triangle_far(const conic_triangle_record *record) {
  float least = record->iz[0] < record->iz[1] ? record->iz[0] : record->iz[1];
  return least < record->iz[2] ? least : record->iz[2];
}

static inline float conic_triangle_near(const conic_triangle_record *record) {
  float greatest = record->iz[0] > record->iz[1] ? record->iz[0] : record->iz[1];
  return greatest > record->iz[2] ? greatest : record->iz[2];
}

/* A pixel's sample: whether the triangle covers it, and then its inverse depth there. */
static inline int conic_triangle_sample(const conic_triangle_record *record, const conic_triangle_edges *edges, int x,
                                        int y, float *iz) {
  int column = x % CONIC_BLOCK_EDGE, row = y % CONIC_BLOCK_EDGE;
  int64_t e[3];
  for (int k = 0; k < 3; k++) {
    e[k] = conic_triangle_edge_at(edges, k, x - column, y - row);
    if (e[k] + (edges->a[k] * column + edges->b[k] * row) * CONIC_SUBPIXELS + edges->bias[k] < 0)
      return 0;
  }
  const conic_affine depth = conic_triangle_depth(record, edges, e[1], e[2]);
  float iz_far = conic_triangle_far(record), iz_near = conic_triangle_near(record);
  float at = conic_affine_at(&depth, (float)column, (float)row);
  at = at > iz_far ? at : iz_far;
  *iz = at < iz_near ? at : iz_near;
  return 1;
}

/* The inverse depth that hides what lies farther behind a triangle than ε, along the ray (dx, dy, 1). */
static inline float conic_triangle_hides(float epsilon, float iz, float dx, float dy) {
  return iz * (1.0f / (1.0f + epsilon * iz / sqrtf((dx * dx + dy * dy) + 1.0f)));
}
