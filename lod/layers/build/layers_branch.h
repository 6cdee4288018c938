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

struct conic_layers_branch {
  conic_layers_branch *children[2]; /* as far down as bounds look */
  uint32_t nodes[2];                /* theirs, once they are on the shelf */
  int is_leaf;
  uint64_t first_key, last_key, n_place;
  size_t n_drawn;
  conic_layers_sample *samples;     /* those drawn, until its cloud is packed */
  uint64_t *keys;                   /* of these */
  double area;                      /* of the surface: of each sample the square of the spacing about it */
  double distance;                  /* between the chosen, as conic_thinner_choose has it; 0: a leaf */
  double covering;                  /* these three in steps of the grid */
  double outline_low, outline_high; /* of the leaves' outlines */
  double radius;                    /* with which it is drawn */
  double low[3], high[3];           /* box of its place's samples, in steps */
  double center[3], sphere;         /* of these, in steps */
  double axis[3], cone;
};

/* Of a leaf, from all samples in its place. Errors: MEMORY. */
conic_status conic_layers_bound_leaf(const conic_layers_plan *plan, conic_layers_branch *leaf);

/* Of a node whose samples have been chosen, the grid of the thinner holding them. */
void conic_layers_bound_node(conic_thinner *thinner, conic_layers_branch *node);

/* The entry's part that follows from it, all lengths rounded up. */
void conic_layers_describe_branch(const conic_layers_plan *plan, const conic_layers_branch *branch,
                                  conic_layers_entry *entry);

#endif
