/* Solids made of solids: two closed surfaces of splats are joined, intersected or taken from each other, and the splats
 * at the seam get clip lines, so that it is sharp (PAS §5 and Fig. 8). */
#ifndef CONIC_CSG_H
#define CONIC_CSG_H

#include "conic/splats.h"

CONIC_BEGIN_C

typedef enum conic_csg_operation {
  CONIC_CSG_UNION = 0,        /* what is in either */
  CONIC_CSG_INTERSECTION = 1, /* what is in both */
  CONIC_CSG_DIFFERENCE = 2    /* what is in the first and not in the second */
} conic_csg_operation;

typedef struct conic_csg_report {
  size_t n_kept[2];   /* of the first set, and of the second */
  size_t n_clipped;   /* of these, splats that the other surface cuts */
  size_t n_unclipped; /* that it cuts, but that have clip lines of their own already: whole where their centres are */
} conic_csg_report;

/* Makes the surface of the solid. Both sets have tangent axes; their normals t_u × t_v point out of their solids, which
 * are closed. A splat stays where its side of the other surface is the one that counts, and is clipped where that
 * surface cuts it; of a difference those of the second set are turned over. Dots are not clipped. `cutoff` is where
 * outlines end. The order is that of the first set, then of the second; the origin is the first one's. `report` may be
 * null. On success the caller releases *result; on failure it is empty. Errors: ARGUMENT (no axes, an unknown
 * operation, a cutoff that is none, over 2³² − 2 splats), MEMORY, CANCELLED. */
CONIC_API conic_status conic_splats_csg(conic_context *context, const conic_splats *a, const conic_splats *b,
                                        conic_csg_operation operation, float cutoff, conic_splats *result,
                                        conic_csg_report *report);

CONIC_END_C
#endif
