/* Simpler and simpler triangles for the clusters of a region, which are simplified together. */
#ifndef CONIC_CLUSTER_SIMPLIFY_H
#define CONIC_CLUSTER_SIMPLIFY_H

#include "lod/clusters/cluster_chains.h"
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
  double error; /* no vertex of the cluster, nor middle of an edge or a face, is farther from these triangles, those of
                   the other clusters of the same stage beside them; nor are the middles of these and of their edges
                   from the mesh, nor those of the fans that they become beside others; of what is one, a grid of
                   places on each triangle */
  conic_seen_change change; /* how colours of the cluster differ, in the root mean square */
} conic_cluster_level;

/* A vertex of the mesh as simplifying moved it: it has another place and another normal, and all else from there. */
typedef struct conic_moved_vertex {
  float at[3], normal[3];
  uint32_t original;
  uint32_t of_normal, next; /* private: which of the normals that is, and what else lies there */
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

/* Draws edges together, the cheapest first by their quadrics (HQP §3.2.1), each onto one of its ends: what stays are
 * vertices of the mesh. Each stage has half as many triangles as the one before, as far as that is possible; a cluster
 * has a level of it where that is much simpler than its last. Vertices between the ends of chains may go along them,
 * and their slots then tell the last stage that has them; those on an open border along that, held by planes that stand
 * on its edges (§3.2.4). Vertices of another region stay, and of no cluster all triangles go. Region: the clusters
 * [begin, end), whose levels are levels[0 …], filled in by what follows. The caller ends the region, and releases the
 * levels, on failure too. Errors: MEMORY.
 * A region of which `most_at_first` is above 0 is simplified as one: the mesh says that there is but one cluster, so
 * that there are no chains, and its faces in pieces [begin, end), which are only measured one by one. All levels are
 * levels[0]'s. The first has at most so many triangles, and each further one five sixths of the one before. What stays
 * of an edge moves to where the quadric is least (Garland and Heckbert 1997); if the mesh has colours, all vertices
 * move along their normals at each stage, to fit the mesh's faces best by least squares. So do normals of corners. All
 * vertices of these levels are moved ones. */
conic_status conic_region_begin(conic_simplifier *simplifier, conic_cluster_chains *chains, uint32_t begin,
                                uint32_t end, size_t most_at_first, conic_cluster_levels *levels);

/* Takes the stage that was measured, if any, as levels, and goes on to the next: n_clusters are to be measured before
 * it is taken, those of what is one twice. None where all is done. Errors: MEMORY. */
conic_status conic_region_advance(conic_simplifier *simplifier, uint32_t *n_clusters);

/* Measures one of them, the region's i-th. Clusters may be measured at the same time. */
void conic_region_measure(conic_simplifier *simplifier, uint32_t cluster);

/* The region is left: no place has a number any more. */
void conic_region_end(conic_simplifier *simplifier);

void conic_cluster_levels_release(conic_context *context, conic_cluster_levels *levels);

#endif
