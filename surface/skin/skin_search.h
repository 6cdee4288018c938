/* What the steps to sheets know of a set. */
#ifndef CONIC_SKIN_SEARCH_H
#define CONIC_SKIN_SEARCH_H

#include "core/estimate/neighbours.h"
#include "surface/skin/skin.h"

/* A triangle that one corner or more would have: slots, the least first, counter-clockwise. */
typedef struct conic_skin_triangle {
  uint32_t slots[3];
  int n_votes; /* how many corners would */
  float reach; /* the radius of its circle */
} conic_skin_triangle;

typedef struct conic_skin_search {
  conic_context *context;
  const conic_splats *splats;
  double cutoff;
  conic_neighbours tree;
  float *normal[3]; /* by slot: unit, or zero where it has no part in sheets */
  size_t n_triangles;
  conic_skin_triangle *triangles;
  uint8_t *is_closed; /* by slot: the triangles that were kept close all around it */
} conic_skin_search;

/* The splat's ellipse: q = (δ·u)² + (δ·v)² is below 1 within its outline. Returns 0 where it has none. */
int conic_skin_ellipse(const conic_skin_search *search, uint32_t slot, double u[3], double v[3]);

void conic_skin_place(const conic_skin_search *search, uint32_t slot, double place[3]);
void conic_skin_normal(const conic_skin_search *search, uint32_t slot, double normal[3]);

/* Lists the triangles that corners would have, and that their splats cover. Errors: MEMORY. */
conic_status conic_skin_candidates(conic_skin_search *search);

/* Keeps those that fit each other, the best first, in pieces that are not small. Errors: MEMORY. */
conic_status conic_skin_choose(conic_skin_search *search);

/* Finds the normals and colours that the picture shows at each splat. */
void conic_skin_look(const conic_skin_search *search, conic_skin *skin);

#endif
