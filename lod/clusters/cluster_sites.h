/* Making the surfels of a cluster: the places that they are put at, and what each of them stands for. */
#pragma once

#include "core/base/radix.h"
#include "core/splats/ellipse.h"
#include "lod/clusters/cluster_sample.h"

/* --- the smallest ellipse --- */

enum { CONIC_LEAST_ELLIPSE_POINTS = 8 };

/* Finds nearly the smallest ellipse about the points, 1 to CONIC_LEAST_ELLIPSE_POINTS: its centre, and its shape as a
 * covariance xx, xy, yy up to a factor. How large it is, the points themselves must say. */
void conic_least_ellipse(const double (*points)[2], int n_points, double center[2], double covariance[3]);

/* --- places, found by where they are --- */

/* Where the surface needs it, surfels lie closer: by halves, so many times at most. */
enum { CONIC_MOST_DEPTH = 3 };

#define CONIC_NO_SITE UINT32_MAX

/* The least cosine between two faces that may have a surfel in common. */
#define CONIC_SITES_ALIKE 0.7

/* The places that sites are to be found for, by groups that face alike and ask for sites of one spacing. */
typedef struct conic_places {
  size_t n;
  const double (*at)[3];
  const uint32_t *group;     /* of each place */
  const double (*facing)[3]; /* of each group: unit */
  const uint8_t *depth;      /* of each group: how often the spacing is halved */
  double spacing;            /* of depth 0 */
  int coarsest, finest;      /* depths that there are */
} conic_places;

/* Each depth has cells of its own, so that few are looked at. What lies in a cell is next to each other, so that they
 * are looked at fast. Zero before the first use. */
typedef struct conic_place_table {
  conic_places places;
  uint32_t *owner;
  size_t room, starts_room, mask;
  uint32_t *starts; /* of each cell in `place` and `at`, by its hash; mask + 1 for each depth */
  uint32_t *place;  /* its number */
  double *at[3];
  double *nearest2; /* the squared distance of its owner; without one, as far as one may be */
} conic_place_table;

/* Takes the places in; their arrays must last as long as the table is used. Sets all owners, for which the caller has
 * room, to NO_SITE. Errors: MEMORY. */
conic_status conic_place_table_fill(conic_context *context, conic_place_table *table, const conic_places *places,
                                    uint32_t *owner);

/* Puts a site there; their numbers ascend. Among the places from number `first` on, it becomes the owner of those that
 * are no farther than the spacing, face alike, and have no owner as near. */
void conic_place_table_put(conic_place_table *table, uint32_t site, const double at[3], const double facing[3],
                           size_t first);

void conic_place_table_release(conic_context *context, conic_place_table *table);

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

/* What a pass makes, of which the next may look up the last. */
typedef struct conic_sampling_pass {
  size_t n_sites, lattices_room, owner_room, sites_room;
  conic_face_lattice *lattices;
  uint32_t *owner; /* of each place: a site */
  conic_site *sites;
} conic_sampling_pass;

struct conic_sampler {
  conic_context *context;
  const conic_sampling_job *job;
  conic_sampling_pass now, last;
  size_t n_lattices, facing_room;
  double (*facing)[3]; /* of each lattice's face */
  uint8_t *depth;      /* of each face of the cluster: how often the spacing is halved there */
  size_t depth_room;
  int coarsest, finest; /* of those */
  size_t n_places, places_room;
  double (*places)[3];  /* where they are */
  uint32_t *lattice_of; /* of each place: its lattice */
  size_t n_candidates, candidates_room, seeds_room;
  conic_radix_item *candidates;               /* key: when its turn is; value: its number */
  uint32_t (*seeds)[2];                       /* of each candidate: lattice, and i << 16 | j */
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

/* Fills in lattices, sites and owners. Errors: MEMORY. */
conic_status conic_cluster_find_sites(conic_sampler *sampler);

/* --- contrasts --- */

/* The box of no colour. */
void conic_site_begin_contrast(conic_site *site);

/* Widens the box by a linear colour. */
void conic_site_note_color(conic_site *site, const double color[3]);

/* Takes the diagonal of the box as the site's contrast, in steps of 1: black and white. */
void conic_site_end_contrast(conic_site *site);

/* How the colours that a site stands for differ from its own, which is in their middle. They are smeared as far as it
 * reaches. */
conic_seen_change conic_site_change(const conic_site *site);

/* The root mean square over all sites, or what is known where that is more. */
conic_seen_change conic_sites_change(const conic_sampler *sampler, conic_seen_change known);

/* Fills in the contrasts of the sites that are not settled: how far apart the colours are of the places that they own,
 * and of details between these. */
void conic_cluster_find_contrasts(conic_sampler *sampler);

/* --- planes and ellipses --- */

/* Fills in the sums, planes, ellipses and errors of the sites that are not settled. Errors: MEMORY. */
conic_status conic_cluster_shape_sites(conic_sampler *sampler);

/* Fills in the planes of sites whose normals were summed up. */
void conic_cluster_settle_planes(conic_sampler *sampler);

/* Notes that a site, whose plane is known, must cover a place of that face; the face is seen straight on along
 * `facing`. Errors: MEMORY. */
conic_status conic_cluster_note_support(conic_sampler *sampler, uint32_t site, const double at[3], uint32_t face,
                                        const double facing[3]);

/* Finds the sites' ellipses and errors, from their planes and what was noted. Errors: MEMORY. */
conic_status conic_cluster_shape_supported(conic_sampler *sampler);

/* --- errors --- */

/* The greatest of three, or `known` where that is more; in any case no more than *bound. How far what the site stands
 * for is from its plane, along the faces' normals. How far its outline is from the mesh, as measured at twenty places.
 * How far it smears colours: its longest half axis, times the share of black and white by which they differ. */
double conic_site_error(const conic_sampler *sampler, const conic_site *site, double known, double *bound);

/* How far the surfel is from the mesh, or `known` where that is more. It is measured at its centre and at forty places
 * of its outline, and off the mesh at 120 places between. */
double conic_site_off_mesh(const conic_sampler *sampler, const conic_site *site, double known);

/* --- what a pass takes over from the last --- */

/* Puts this pass's lattices, owners and sites aside, as the last one's. */
void conic_cluster_end_pass(conic_sampler *sampler);

/* Called when new sites and owners have been found. A site is settled where all that it stands for, and all that lies
 * on the same faces, belongs to the same sites as in the last pass. It then takes over all that it had there. */
void conic_cluster_settle_sites(conic_sampler *sampler);
