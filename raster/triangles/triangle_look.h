/* What a triangle looks like within a block of pixels: its attributes, ready to be evaluated a pixel at a time. */
#pragma once

#include "raster/triangles/triangle_frame.h"

typedef struct conic_triangle_look {
  conic_affine iz, first, second; /* inverse depth; the weights of the record's second and third corner, times theirs */
  float iz_far, iz_near;
  int is_piece;
  float at[3][2];               /* of a piece: its corners' weights, the first's and the others' differences from it */
  float color[3][3];            /* the first corner's, and the second's and third's differences from it; of all below */
  int has_normals;              /* else the face's */
  float normal[3][3];           /* in world coordinates, of any length */
  float face[3];                /* unit, of either side */
  float side;                   /* of the face on which the corners' normals lie, taken together: its sign */
  const conic_texture *texture; /* null: none */
  float uv[3][2];
} conic_triangle_look;

/* Of the record in the block whose first pixel is (x, y). */
void conic_triangle_look_at(const conic_triangle_frame *frame, const conic_triangle_record *record, int x, int y,
                            conic_triangle_look *look);
