/* Clusters side by side at different levels: vertices that one has along their border, and the other has not, are put
 * in. */
#ifndef CONIC_HYBRID_STITCH_H
#define CONIC_HYBRID_STITCH_H

#include "lod/hybrid/model/hybrid_chunks.h"

/* A cluster that is not drawn: nothing has to fit it. */
#define CONIC_HYBRID_HIDDEN UINT32_MAX

/* Where a level's triangles lie in those of a picture, and where the picture's next triangle and vertex go. */
typedef struct conic_hybrid_stitching {
  const conic_hybrid *hybrid;
  uint32_t cluster;
  const conic_hybrid_level *level;
  const uint32_t *stages; /* of each cluster as drawn, 0: with all vertices of its borders; or HIDDEN */
  conic_triangles *to;
  size_t first_triangle;      /* of the level */
  size_t triangle, vertex;    /* the next */
  conic_hybrid_frame frame;   /* private */
  conic_hybrid_vertices ends; /* private */
} conic_hybrid_stitching;

/* How many vertices are put into a level of a cluster; each makes one more triangle. The cluster's frame must be there.
 */
size_t conic_hybrid_count_stitches(const conic_hybrid *hybrid, uint32_t cluster, const conic_hybrid_level *level,
                                   const uint32_t *stages);

/* Fans the triangles along the level's borders to the vertices that the clusters across still have. The level's own
 * corners, clusters and materials are there already. Positions, normals, colours and texture coordinates of the new
 * vertices are filled in. The cluster's frame and ends must be there. */
void conic_hybrid_stitch(conic_hybrid_stitching *stitching);

#endif
