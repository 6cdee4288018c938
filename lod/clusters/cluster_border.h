/* What is left out where clusters meet. */
#ifndef CONIC_CLUSTER_BORDER_H
#define CONIC_CLUSTER_BORDER_H

#include <stdint.h>

/* A vertex where two clusters meet. Each cluster has one of its own there; the lower cluster's is the first. `stage` is
 * the last stage of simplification at which it is still there. */
typedef struct conic_cluster_slot {
  uint32_t vertices[2], stage;
} conic_cluster_slot;

#define CONIC_CLUSTER_ALWAYS UINT32_MAX

/* An edge of a level's triangle along which vertices were left out. Where the cluster across still has some of them,
 * they are put in when both are drawn. */
typedef struct conic_cluster_border {
  uint32_t edge;     /* 4 · triangle, from the level's first, + the corner where the edge begins */
  uint32_t from, to; /* slots of its two ends, in a model of the cluster's own; what was left out is between */
  uint32_t across;   /* the other cluster */
} conic_cluster_border;

#endif
