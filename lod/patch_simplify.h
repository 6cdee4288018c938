/* Simpler and simpler triangles for a patch, whose borders to other patches stay as they are. */
#ifndef LOD_PATCH_SIMPLIFY_H
#define LOD_PATCH_SIMPLIFY_H

#include "lod/patch.h"

enum { CONIC_MOST_TRIANGLE_LEVELS = 8 };

/* Triangles of the mesh's own vertices. */
typedef struct conic_patch_level {
  size_t n;
  uint32_t (*corners)[3];
  uint32_t *face; /* of each: the face of the mesh that it came from */
  double error; /* no vertex of the patch, nor middle of an edge or a face, is farther from these triangles; measured */
} conic_patch_level;

typedef struct conic_patch_levels {
  int n; /* the first one is the next simpler than the mesh itself */
  conic_patch_level levels[CONIC_MOST_TRIANGLE_LEVELS];
} conic_patch_levels;

/* Memory that is kept from patch to patch. */
typedef struct conic_simplifier conic_simplifier;
conic_status conic_simplifier_create(conic_context *context, const conic_patch_mesh *mesh,
                                     conic_simplifier **simplifier);
void conic_simplifier_destroy(conic_simplifier *simplifier);

/* Draws edges together, the cheapest first by their quadrics (HQP §3.2.1), each onto one of its ends: what stays are
 * vertices of the mesh. Each level has half as many triangles as the one before, as far as that is possible. Vertices
 * that another patch has too stay; those on an open border may go along it, held by planes that stand on its edges
 * (§3.2.4). The caller releases the levels. Errors: MEMORY. */
conic_status conic_patch_simplify(conic_simplifier *simplifier, uint32_t patch, conic_patch_levels *levels);
void conic_patch_levels_release(conic_context *context, conic_patch_levels *levels);

#endif
