/* How much the colours differ in what each site stands for. */
#ifndef LOD_PATCH_CONTRAST_H
#define LOD_PATCH_CONTRAST_H

#include "lod/patch_sites.h"

/* Fills in the contrasts of the sites that are not settled: the greatest difference in a channel among the places that
 * they own, as it is shown (1: black and white). Details that are finer than the lattices count as what they are in the
 * mean. */
void conic_patch_find_contrasts(conic_sampler *sampler);

#endif
