/* What is left out where clusters meet. */
#ifndef CONIC_CLUSTER_BORDER_H
#define CONIC_CLUSTER_BORDER_H

#include <stdint.h>

/* A vertex where two clusters meet, as each of them has it, the lower one first, and the last stage of simplification
 * at which it is still there. */
typedef struct conic_cluster_slot {
  uint32_t vertices[2], stage;
} conic_cluster_slot;

#define CONIC_CLUSTER_ALWAYS UINT32_MAX

/* An edge of a level's triangle along which vertices were left out: what the cluster across still has of them is put
 * in when they are drawn side by side. */
typedef struct conic_cluster_border {
  uint32_t edge;     /* 4 · triangle, counted from the level's first, + the corner where the edge begins */
  uint32_t from, to; /* slots of its two ends; what was left out lies between; in a model, of the cluster's own */
  uint32_t across;   /* the other cluster */
} conic_cluster_border;

#endif
