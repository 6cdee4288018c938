/* Nodes of a layered cloud while its tree grows, bottom up: every node takes from its two children the samples that
 * stand for all of its place, and what is left of a child's samples is the child's cloud (docs/reference/layers.md). */
#pragma once

#include "core/base/real.h"
#include "core/files/pile.h"
#include "lod/layers/build/layers_kept.h"
#include "lod/layers/build/layers_thin.h"
#include "lod/layers/format/layers_code.h"

/* What is the same for all of a tree. */
typedef struct conic_layers_plan {
  conic_context *context;
  uint32_t bits, cloud_size;
  uint64_t n_samples;  /* of the whole tree */
  size_t sample_bytes; /* from one sample to the next: each is followed by bytes of its own */
  double quantum;
  double spacing;    /* sampling distance, where a leaf has too few samples to tell */
  int is_unoriented; /* some normals have no side */
  int has_bare;      /* some samples come without a normal */
  float cutoff;
  const conic_layers_schema *schema;
} conic_layers_plan;

/* A leaf holds up to three clouds' worth of samples; its ancestors take about half of them. */
static inline size_t conic_layers_most_in_leaf(const conic_layers_plan *plan) {
  return 3 * (size_t)plan->cloud_size;
}

/* --- keys, ascending, `stride` bytes apart --- */

/* How many of n keys are not above `key`. */
static inline size_t conic_layers_count_to(const void *keys, size_t stride, size_t n, uint64_t key) {
  size_t low = 0;
  CONIC_BISECT(low, n, *(const uint64_t *)(const void *)((const char *)keys + middle * stride) <= key);
  return low;
}

/* How many bits of keys lie below those that two keys have in common. */
static inline unsigned conic_layers_bits_below(uint64_t first, uint64_t last) {
  return first == last ? 0u : 64u - (unsigned)__builtin_clzll(first ^ last);
}

/* Where the second half of the place begins that the keys from `first` to before `end` share. Where all are the same,
 * it is the second half of the keys. */
static inline size_t conic_layers_middle(const void *keys, size_t stride, size_t first, size_t end) {
  const char *from = (const char *)keys + first * stride;
  uint64_t last = *(const uint64_t *)(const void *)((const char *)keys + (end - 1) * stride);
  unsigned n_bits = conic_layers_bits_below(*(const uint64_t *)(const void *)from, last);
  if (n_bits == 0)
    return first + (end - first) / 2;
  return first + conic_layers_count_to(from, stride, end - first, (last >> (n_bits - 1) << (n_bits - 1)) - 1);
}

CONIC_DEFINE_ORDER_OF(conic_layers_compare_keys, uint64_t)

/* --- nodes --- */

/* A node's bounds are found from nodes below it: from leaves, and from those whose place holds at most this fraction of
 * its samples. They are found from the samples that stand for those nodes, and from how far these samples are off. */
enum { CONIC_LAYERS_FRACTION = 32 };

static inline int conic_layers_is_far_below(uint64_t n_place, uint64_t n_place_below) {
  return n_place_below <= n_place / CONIC_LAYERS_FRACTION;
}

/* What nodes keep while they wait for their parents: in memory up to a bound, which all threads share, beyond it in a
 * file. */
typedef struct conic_layers_pool {
  conic_context *context;
  size_t sample_bytes, most_drawn; /* of a node's samples */
  unsigned key_bits;
  conic_pile pile;
  atomic_size_t n_held; /* bytes in memory */
  size_t most_held;
} conic_layers_pool;

/* What makes a sample's disc, beside its key. */
typedef struct conic_layers_facet {
  uint8_t normal[2];
  uint16_t size;
} conic_layers_facet;

typedef struct conic_layers_node conic_layers_node;

