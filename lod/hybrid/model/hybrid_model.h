/* A hybrid model as it is in memory. */
#pragma once

#include "conic/hybrid.h"
#include "core/base/vectors.h"
#include "core/files/mapping.h"

/* The records of a .chy file (docs/reference/format-chy.md), as they are in memory too. */

/* One way to draw a cluster, or a node. */
typedef struct conic_hybrid_level {
  uint32_t kind;       /* conic_hybrid_kind */
  uint32_t count;      /* of its triangles or surfels */
  uint32_t n_vertices; /* triangles: of their own */
  uint32_t stage;      /* triangles: how often they were simplified; its borders have the vertices that last so long */
  uint32_t first_border, n_borders; /* among those of its cluster */
  float error;                      /* no place of the cluster is drawn farther than this from where it is */
  float reach;                      /* surfels: the longest half axis of an outline */
  float cover, spread;              /* surfels: sums over outlines of the product of the half axes, and of its square */
  float change; /* the most steps by which colours of the cluster are drawn otherwise than they are */
  float smear;  /* the same times the length over which they are */
  uint32_t at;  /* its chunk: CONIC_HYBRID_UNIT times that from the first chunk on */
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
  uint32_t n_slots, n_borders;    /* slots where it meets others, chain by chain; borders of all its levels */
  uint32_t frame_at, ends_at;     /* the chunk of its slots' stages and borders; that of its slots' vertices */
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
  uint32_t first_level, n_levels; /* that stand for all of its clusters: triangles, then surfels, each of growing
                                     error; may be none */
  conic_hybrid_point point;
} conic_hybrid_node;

enum {
  CONIC_CHY_NORMALS = 1,
  CONIC_CHY_COLORS = 2,
  CONIC_CHY_TEXTURE_COORDINATES = 4,
  CONIC_CHY_MATERIALS = 8, /* each triangle names one */
  CONIC_CHY_ALL_FLAGS = 15
};

struct conic_hybrid {
  conic_context *context;

  /* The header's numbers, as they are in the file (hybrid_file.c). */
  uint32_t version, flags; /* flags: of what there is by vertex and by triangle */
  uint64_t n_vertices, n_triangles, n_surfels, n_levels, n_clusters, n_nodes, n_materials, n_texels;
  uint64_t n_data; /* bytes of all chunks */
  double origin[3];
  float low[3], high[3]; /* of the vertices, from the origin */
  double splat_length;
  float cutoff;
  uint32_t zero;
  uint64_t body_sum; /* over the arrays' sums */

  const conic_hybrid_level *levels;
  const conic_hybrid_cluster *clusters;
  const conic_hybrid_node *nodes;
  const struct conic_chy_material *material_list;
  const unsigned char *texels;
  conic_material *materials; /* made of these; the textures are the hybrid's own */

  /* The chunks (lod/hybrid/model/hybrid_chunks.h): all of them; or null, and a store has those that were asked for. */
  const unsigned char *data;
  struct conic_hybrid_store *store;
  struct conic_hybrid_pile *pile; /* whose file they lie in, in any order; or null */
  uint64_t drawing_bytes;         /* what a picture's parts may take; 0: any number */

  /* Where all that lies: in one piece of memory of its own, or in the file's. */
  void *owned;
  conic_mapping mapping;
};

/* The size of the file that holds it. */
uint64_t conic_hybrid_file_bytes(const conic_hybrid *hybrid);

/* How far the levels of a cluster reach out of its sphere. */
double conic_hybrid_reach(const conic_hybrid *hybrid, const conic_hybrid_cluster *cluster);

/* What is wrong with all but its chunks, or null. Nothing is used before this was asked. */
const char *conic_hybrid_structure(const conic_hybrid *hybrid);

/* --- the hierarchy over the clusters --- */

/* The most clusters in a node without children. */
enum { CONIC_HYBRID_LEAF = 4 };

/* How many of n clusters are in the first half, where they are split. */
size_t conic_hybrid_half(size_t n);

/* How many nodes there are over so many clusters. */
size_t conic_hybrid_count_nodes(size_t n_clusters);

/* Orders clusters with the given bounds so that neighbours are near each other; order[k] is the number of the k-th.
 * Where `kinds` is not null, those of kind 0 come before those of kind 1. Errors: MEMORY. */
conic_status conic_hybrid_order(conic_context *context, const conic_hybrid_bound *bounds, const uint8_t *kinds,
                                size_t n_clusters, uint32_t *order);

/* Fills in the nodes, without their levels and points, over ordered clusters with the given bounds; reach[k] is how far
 * the surfels of cluster k may stand out of its sphere. */
void conic_hybrid_fill_nodes(const conic_hybrid_bound *bounds, const float *reach, size_t n_clusters,
                             conic_hybrid_node *nodes);

/* A sphere and a cone that hold both; a cone of more than half of all directions becomes all of them, -1. */
conic_hybrid_bound conic_hybrid_join(const conic_hybrid_bound *a, const conic_hybrid_bound *b);
/* The cosine of the half opening of a cone about an axis that holds the bound's; −1 where that is over a half turn. */
double conic_hybrid_cone_about(const conic_hybrid_bound *bound, const float axis[3]);
