/* A mesh of any size, split by planes into cells of few faces, each with the faces about it. Meanwhile, vertices and
 * faces lie in files without names. */
#pragma once

#include "conic/triangles.h"

typedef struct conic_mesh_cells conic_mesh_cells;

/* In preorder. A node is a cell, or a plane across an axis: what is below the plane follows it, and what is above
 * begins at node `above`. */
typedef struct conic_cell_node {
  uint32_t above; /* 0: it is a cell */
  uint32_t cell;
  float at; /* the plane's place on its axis */
  int axis;
} conic_cell_node;

/* Reads a PLY and splits it into cells of about `most_faces`. The files lie beside `path`, which must outlive the
 * cells. The caller releases *cells, on failure too. Errors: INPUT, IO, MEMORY, CANCELLED. */
conic_status conic_mesh_cells_find(conic_context *context, const char *mesh, const char *path, size_t most_faces,
                                   conic_mesh_cells **cells);
void conic_mesh_cells_release(conic_mesh_cells *cells); /* null is allowed */

size_t conic_mesh_cells_count(const conic_mesh_cells *cells);
const conic_cell_node *conic_mesh_cells_tree(const conic_mesh_cells *cells);

/* Counts of the whole mesh. nan: faces with a corner that is not finite; zero: faces with fewer than three places. */
typedef struct conic_mesh_counts {
  size_t n_vertices, n_faces, nan, zero;
} conic_mesh_counts;

conic_mesh_counts conic_mesh_cells_counts(const conic_mesh_cells *cells);

/* Takes the n_own faces of a cell, and behind them those of other cells that share a place with them. There may be no
 * faces. The caller releases *mesh. Errors: IO, MEMORY. */
conic_status conic_mesh_cells_take(conic_mesh_cells *cells, size_t cell, conic_triangles *mesh, size_t *n_own);
