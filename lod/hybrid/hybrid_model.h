/* A hybrid model as it is in memory. */
#ifndef CONIC_HYBRID_MODEL_H
#define CONIC_HYBRID_MODEL_H

#include "conic/hybrid.h"
#include "core/base/vectors.h"
#include "core/files/mapping.h"
#include "lod/clusters/cluster_border.h"

/* The records of a .chy file (docs/reference/format-chy.md), as they are in memory too. */

/* One way to draw a cluster, or a node. */
typedef struct conic_hybrid_level {
  uint32_t kind;         /* conic_hybrid_kind */
  uint32_t first, count; /* of its triangles or surfels among all */
  uint32_t first_vertex; /* triangles: their vertices are listed from here on, and their corners count from there */
  uint32_t n_vertices;
  float error;    /* no place of the cluster is drawn farther than this from where it is */
  float reach;    /* surfels: the longest half axis of an outline */
  uint32_t stage; /* triangles: how often they were simplified; of its borders' vertices those are left that last */
  uint32_t first_border, n_borders;
  float cover, spread; /* surfels: the products of the half axes of their outlines, and their squares, summed up */
  float change;        /* by how many steps colours of the cluster are drawn otherwise than they are, at the most, */
  float smear;         /* and that times the length over which they are */
} conic_hybrid_level;

/* A sphere that holds the faces, and a cone of their normals: its axis and the cosine of half its opening. */
typedef struct conic_hybrid_bound {
  float center[3], radius, axis[3], cone;
} conic_hybrid_bound;

typedef struct conic_hybrid_cluster {
  conic_hybrid_bound bound;
  float area;
  uint32_t first_level, n_levels; /* triangles first, of growing error, then surfels likewise */
  uint32_t built;                 /* which level is drawn where no error is asked for, from first_level */
} conic_hybrid_cluster;

/* All that a node holds as one disc that faces the camera, about the centre of its sphere. */
typedef struct conic_hybrid_point {
  float radius; /* of the faces alone, without what surfels stand out; 0: there is no point */
  float error;  /* as of a level */
  float color[3];
  float change, smear; /* as of a level */
} conic_hybrid_point;

/* In preorder: the root first. */
typedef struct conic_hybrid_node {
  conic_hybrid_bound bound;
  uint32_t begin, end;            /* clusters */
  uint32_t next;                  /* the node after the subtree: this one + 1 where it has no children */
  uint32_t first_level, n_levels; /* that stand for all of its clusters: triangles first, then surfels, each of growing
                                     error; may be none */
  conic_hybrid_point point;
} conic_hybrid_node;

struct conic_hybrid {
  conic_context *context;
  float cutoff;
  double origin[3];
  float low[3], high[3]; /* of the vertices, from the origin */
  double splat_length;
  size_t n_vertices, n_triangles, n_listed, n_surfels, n_levels, n_clusters, n_nodes, n_slots, n_borders;
  const float *position[3], *normal[3], *color[3],
      *texture_coordinate[2]; /* by vertex; the last three kinds may be null */
  const uint32_t (*corners)[3];
  const uint32_t *material; /* of each triangle; null: all have the first, or there is none */
  const uint32_t *listed;   /* vertices, by level */
  const float *surfels[12]; /* positions, t_u, t_v, colours */
  const conic_hybrid_level *levels;
  const conic_hybrid_cluster *clusters;
  const conic_hybrid_node *nodes;
  const conic_cluster_slot *slots;
  const conic_cluster_border *borders; /* by level, in the order of their edges */
  size_t n_materials, n_texels;
  const struct conic_chy_material *material_list;
  const unsigned char *texels;
  conic_material *materials; /* made of these; the textures are the hybrid's own */

  /* Where all that lies: in one piece of memory of its own, or in the file's. */
  void *owned;
  conic_mapping mapping;
};

/* The size of the file that holds it. */
uint64_t conic_hybrid_file_bytes(const conic_hybrid *hybrid);

/* Makes the sums in a file's bytes right, for tests and fuzzing. */
void conic_hybrid_mend(unsigned char *bytes, size_t n_bytes);

/* How far the levels of a cluster reach out of its sphere. */
double conic_hybrid_reach(const conic_hybrid *hybrid, const conic_hybrid_cluster *cluster);

/* What is wrong with its indices, or null: nothing is used before it was asked. */
const char *conic_hybrid_structure(const conic_hybrid *hybrid);

#endif
