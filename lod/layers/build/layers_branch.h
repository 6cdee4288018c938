/* A node while its tree grows, and the bounds of what lies in its place. */
#ifndef CONIC_LAYERS_BRANCH_H
#define CONIC_LAYERS_BRANCH_H

#include "lod/layers/build/layers_tree.h"

/* A node's bounds are found from the samples that stand for the nodes below whose place holds at most this fraction of
 * its own's samples, or for leaves, and from how far these are off. */
enum { CONIC_LAYERS_FRACTION = 32 };

static inline int conic_layers_is_far_below(uint64_t n_place, uint64_t n_place_below) {
  return n_place_below <= n_place / CONIC_LAYERS_FRACTION;
}

typedef struct conic_layers_waiting conic_layers_waiting;

/* What of a sample makes its disc, beside its key. */
typedef struct conic_layers_facet {
  uint8_t normal[2];
  uint16_t size;
} conic_layers_facet;

struct conic_layers_branch {
  conic_layers_branch *children[2]; /* as far down as bounds look */
  size_t stride;
  conic_layers_waiting *waiting;
  unsigned char *samples;     /* those drawn, until the parent has chosen; null: put away */
  uint64_t *keys;             /* of these; null: put away */
  conic_layers_facet *facets; /* likewise */
  uint64_t samples_at, keys_at, facets_at;
  /* From here on it is sent and kept as it is (layers_parcel.h). */
  uint64_t first_key, last_key, n_place;
  size_t n_drawn;
  int is_leaf;
  double area;              /* of the surface: of each sample the square of the spacing about it */
  double distance;          /* between the chosen, as conic_thinner_choose has it; 0: a leaf */
  double covering, radius;  /* in steps of the grid, as the next; and the greatest outline with which any is drawn */
  double past;              /* how much larger than at full resolution one is drawn at most */
  double part;              /* how far what full resolution draws is from what is drawn, in steps */
  double low[3], high[3];   /* box of its place's samples, in steps */
  double center[3], sphere; /* of these, in steps */
  double axis[3], cone;
};

static inline const conic_layers_sample *conic_layers_drawn_at(const conic_layers_branch *branch, size_t i) {
  return conic_layers_sample_at(branch->samples, branch->stride, i);
}

/* Of a leaf, from all samples in its place. Errors: MEMORY. */
conic_status conic_layers_bound_leaf(const conic_layers_plan *plan, conic_layers_branch *leaf);

/* Of a node whose samples have been chosen, the grid of the thinner holding them. `is_alone`: on all threads; not from
 * inside a task. Errors: MEMORY, IO. */
conic_status conic_layers_bound_node(const conic_layers_plan *plan, const conic_thinner *thinner, int is_alone,
                                     conic_layers_branch *node);

/* The entry's part that follows from it, all lengths rounded up. */
void conic_layers_describe_branch(const conic_layers_plan *plan, const conic_layers_branch *branch,
                                  conic_layers_entry *entry);

#endif
