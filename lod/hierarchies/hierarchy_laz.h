/* LAZ within hierarchies: a chunk, or a whole file, of points. */
#ifndef CONIC_HIERARCHY_LAZ_H
#define CONIC_HIERARCHY_LAZ_H

#include "lod/hierarchies/hierarchy.h"

/* Finds how points are packed in a file's bytes up to the points, and keeps it as the hierarchy's own. Errors: INPUT,
 * MEMORY. */
conic_status conic_hierarchy_find_laz(conic_hierarchy *hierarchy, const unsigned char *bytes, size_t n_bytes);

/* Points of one chunk, packed as was found; null, or what is wrong with it. */
const char *conic_hierarchy_take_chunk(const conic_hierarchy *hierarchy, const unsigned char *bytes, size_t n_bytes,
                                       conic_hierarchy_points *points);

/* The same of a whole .laz, or .las, of so many points. */
const char *conic_hierarchy_take_laz(conic_context *context, const unsigned char *bytes, size_t n_bytes,
                                     conic_hierarchy_points *points);

#endif
