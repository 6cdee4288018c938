/* What choosing the levels of a hybrid model, and copying what they are drawn of, hand to each other. */
#pragma once

#include "core/base/kept_memory.h"
#include "lod/hybrid/draw/hybrid_choose.h"
#include "lod/hybrid/model/hybrid_chunks.h"

/* A cluster that is drawn, or a node, and where its parts go. The numbers of nodes follow those of clusters. The level
 * is counted among all of the model's; a node's point is none of them. */
typedef struct hybrid_choice {
  uint32_t cluster, level;
  size_t splat, triangle, vertex;
  size_t n_put; /* into the triangles, so that they fit their neighbours */
} hybrid_choice;

/* What is kept from call to call. */
typedef struct hybrid_scratch {
  hybrid_choice *choices;
  size_t n_choices, choices_room;
  uint32_t *seen; /* nodes in sight */
  size_t n_seen;
  conic_kept_memory seen_memory;
  uint32_t *stages;   /* of each cluster of the hybrid: that of its level */
  uint32_t *standing; /* the node that stands for it: behind the stages */
  conic_kept_memory stages_memory, splats_memory, vertices_memory, triangles_memory;
  float *splats; /* arrays of splats_room each; behind them the splats' clusters */
  size_t splats_room;
  float *vertices; /* arrays of vertices_room each */
  size_t vertices_room;
  uint32_t *triangles; /* corners, clusters and materials of triangles_room triangles */
  size_t triangles_room;
  conic_kept_memory chunks_memory;
  uint32_t *frames, *chunks; /* held: frames of clusters in sight, and what some choices are drawn of */
  size_t n_frames, n_chunks;
  uint64_t frames_bytes;
} hybrid_scratch;

/* The level of a choice that is a node's point. */
#define CONIC_HYBRID_POINT UINT32_MAX

typedef struct hybrid_selecting {
  const conic_hybrid *hybrid;
  conic_hybrid_camera camera;
  const conic_hybrid_view *view;
  conic_hybrid_selection *selection;
  hybrid_scratch *scratch;
  size_t first, end; /* the choices that are copied together */
} hybrid_selecting;

/* The node of a choice that is one. */
static inline const conic_hybrid_node *conic_hybrid_node_chosen(const hybrid_selecting *s, const hybrid_choice *c) {
  return c->cluster < s->hybrid->n_clusters ? NULL : &s->hybrid->nodes[c->cluster - s->hybrid->n_clusters];
}

/* --- what is drawn of the choices (lod/hybrid/draw/hybrid_parts.c) --- */

/* Finds where the parts of each choice go, and room for all. Errors: MEMORY. */
conic_status conic_hybrid_parts_place(hybrid_selecting *s);

/* Points the selection to that room. */
void conic_hybrid_parts_attach(hybrid_selecting *s);

/* Copies the parts of the choices from s->first to s->end, whose chunks are held. */
void conic_hybrid_parts_copy(hybrid_selecting *s);

/* Marks the dots among what was copied, and turns them to the camera. Errors: MEMORY. */
conic_status conic_hybrid_parts_turn(const hybrid_selecting *s, const conic_camera *camera);

/* --- clusters side by side at different levels --- */

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
