/* Triangles of the oracle: placed on the screen, and evaluated at pixels by plain double arithmetic, which is exact for
 * the edges. */
#pragma once

#include "oracle/oracle_pixel.h"

/* A triangle, or a piece of one that is clipped, as it is drawn. */
typedef struct oracle_triangle {
  double x[3], y[3]; /* whole numbers of 1/256 px */
  double iz[3];
  double at[3][2]; /* the corners' weights of the triangle's second and third */
  double box[2][2];
  uint32_t index;
  int is_unsure;      /* a corner is so near the middle between two places that rounding may put it at either;
                         of who computes places in float, so is every one */
  double depth_error; /* of iz, a share of it: of who computes depths in float */
} oracle_triangle;

typedef struct oracle_mesh {
  const conic_triangles *triangles; /* null: none */
  const conic_render_options *options;
  double epsilon;
  uint32_t first_id;
  size_t n;
  oracle_triangle *pieces;
} oracle_mesh;

/* Places the triangles of the view; `scene` must be that of the drawing's splats. Errors: MEMORY. */
conic_status conic_oracle_mesh_create(conic_context *context, const conic_drawing *drawing, const oracle_scene *scene,
                                      const conic_render_options *options, oracle_mesh *mesh);
void conic_oracle_mesh_release(conic_context *context, oracle_mesh *mesh);

/* What a fragment needs of a splat, for the triangle that a pixel sees. */
typedef struct oracle_seen_triangle {
  oracle_splat splat;
  oracle_candidate candidate;
  int is_precise; /* colour and normal are held to their bounds */
} oracle_seen_triangle;

/* The nearest of the pieces `which` at a pixel: 0 where there is none. `*doubt` says why it may be another, or none. */
int conic_oracle_mesh_at(const oracle_mesh *mesh, const oracle_view *view, const uint32_t *which, size_t n, int column,
                         int row, oracle_seen_triangle *seen, oracle_fragment *fragment, unsigned *doubt);

enum { ORACLE_MAX_RIVALS = 16 };

/* The pieces that may be the nearest there, once rounding has decided; *may_be_none where none of them may be. Of more
 * than ORACLE_MAX_RIVALS the first are given, and *is_crowded is set. */
typedef struct oracle_rivals {
  int n, may_be_none, is_crowded;
  oracle_seen_triangle seen[ORACLE_MAX_RIVALS];
  oracle_fragment fragments[ORACLE_MAX_RIVALS];
} oracle_rivals;
void conic_oracle_mesh_rivals(const oracle_mesh *mesh, const oracle_view *view, const uint32_t *which, size_t n,
                              int column, int row, oracle_rivals *rivals);
