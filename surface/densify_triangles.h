/* The triangles that say where a set's surface is: its own, or those that its points make with their neighbours. */
#pragma once

#include "surface/darts.h"
#include "surface/mls_surface.h"

typedef struct conic_densify_triangles {
  const conic_surface *surface;
  float (*normals)[3];    /* of the surface at each slot; zero where there is none */
  uint32_t (*corners)[3]; /* slots */
  float *reaches;         /* conic_dart_reach of each triangle */
  size_t n;
  double widest; /* the greatest reach */
  int are_given; /* they are the set's own */
} conic_densify_triangles;

/* The caller releases them, after errors, too. Errors: MEMORY, CANCELLED. */
conic_status conic_densify_triangles_find(const conic_surface *surface, const conic_densify_options *options,
                                          conic_workspace *workspaces, conic_densify_triangles *triangles);
void conic_densify_triangles_release(conic_context *context, conic_densify_triangles *triangles);

/* Triangle i, with its normals on the samples' side. It is bent where its corners' normals agree with its own. */
void conic_densify_triangle(const conic_densify_triangles *triangles, size_t i, conic_dart_triangle *triangle);
