/* The places that surfels are put at, and what of the patch each of them stands for. */
#ifndef LOD_PATCH_SITES_H
#define LOD_PATCH_SITES_H

#include "core/ellipse.h"
#include "lod/patch_sample.h"
#include "lod/radix.h"

/* Every face is looked at through a lattice that parts its sides into `sides` pieces: places, and the small triangles
 * between them. */
typedef struct conic_lattice {
  uint32_t face;
  int sides;
  uint32_t first; /* of its places among all */
} conic_lattice;

static inline uint32_t conic_lattice_places(int sides) {
  return (uint32_t)((sides + 1) * (sides + 2) / 2);
}

/* The place (i, j), i + j ≤ sides: i steps along the first side, j along the second. */
static inline uint32_t conic_lattice_place(const conic_lattice *l, int i, int j) {
  return l->first + (uint32_t)(i * (l->sides + 1) - i * (i - 1) / 2 + j);
}

static inline void conic_lattice_bary(const conic_lattice *l, int i, int j, double bary[3]) {
  bary[1] = (double)i / (double)l->sides;
  bary[2] = (double)j / (double)l->sides;
  bary[0] = (double)(l->sides - i - j) / (double)l->sides;
}

typedef struct conic_site {
  double at[3], facing[3]; /* of its face */
  uint32_t face, next;     /* the next in its cell */
  double bary[3];
  /* Sums over what it stands for. */
  double normal[3], color[3], area, covariance[3];
  double u[3], v[3]; /* its plane */
  double middle[2];  /* of what it stands for, in the plane */
  conic_ellipse ellipse;
  double height;          /* of what it stands for above its plane, the most */
  double low[2], high[2]; /* the box of that, in the plane */
} conic_site;

/* A point that a site's ellipse must cover, in its plane. */
typedef struct conic_support {
  uint32_t site;
  double at[2];
} conic_support;

struct conic_sampler {
  conic_context *context;
  const conic_sampling_job *job;
  size_t n_lattices, lattices_room;
  conic_lattice *lattices;
  double (*facing)[3]; /* of each lattice's face */
  size_t n_places, places_room;
  uint32_t *owner; /* of each place: a site */
  size_t n_candidates, candidates_room;
  conic_radix_item *candidates; /* key: when its turn is; value: its number */
  uint32_t (*seeds)[2];         /* of each candidate: lattice, and i << 16 | j */
  size_t n_sites, sites_room;
  conic_site *sites;
  size_t table_room;
  uint32_t *table; /* first site of a cell, by its hash */
  size_t table_mask;
  double low[3];
  size_t n_supports, supports_room;
  conic_support *supports;
};

/* Fills in lattices, sites and owners. Errors: MEMORY. */
conic_status conic_patch_find_sites(conic_sampler *sampler);

/* Room for `count` in an array of the sampler's that grows by half. Errors: MEMORY. */
conic_status conic_sampler_grow(conic_sampler *sampler, void **array, size_t used, size_t count, size_t *room,
                                size_t size);

#endif
