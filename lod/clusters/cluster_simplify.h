/* Simpler and simpler triangles for the clusters of a region, which are simplified together. */
#pragma once

#include "lod/clusters/cluster_seen.h"
#include "lod/mesh/face_tree.h"

enum { CONIC_MOST_TRIANGLE_LEVELS = 32 };

/* Triangles of the mesh's own vertices, or of moved ones. */
typedef struct conic_cluster_level {
  size_t n, n_borders;
  uint32_t (*corners)[3];
  uint32_t *face; /* of each: the face of the mesh that it came from */
  conic_cluster_border *borders;
  uint32_t stage;
  /* No vertex of the cluster, nor middle of an edge or a face, is farther from these triangles and those of the other
   * clusters' same stage beside them. Nor are the middles of these triangles, of their edges, and of the fans that they
   * become beside others, from the mesh; where the region is one, nor a grid of places on each triangle. */
  double error;
  conic_seen_change change; /* how colours of the cluster differ, in the root mean square */
} conic_cluster_level;

/* A vertex of the mesh that simplifying moved. It has another place and another normal, and all else of the original.
 */
typedef struct conic_moved_vertex {
  float at[3], normal[3];
  uint32_t original;
  uint32_t of_normal, next; /* private: the normal's number, and the next vertex there */
} conic_moved_vertex;

typedef struct conic_cluster_levels {
  int n; /* the first one is the next simpler than the mesh itself */
  size_t n_moved, moved_room;
  conic_moved_vertex *moved; /* corners from the number of the mesh's vertices on */
  conic_cluster_level levels[CONIC_MOST_TRIANGLE_LEVELS];
} conic_cluster_levels;

/* Memory that is kept from region to region. */
typedef struct conic_simplifier conic_simplifier;
conic_status conic_simplifier_create(conic_context *context, const conic_clustered_mesh *mesh,
                                     const conic_face_tree *tree, conic_simplifier **simplifier);
void conic_simplifier_destroy(conic_simplifier *simplifier);

/* How a region is simplified as one. */
typedef struct conic_region_as_one {
  size_t most_at_first; /* triangles of the first level; 0: the region is not one */
  double most_error;    /* above 0: all for one picture, and quickly: each level has half as many as the one before, and
                           none comes after one that errs by more */
} conic_region_as_one;

/* Begins a region: the clusters [begin, end). Their levels are levels[0 …], which the calls below fill in. The caller
 * ends the region, and releases the levels, on failure too. Errors: MEMORY.
 *
 * Edges are drawn together, the cheapest first by their quadrics (HQP §3.2.1), each onto one of its ends, so that only
 * vertices of the mesh stay. Each stage has half as many triangles as the one before, as far as that is possible. A
 * cluster has a level of a stage that is much simpler than its last level. Vertices between the ends of chains may go
 * along them; their slots then tell the last stage that has them. Vertices on an open border may go along that, held by
 * planes that stand on its edges (§3.2.4). Vertices of another region stay. No cluster loses all of its triangles.
 *
 * A region with most_at_first above 0 is simplified as one. To the mesh it is one cluster, without chains; its faces
 * are in pieces [begin, end), which are only measured one by one. All levels are levels[0]'s. The first has at most so
 * many triangles, and each further one five sixths of the one before. What stays of an edge moves to where the quadric
 * is least (Garland and Heckbert 1997). If the mesh has colours, all vertices move along their normals at each stage,
 * to fit the mesh's faces best by least squares. So do normals of corners. All vertices of these levels are moved ones.
 */
conic_status conic_region_begin(conic_simplifier *simplifier, conic_cluster_chains *chains, uint32_t begin,
                                uint32_t end, conic_region_as_one as_one, conic_cluster_levels *levels);

/* Takes the stage that was measured, if any, as levels, and goes on to the next. *n_clusters are to be measured before
 * that is taken, twice where the region is one; 0: all is done. Errors: MEMORY. */
conic_status conic_region_advance(conic_simplifier *simplifier, uint32_t *n_clusters);

/* Measures one of them, the region's i-th. Clusters may be measured at the same time. */
void conic_region_measure(conic_simplifier *simplifier, uint32_t cluster);

/* Leaves the region: no place has a number any more. */
void conic_region_end(conic_simplifier *simplifier);

void conic_cluster_levels_release(conic_context *context, conic_cluster_levels *levels);
