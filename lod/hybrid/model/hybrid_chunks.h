/* The chunks of a hybrid model, which are read one by one. A level's chunk has what is drawn of it. A cluster's two
 * chunks, frame and ends, have what fits it to others. Levels have the first numbers, then come all frames, then all
 * ends. Each chunk begins with its sum (docs/reference/format-chy.md). */
#pragma once

#include "lod/clusters/cluster.h"
#include "lod/hybrid/model/hybrid_model.h"

enum { CONIC_HYBRID_UNIT = 64, CONIC_HYBRID_SUM_BYTES = 8, CONIC_HYBRID_NARROW = 65536 };

/* Where a chunk lies among all of them; one of no bytes is not there. */
typedef struct conic_hybrid_place {
  uint64_t at;
  uint64_t n_bytes;
} conic_hybrid_place;

size_t conic_hybrid_count_chunks(const conic_hybrid *hybrid);
uint32_t conic_hybrid_frame_chunk(const conic_hybrid *hybrid, uint32_t cluster);
uint32_t conic_hybrid_ends_chunk(const conic_hybrid *hybrid, uint32_t cluster);
conic_hybrid_place conic_hybrid_chunk_place(const conic_hybrid *hybrid, uint32_t chunk);

/* Bytes of a chunk of so many triangles or surfels, slots or borders. */
uint64_t conic_hybrid_frame_bytes(const conic_hybrid_cluster *cluster);

/* Lists all chunks in the order in which they lie: frames, ends, the levels of nodes, and those of clusters, the
 * coarsest of every cluster before the next finer. The caller releases *order, on failure too. Errors: MEMORY. */
conic_status conic_hybrid_order_chunks(const conic_hybrid *hybrid, uint32_t **order);

/* Places chunks one behind the other in that order. The levels and clusters are those of `hybrid`. Errors: MEMORY. */
conic_status conic_hybrid_place_chunks(conic_hybrid *hybrid, conic_hybrid_level *levels,
                                       conic_hybrid_cluster *clusters);

/* Whether they lie so, and are all; *wrong is null then. Errors: MEMORY. */
conic_status conic_hybrid_check_order(const conic_hybrid *hybrid, const char **wrong);

/* Vertices of a level; or, by slot, those where a cluster meets others. What there is not is null. */
typedef struct conic_hybrid_vertices {
  const float *position[3], *normal[3], *color[3], *texture_coordinate[2];
} conic_hybrid_vertices;

/* What a level is drawn of. Corners are wide where there are more than NARROW vertices, else narrow. */
typedef struct conic_hybrid_piece {
  conic_hybrid_vertices vertices;
  const uint32_t *material; /* of each triangle; or null */
  const uint16_t (*narrow)[3];
  const uint32_t (*wide)[3];
  const float *surfels[12]; /* positions, t_u, t_v, colours */
} conic_hybrid_piece;

static inline uint32_t conic_hybrid_corner(const conic_hybrid_piece *piece, size_t triangle, int corner) {
  /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): it has one of them */
  return piece->narrow ? piece->narrow[triangle][corner] : piece->wide[triangle][corner];
}

/* Along which vertices a cluster meets others, and what its levels left out of them. */
typedef struct conic_hybrid_frame {
  const uint32_t *stages;              /* of each slot: the last at which its vertex is still there */
  const conic_cluster_border *borders; /* by level, in the order of their edges */
} conic_hybrid_frame;

/* The bytes and the parts of a chunk that is there. Of a model that was read as a whole all are, else those that are
 * held. */
const unsigned char *conic_hybrid_chunk(const conic_hybrid *hybrid, uint32_t chunk);
conic_hybrid_piece conic_hybrid_piece_of(const conic_hybrid *hybrid, uint32_t level);
conic_hybrid_frame conic_hybrid_frame_of(const conic_hybrid *hybrid, uint32_t cluster);
conic_hybrid_vertices conic_hybrid_ends_of(const conic_hybrid *hybrid, uint32_t cluster);

/* Turns a chunk, but for its sum, between a file's order and the machine's. */
void conic_hybrid_turn_chunk(const conic_hybrid *hybrid, uint32_t chunk, unsigned char *bytes);

/* Writes the sum of a chunk that stands as it does in a file. */
void conic_hybrid_seal_chunk(unsigned char *bytes, size_t n_bytes);

/* What is wrong with a chunk as it stands in a file, or null; then it stands as it does in memory. */
const char *conic_hybrid_take_chunk(const conic_hybrid *hybrid, uint32_t chunk, unsigned char *bytes);

/* What is wrong between a cluster's chunks. All of them must be there. */
const char *conic_hybrid_cluster_fault(const conic_hybrid *hybrid, uint32_t cluster);
