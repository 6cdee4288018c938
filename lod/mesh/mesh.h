/* Triangles as the steps of hybrid models look at them: which lie side by side, and which are of use. */
#pragma once

#include "conic/triangles.h"
#include "core/base/base.h"
#include "core/base/triangle_distance.h"

/* Borrowed arrays; every index of a face is below n_vertices. */
typedef struct conic_mesh {
  size_t n_vertices, n_faces;
  const float *position[3];
  const uint32_t (*faces)[3];
} conic_mesh;

/* Two faces that share one edge or more. `length` is that of all of these. */
typedef struct conic_joint {
  uint32_t faces[2];
  double length;
} conic_joint;

/* What a mesh has that a simple closed surface has not. */
typedef struct conic_mesh_oddities {
  size_t nan;      /* faces with a corner that is not finite: of no use */
  size_t zero;     /* faces whose corners are not three places: of no use */
  size_t welded;   /* vertices that lie where an earlier one lies */
  size_t open;     /* edges of one face */
  size_t crowded;  /* edges of more than two */
  size_t turned;   /* faces that were seen from the other side, so that neighbours agree */
  size_t twisted;  /* edges whose faces cannot be made to agree */
  size_t n_pieces; /* what hangs together */
} conic_mesh_oddities;

#define CONIC_OPEN_EDGE UINT32_MAX          /* there is no other face */
#define CONIC_CROWDED_EDGE (UINT32_MAX - 1) /* there are several */

typedef struct conic_adjacency {
  uint32_t *place;  /* of each vertex: the first vertex at the same position */
  int8_t *side;     /* of each face: 1; -1 where it is wound against its neighbours; 0 where it is of no use */
  uint32_t *across; /* of each edge, 3 · face + the corner where it begins: the same edge of the other face, or OPEN or
                       CROWDED */
  size_t n_joints;
  conic_joint *joints;
  conic_mesh_oddities oddities;
} conic_adjacency;

/* Finds the neighbours by position, so that seams of attributes part nothing. Errors: ARGUMENT (over 2³¹ faces),
 * MEMORY. On success the caller releases *adjacency; on failure it is empty. */
conic_status conic_adjacency_find(conic_context *context, const conic_mesh *mesh, conic_adjacency *adjacency);
void conic_adjacency_release(conic_context *context, conic_adjacency *adjacency);

static inline int conic_edge_is_shared(uint32_t across) {
  return across < CONIC_CROWDED_EDGE;
}

static inline void conic_mesh_corner(const conic_mesh *mesh, size_t i_face, int corner, double at[3]) {
  for (int axis = 0; axis < 3; axis++)
    at[axis] = (double)mesh->position[axis][mesh->faces[i_face][corner]];
}

/* --- distance from a face --- */

/* The squared distance of a place from a face of a mesh. */
static inline double conic_distance2_to_face(const conic_mesh *mesh, uint32_t face, const double at[3]) {
  double corners[3][3];
  for (int corner = 0; corner < 3; corner++)
    conic_mesh_corner(mesh, face, corner, corners[corner]);
  return conic_distance2_to_triangle(at, corners[0], corners[1], corners[2]);
}

/* --- one index a corner --- */

/* Gives *flat the triangles of `mesh`, which has been checked. Corners that share a place but differ in normal or
 * texture coordinates get vertices of their own. Vertices that no triangle uses go. Materials stay with `mesh`. The
 * caller releases *flat. Errors: ARGUMENT (over 2³¹ corners), MEMORY. */
conic_status conic_flat_mesh(conic_context *context, const conic_triangles *mesh, conic_triangles *flat);

/* Whether any of so many faces has three finite corners at three places. */
int conic_has_face(float *const position[3], const uint32_t (*corners)[3], size_t count);

/* Gives a mesh normals: with `is_smooth`, each vertex gets the mean of its faces'. Else a mesh without normals gets
 * normals that are round over edges up to the angle (degrees; 0: none). Errors: as conic_triangles_smooth's and
 * conic_triangles_crease's. */
conic_status conic_mesh_round(conic_context *context, int is_smooth, double crease_deg, conic_triangles *triangles);
