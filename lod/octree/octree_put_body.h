/* Takes chosen nodes and leaves, a line of the cache each, apart into the arrays of a set of splats, as many at a time
 * as there are lanes. */
#include "core/lanes/lanes_store.h"
#include "lod/octree/octree_loops.h"

#if defined(__AVX512F__)
typedef lanes group;
typedef int_lanes group_mask;
#else
typedef quad group;
typedef int32_t group_mask __attribute__((vector_size(16)));
#endif

enum {
  N_FIELDS = sizeof(conic_drawn_node) / sizeof(float),
  GROUP = sizeof(group) / sizeof(float),
  AHEAD = 32, /* single leaves lie far apart */
  AT_POSITION = 0,
  AT_U = 3,
  AT_V = 6,
  AT_COLOR = 9,
  AT_OPACITY = 12,
  AT_ID = 13,
  AT_DOT = 14
};
_Static_assert(offsetof(conic_drawn_node, tangent_u) == AT_U * sizeof(float) &&
                   offsetof(conic_drawn_node, tangent_v) == AT_V * sizeof(float) &&
                   offsetof(conic_drawn_node, color) == AT_COLOR * sizeof(float) &&
                   offsetof(conic_drawn_node, opacity) == AT_OPACITY * sizeof(float) &&
                   offsetof(conic_drawn_node, id) == AT_ID * sizeof(float) &&
                   offsetof(conic_drawn_node, dot) == AT_DOT * sizeof(float) && N_FIELDS == 16,
               "fields are where they are looked for");

/* The fields of as many as a group holds. */
CONIC_INLINE void take_apart(const conic_drawn_node *const chosen[GROUP], group fields[N_FIELDS]) {
#if defined(__AVX512F__)
  lanes rows[N_FIELDS];
  __m512 columns[N_FIELDS];
  for (int k = 0; k < GROUP; k++)
    rows[k] = (lanes)_mm512_loadu_ps(chosen[k]->position);
  lanes_whole_records(rows, columns); /* a transposition, and so its own inverse */
  for (int k = 0; k < N_FIELDS; k++)
    fields[k] = (lanes)columns[k];
#else
  for (int four = 0; four < N_FIELDS; four += GROUP) {
    for (int k = 0; k < GROUP; k++)
      memcpy(&fields[four + k], (const char *)chosen[k] + (size_t)four * sizeof(float), sizeof(quad));
    quad_transpose(fields + four);
  }
#endif
}

/* A node that faces away stands for leaves that may not, else it were not chosen: it is turned, so as not to be culled
 * as one. */
CONIC_INLINE void turn(const float eye[3], group_mask is_node, group fields[N_FIELDS]) {
  group along = {0};
  for (int axis = 0; axis < 3; axis++) {
    int next = (axis + 1) % 3, last = (axis + 2) % 3;
    group normal = fields[AT_U + next] * fields[AT_V + last] - fields[AT_U + last] * fields[AT_V + next];
    along += (fields[AT_POSITION + axis] - eye[axis]) * normal;
  }
  group_mask sign = (along > 0.0f) & is_node & INT32_MIN;
  for (int axis = 0; axis < 3; axis++)
    fields[AT_V + axis] = (group)((group_mask)fields[AT_V + axis] ^ sign);
}

/* Puts the first n of a group at place k. */
CONIC_INLINE void put_group(const group fields[N_FIELDS], size_t n, const conic_splats *to, uint32_t *ids, size_t k) {
  float *arrays[N_FIELDS];
  for (int axis = 0; axis < 3; axis++) {
    arrays[AT_POSITION + axis] = to->position[axis];
    arrays[AT_U + axis] = to->tangent_u[axis];
    arrays[AT_V + axis] = to->tangent_v[axis];
    arrays[AT_COLOR + axis] = to->color[axis];
  }
  arrays[AT_OPACITY] = to->opacity;
  for (int field = 0; field <= AT_OPACITY; field++)
    if (arrays[field])
      memcpy(arrays[field] + k, &fields[field], n * sizeof(float));
  memcpy(ids + k, &fields[AT_ID], n * sizeof *ids);
  if (to->dot)
    memcpy(to->dot + k, &fields[AT_DOT], n * sizeof(float));
}

static void put(const conic_octree *octree, const uint32_t *sources, size_t n, const float *eye, const conic_splats *to,
                uint32_t *ids, size_t place) {
  const conic_drawn_node *const kinds[2] = {octree->drawn_leaves, octree->drawn};
  for (size_t first = 0; first < n; first += GROUP) {
    const conic_drawn_node *chosen[GROUP];
    group fields[N_FIELDS];
    group_mask is_node = {0};
    for (size_t k = 0; k < GROUP; k++) {
      uint32_t source = sources[first + k < n ? first + k : n - 1];
      uint32_t ahead = sources[first + k + AHEAD < n ? first + k + AHEAD : n - 1];
      __builtin_prefetch(kinds[ahead >> 31] + (ahead & ~CONIC_NODE_BIT));
      chosen[k] = kinds[source >> 31] + (source & ~CONIC_NODE_BIT);
      is_node[k] = -(int32_t)(source >> 31);
    }
    take_apart(chosen, fields);
    if (eye)
      turn(eye, is_node, fields);
    if (n - first >= GROUP)
      put_group(fields, GROUP, to, ids, place + first);
    else
      put_group(fields, n - first, to, ids, place + first);
  }
}