struct conic_layers_node {
  conic_layers_node *children[2]; /* as far down as bounds look */
  size_t stride;
  conic_layers_pool *pool;
  unsigned char *samples;     /* those drawn, until the parent has chosen; null: put away */
  uint64_t *keys;             /* of these; null: put away */
  conic_layers_facet *facets; /* likewise */
  uint64_t samples_at, keys_at, facets_at;
  /* From here on it is sent and kept as it is (conic_layers_node_pack). */
  uint64_t first_key, last_key, n_place;
  size_t n_drawn;
  int is_leaf;
  double area;              /* of the surface: the sum over samples of the squared spacing about them */
  double distance;          /* between the chosen, as conic_thinner_choose has it; 0: a leaf */
  double covering;          /* every sample of its place is so near to one drawn, in steps of the grid */
  double radius;            /* of the greatest outline with which any is drawn, in steps */
  double past;              /* how much larger one is drawn at most than at full resolution, in steps */
  double error;             /* how far what full resolution draws is from what is drawn, in steps */
  double low[3], high[3];   /* box of its place's samples, in steps */
  double center[3], sphere; /* of these, in steps */
  double axis[3], cone;
  /* Its stand-ins, from when it is packed on; their errors and radii are in steps, too. */
  double stand_in_error, stand_in_radius, stand_in_cone;
  size_t n_stand_ins;
};

static inline const conic_layers_sample *conic_layers_drawn_at(const conic_layers_node *node, size_t i) {
  return conic_layers_sample_at(node->samples, node->stride, i);
}

/* The node and all nodes below it; null is allowed. */
void conic_layers_node_destroy(conic_layers_node *node);

/* `path`: beside which the file lies; it must outlive the pool. Errors: MEMORY, IO. */
conic_status conic_layers_pool_begin(const conic_layers_plan *plan, const char *path, size_t memory_bytes,
                                     conic_layers_pool *pool);
void conic_layers_pool_end(conic_layers_pool *pool); /* zero is allowed */

/* Gives a node memory for its samples, keys and facets. Keys and facets go together. Errors: MEMORY. */
conic_status conic_layers_hold(conic_layers_pool *pool, conic_layers_node *node);
void conic_layers_drop_samples(conic_layers_node *node);
void conic_layers_drop_keys(conic_layers_node *node);

/* Moves what nodes and all nodes below them hold to the file, the first node's first, until memory is within the bound.
 * Errors: IO. */
conic_status conic_layers_put_away(conic_layers_node *const *nodes, size_t n);

/* Copies a node's samples, or some of its keys or facets, from memory or file. Errors: IO. */
conic_status conic_layers_fetch_samples(const conic_layers_node *node, unsigned char *samples);
conic_status conic_layers_fetch_keys(const conic_layers_node *node, size_t first, size_t n, uint64_t *keys);
conic_status conic_layers_fetch_facets(const conic_layers_node *node, size_t first, size_t n,
                                       conic_layers_facet *facets);

/* Fills in a leaf's bounds, from all samples in its place. Errors: MEMORY. */
conic_status conic_layers_bound_leaf(const conic_layers_plan *plan, conic_layers_node *leaf);

/* Fills in the bounds of a node whose samples have been chosen; the grid of the thinner holds them. `is_alone`: it may
 * use all threads, so the caller is not inside a task. Errors: MEMORY, IO. */
conic_status conic_layers_bound_node(const conic_layers_plan *plan, const conic_thinner *thinner, int is_alone,
                                     conic_layers_node *node);

/* Fills in the entry's members that follow from the node; lengths are rounded up. */
void conic_layers_describe_node(const conic_layers_plan *plan, const conic_layers_node *node,
                                conic_layers_entry *entry);

/* --- growing --- */

/* Entries of nodes whose clouds have been packed. The two of a pair of siblings follow each other, the first first. All
 * that is below a pair comes before it, and what is below the first sibling before what is below the second. */
typedef struct conic_layers_packed {
  conic_context *context;
  conic_pile *clouds;          /* where the clouds' bytes go */
  conic_layers_entry *entries; /* parent and level unknown; child: whether there are any; the offset: in the pile */
  size_t n_entries, entry_room;
  unsigned char *bytes; /* of clouds that are not on the pile yet */
  size_t n_bytes, byte_room;
  size_t n_put; /* entries whose clouds' bytes are on the pile */
  uint64_t attribute_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
} conic_layers_packed;

/* Puts all bytes on the pile. Errors: IO. */
conic_status conic_layers_packed_flush(conic_layers_packed *packed);
void conic_layers_packed_release(conic_layers_packed *packed);

