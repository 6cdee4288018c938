/* The places that surfels are put at, and what of the cluster each of them stands for. */
#ifndef CONIC_CLUSTER_SITES_H
#define CONIC_CLUSTER_SITES_H

#include "core/base/radix.h"
#include "core/splats/ellipse.h"
#include "lod/clusters/cluster_sample.h"
#include "lod/clusters/place_table.h"

/* Every face is looked at through a lattice of places, and small triangles between them. It splits each side of the
 * face into `sides` pieces. */
typedef struct conic_face_lattice {
  uint32_t face;
  int sides, depth; /* how often the spacing is halved here */
  uint32_t first;   /* of its places among all */
} conic_face_lattice;

static inline uint32_t conic_face_lattice_places(int sides) {
  return (uint32_t)((sides + 1) * (sides + 2) / 2);
}

/* The place (i, j), i + j ≤ sides: i steps along the first side, j along the second. */
static inline uint32_t conic_face_lattice_place(const conic_face_lattice *l, int i, int j) {
  return l->first + (uint32_t)(i * (l->sides + 1) - i * (i - 1) / 2 + j);
}

static inline void conic_face_lattice_bary(const conic_face_lattice *l, int i, int j, double bary[3]) {
  bary[1] = (double)i / (double)l->sides;
  bary[2] = (double)j / (double)l->sides;
  bary[0] = (double)(l->sides - i - j) / (double)l->sides;
}

typedef struct conic_site {
  double at[3], facing[3]; /* of its face */
  uint32_t face, place;    /* where it was chosen */
  uint32_t last;           /* the same site in the last pass, or NO_SITE */
  int is_settled;          /* all of it is as in the last pass */
  double bary[3], spacing;
  /* Sums over what it stands for. */
  double normal[3], color[3], area;
  double u[3], v[3]; /* its plane */
  conic_ellipse ellipse;
  double lowest_seen[3], highest_seen[3], contrast; /* of the colours that it stands for: a box in OKLab */
  size_t n_supports, first_support;                 /* in the sampler's `of_sites` */
  double lowest, highest;                           /* of what it stands for, above the plane through its place */
  double height;                                    /* the most of that, from its plane along a face's normal */
  double foot[3];        /* the place where it was chosen, from which its supports are seen */
  double least_error;    /* the part of the error that needs no look at the mesh */
  double error;          /* conic_site_error of it, from the tolerance on */
  double error_bound;    /* no less than that error, also below the tolerance */
  int is_drawn;          /* it stands for something that has an area */
  uint32_t end_faces[4]; /* what lies towards the ends of the ellipse's axes, in turn */
} conic_site;

/* A point that a site's ellipse must cover. */
typedef struct conic_support {
  uint32_t site, face;
  double above, cosine, slope[2]; /* its height, and how its face is tilted: the cosine, and the tangent's parts */
  double at[2];                   /* in the plane */
} conic_support;

/* What the next pass may look up of the last. */
typedef struct conic_sampling_pass {
  size_t n_sites, lattices_room, owner_room, sites_room;
  conic_face_lattice *lattices;
  uint32_t *owner;
  conic_site *sites;
} conic_sampling_pass;

struct conic_sampler {
  conic_context *context;
  const conic_sampling_job *job;
  conic_sampling_pass last;
  size_t n_lattices, lattices_room, facing_room;
  conic_face_lattice *lattices;
  double (*facing)[3]; /* of each lattice's face */
  uint8_t *depth;      /* of each face of the cluster: how often the spacing is halved there */
  size_t depth_room;
  int coarsest, finest; /* of those */
  size_t n_places, places_room, owner_room;
  double (*places)[3];  /* where they are */
  uint32_t *lattice_of; /* of each place: its lattice */
  uint32_t *owner;      /* of each place: a site */
  size_t n_candidates, candidates_room, seeds_room;
  conic_radix_item *candidates; /* key: when its turn is; value: its number */
  uint32_t (*seeds)[2];         /* of each candidate: lattice, and i << 16 | j */
  size_t n_sites, sites_room;
  conic_site *sites;
  conic_place_table table;                    /* of the places */
  size_t n_supports, n_sorted, supports_room; /* of all passes; sorted, of those before */
  conic_support *supports;
  uint32_t *of_sites; /* supports, site by site */
  size_t of_sites_room, points_room;
  double *points[2]; /* of one site's supports, where they come to lie in its plane */
};

static inline double conic_spacing_at(const conic_sampler *sampler, int depth) {
  return sampler->job->spacing / (double)(1 << depth);
}

/* Whether a place is this lattice's. Where two faces of the cluster share a side, only one has its places. */
int conic_face_lattice_is_own(const conic_clustered_mesh *mesh, const conic_face_lattice *lattice, int i, int j);

/* Fills in lattices, sites and owners. Errors: MEMORY. */
conic_status conic_cluster_find_sites(conic_sampler *sampler);

#endif
