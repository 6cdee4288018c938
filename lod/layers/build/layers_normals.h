/* Normals for samples that came without, while a layered cloud is built. */
#ifndef CONIC_LAYERS_NORMALS_H
#define CONIC_LAYERS_NORMALS_H

#include "lod/layers/build/layers_tree.h"

/* The largest places with no more samples have their normals found by themselves, a multiple of a leaf's. */
enum { CONIC_LAYERS_PATCH_LEAVES = 16 };

/* Gives the bare ones of n samples, ascending by key, the direction in which their neighbours among these spread least.
 * It has no side: the upper one is taken. Errors: MEMORY. */
conic_status conic_layers_find_normals(const conic_layers_plan *plan, unsigned char *samples, size_t n);

#endif