/* Outlines are counted by their code (conic_layers_code_size). */
enum { CONIC_LAYERS_OUTLINES = 1 << 15 };

/* What working on nodes needs; each thread has its own. */
typedef struct conic_layers_worker {
  conic_layers_plan plan;
  conic_layers_pool *pool;
  conic_thinner *thinner;
  conic_layers_coder *coder;
  struct conic_layers_standing *standing; /* null: no stand-ins are made */
  unsigned char *candidates;              /* of the two children, then what is left of one */
  uint8_t *is_chosen;
  uint64_t *outlines; /* how many samples have which at full resolution: CONIC_LAYERS_OUTLINES counts */
} conic_layers_worker;

/* Errors: MEMORY, UNSUPPORTED. */
conic_status conic_layers_worker_create(const conic_layers_plan *plan, conic_layers_pool *pool,
                                        conic_layers_worker **worker);
void conic_layers_worker_destroy(conic_layers_worker *worker);

/* Adds another's counts of outlines. */
void conic_layers_add_outlines(conic_layers_worker *worker, const uint64_t *outlines);

/* About how much memory a worker takes. */
size_t conic_layers_worker_bytes(const conic_layers_plan *plan);

/* Grows the tree of n > 0 samples, ascending by key. All nodes but its root are packed. Bare samples get their normals.
 * Errors: MEMORY, IO. */
conic_status conic_layers_grow(conic_layers_worker *worker, unsigned char *samples, size_t n,
                               conic_layers_packed *packed, conic_layers_node **node);

/* Makes the parent of two nodes, and packs them. It takes them over, on failure too. The first one's keys come first.
 * `is_alone`: it may use all threads. Errors: MEMORY, IO. */
conic_status conic_layers_merge(conic_layers_worker *worker, conic_layers_node *const children[2], int is_alone,
                                conic_layers_packed *packed, conic_layers_node **parent);

/* Packs what the root still has, as its cloud. Errors: MEMORY, IO. */
conic_status conic_layers_finish_root(conic_layers_worker *worker, conic_layers_node *node,
                                      conic_layers_packed *packed);

/* Where places have no more than this many leaves' samples, the largest of them have their normals found one by one. */
enum { CONIC_LAYERS_PATCH_LEAVES = 16 };

/* Gives the bare ones of n samples, ascending by key, a normal: the direction in which their neighbours among these
 * spread least. It has no side, so the upper one is taken. Errors: MEMORY. */
conic_status conic_layers_find_normals(const conic_layers_plan *plan, unsigned char *samples, size_t n);

/* --- as bytes, for another process or for a later one --- */

/* The node and all nodes below it. The caller releases *bytes, on failure too. Errors: MEMORY, IO. */
conic_status conic_layers_node_pack(const conic_layers_node *node, unsigned char **bytes, size_t *n_bytes);

/* The other way. Errors: INPUT (the bytes are no node; nothing is said), MEMORY. */
conic_status conic_layers_node_unpack(conic_layers_pool *pool, const unsigned char *bytes, size_t n_bytes,
                                      conic_layers_node **node);

/* A branch, which is all that has grown of a place: its uppermost node, what has been packed below that, and what was
 * counted of its samples alone. */
typedef struct conic_layers_grown {
  conic_layers_node *node;
  conic_layers_entry *entries; /* their offsets: in the pile */
  size_t n_entries;
  uint64_t attribute_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
  const uint64_t *outlines; /* CONIC_LAYERS_OUTLINES */
} conic_layers_grown;

/* The caller releases *bytes, on failure too. Errors: MEMORY, IO. */
conic_status conic_layers_branch_pack(const conic_layers_plan *plan, const conic_layers_grown *grown,
                                      const conic_pile *clouds, unsigned char **bytes, size_t *n_bytes);

/* The other way. The entries and their clouds are added to `packed`, and the counts to `packed` and worker. Errors:
 * INPUT (the bytes are no branch of that place), MEMORY, IO. */
conic_status conic_layers_branch_unpack(conic_layers_worker *worker, const unsigned char *bytes, size_t n_bytes,
                                        const conic_layers_kept_branch *place, conic_layers_packed *packed,
                                        conic_layers_node **node);
