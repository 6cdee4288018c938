/* How much the colours differ in what each site stands for. */
#ifndef CONIC_CLUSTER_CONTRAST_H
#define CONIC_CLUSTER_CONTRAST_H

#include <math.h>

#include "lod/clusters/cluster_sites.h"

/* Pictures show about the square root of linear light; what is beyond their range they do not show. */
static inline double conic_as_shown(double linear) {
  return linear >= 1.0 ? 1.0 : linear > 0.0 ? sqrt(linear) : 0.0;
}

/* Fills in the contrasts of the sites that are not settled: the greatest difference in a channel among the places that
 * they own, as it is shown (1: black and white). Details that are finer than the lattices count as what they are in the
 * mean. */
void conic_cluster_find_contrasts(conic_sampler *sampler);

#endif
