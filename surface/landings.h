/* Darts, projected onto the surface. */
#ifndef CONIC_LANDINGS_H
#define CONIC_LANDINGS_H

#include "surface/densify_triangles.h"

typedef enum conic_landed_how {
  CONIC_LANDED_WELL,  /* on the surface, where it was thrown */
  CONIC_LANDED_ASIDE, /* on the surface, but beside its place */
  CONIC_LANDED_FLAT,  /* there is no surface, so it stays in its triangle */
  CONIC_LANDED_NOWHERE
} conic_landed_how;

typedef struct conic_landed {
  double place[3];
  float normal[3], color[3];
  conic_landed_how how;
} conic_landed;

typedef struct conic_landing_places {
  conic_landed *list; /* by dart */
  size_t room;
} conic_landing_places;

/* Errors: MEMORY, CANCELLED. */
conic_status conic_land_darts(const conic_surface *surface, const conic_densify_triangles *triangles,
                              const conic_darts *darts, double from, double to, conic_workspace *workspaces,
                              conic_landing_places *landed);

#endif
