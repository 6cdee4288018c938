/* Which points lie on no surface: foliage, wires, noise. */
#ifndef CONIC_SCATTER_H
#define CONIC_SCATTER_H

#include "core/estimate/neighbourhood.h"

/* Marks LISTED slots without a surface around them as SCATTERED. Their normals must be known, up to the sign. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_scatter_find(conic_context *context, conic_neighbourhood *neighbourhood, double from, double to);

/* The reach of a dot at a slot, and its normal, which points outwards; zero where the neighbours do not tell. */
double conic_scatter_reach(const conic_neighbourhood *neighbourhood, size_t slot);
void conic_scatter_outside(const conic_neighbourhood *neighbourhood, size_t slot, double normal[3]);

#endif
