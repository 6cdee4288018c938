/* Data that the steps to a skin share. */
#pragma once

#include "core/estimate/neighbours.h"
#include "surface/skin/skin.h"

/* A triangle that at least one corner would have: slots, the least first, counter-clockwise. */
typedef struct conic_skin_triangle {
  uint32_t slots[3];
  int n_votes; /* how many corners would have it */
  float reach; /* the radius of its circle */
} conic_skin_triangle;

typedef struct conic_skin_search {
  conic_context *context;
  const conic_splats *splats;
  double cutoff;
  conic_neighbours tree;
  float *normal[3]; /* by slot: unit, first the splat's own normal, then the mean about it; zero where there is none */
  size_t n_triangles;
  conic_skin_triangle *triangles;
  uint8_t *is_closed; /* by slot: the kept triangles close all around it */

  /* The triangles about each slot: 3 · triangle + its corner there, or CONIC_NO_TRIANGLE. */
  uint32_t *heads;     /* of each slot: the triangle taken last */
  uint32_t (*next)[3]; /* of each corner of a triangle: the triangle taken there before */
} conic_skin_search;

/* The splat's ellipse: q = (δ·u)² + (δ·v)² is below 1 within its outline. Returns 0 for a splat without an ellipse. */
int conic_skin_ellipse(const conic_skin_search *search, uint32_t slot, double u[3], double v[3]);

#define CONIC_NO_TRIANGLE UINT32_MAX

/* The slot at which the triangle of a corner begins (0) or ends (1), seen from the side of the corner's normal. */
static inline uint32_t conic_skin_end(const conic_skin_search *search, uint32_t at, uint32_t end) {
  return search->triangles[at / 3].slots[(at % 3 + 1 + end) % 3];
}

/* The triangle about a slot that begins (0) or ends (1) at another slot; or none. */
uint32_t conic_skin_about(const conic_skin_search *search, uint32_t slot, uint32_t end, uint32_t other);

/* Puts triangle i into the lists of its corners. */
void conic_skin_take(conic_skin_search *search, uint32_t i);

/* Whether a triangle's corners face as it does, with at least that cosine, and their splats, enlarged by `enlarged`,
 * meet in the middle of its circle. Fills in its reach. */
int conic_skin_is_covered(const conic_skin_search *search, double least_cosine, double enlarged,
                          conic_skin_triangle *triangle);

/* Lists the triangles that corners would have and their splats cover. Errors: MEMORY. */
conic_status conic_skin_candidates(conic_skin_search *search);

/* Keeps candidates that fit each other, the best first. Errors: MEMORY. */
conic_status conic_skin_choose(conic_skin_search *search);

/* Finds the normals, colours and lifts of the splats that have slots. */
void conic_skin_look(const conic_skin_search *search, conic_skin *skin);
