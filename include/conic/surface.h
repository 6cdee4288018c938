/* Point-set surfaces: the smooth surface that a set of points stands for, and cleaner, smaller or denser sets of its
 * points.
 *
 * A surface consists of the points that a projection does not move: moving least squares (Alexa et al. 2003: a local
 * plane, and a polynomial over it) or algebraic spheres (Guennebaud and Gross 2007). docs/reference/surfaces.md has the
 * formulas. The results never depend on the number of threads, the instruction set or the compiler. */
#ifndef CONIC_SURFACE_H
#define CONIC_SURFACE_H

#include "conic/model.h"
#include "conic/render.h"

CONIC_BEGIN_C

typedef enum conic_surface_type {
  CONIC_SURFACE_MLS = 0, /* a polynomial over the local plane */
  CONIC_SURFACE_APSS = 1 /* a sphere fitted to points and normals */
} conic_surface_type;

/* Which plane a polynomial stands over. */
typedef enum conic_surface_plane {
  CONIC_PLANE_FULL = 0, /* the minimum of Eq. 2: its weights are about the point's foot in the plane */
  CONIC_PLANE_FAST = 1  /* through the point itself, with weights about the point: not a true projection */
} conic_surface_plane;

/* How a sample's weight falls with its distance d, in terms of x = d / h. */
typedef enum conic_surface_weight {
  CONIC_WEIGHT_GAUSS = 0,   /* exp(-x²), less its tangent (in x²) at the neglect distance, so that it ends smoothly */
  CONIC_WEIGHT_COMPACT = 1, /* 2y³ - 3y² + 1, y = x / neglect */
  CONIC_WEIGHT_FLAT = 2     /* (1 - y⁴)² */
} conic_surface_weight;

#define CONIC_SURFACE_MAX_DEGREE 4

typedef struct conic_surface_options {
  size_t size; /* sizeof(conic_surface_options), set by the init function */
  conic_surface_type type;
  conic_surface_plane plane;   /* of MLS */
  conic_surface_weight weight; /* of either type */
  int degree;                  /* of MLS: 1 to 4 */
  double h;                    /* in world units; 0: local, from the distance to each sample's n_local-th neighbour */
  double neglect;              /* samples farther than this many h weigh nothing: 1 to 6 */
  int n_local;                 /* for a local h: that neighbour lies at the neglect distance; 6 to 64 */
  double cluster;              /* cells smaller than this times their distance are summed as one; 0 (none) to 1 */
  conic_isa isa;
  uint64_t is_sharp; /* not 0: creases stay sharp; not with clusters, nor cell by cell */
  uint64_t reserved[7];
} conic_surface_options;

/* MLS, full plane, Gaussian, degree 3, local h by 32 neighbours, neglected from 2 h on, no clusters. */
CONIC_API void conic_surface_options_init_sized(conic_surface_options *options, size_t size);
#define conic_surface_options_init(options) conic_surface_options_init_sized(options, sizeof *(options))

typedef struct conic_surface conic_surface;

/* Prepares the surface of the points of `points`. Normals (the set's, or those of its axes) and colours are used where
 * it has them. The set is copied. On success the caller owns *surface, which must not outlive the context. Errors:
 * ARGUMENT (options out of range; APSS without normals), INPUT (no finite point), UNSUPPORTED (the instruction set),
 * MEMORY, CANCELLED. */
CONIC_API conic_status conic_surface_create(conic_context *context, const conic_splats *points,
                                            const conic_surface_options *options, conic_surface **surface);
CONIC_API void conic_surface_destroy(conic_surface *surface);

/* What became of a point. Unless it is DONE, no point of the surface was found, and none is made up. */
typedef enum conic_surface_outcome {
  CONIC_SURFACE_DONE = 0,
  CONIC_SURFACE_NOT_FINITE = 1,
  CONIC_SURFACE_TOO_FEW = 2,        /* fewer samples within reach than coefficients */
  CONIC_SURFACE_NO_MINIMUM = 3,     /* the search settles on no plane (or sphere) within h / 2 of the point */
  CONIC_SURFACE_ILL_CONDITIONED = 4 /* the samples do not determine the polynomial at the point */
} conic_surface_outcome;

#define CONIC_N_SURFACE_OUTCOMES 5
#define CONIC_MAX_SURFACE_OUTCOMES 16

/* "done", "not finite" …; null for a number that is none. */
CONIC_API const char *conic_surface_outcome_name(conic_surface_outcome outcome);

/* A projected point. Unless the outcome is DONE, position is the point's own and the rest is zero. */
typedef struct conic_surface_point {
  double position[3];     /* on the surface, in world units */
  double normal[3];       /* of the surface there, unit; on the side of the samples' normals where they have some */
  double color[3];        /* the samples', by the same weights; white where they have none */
  double foot[3];         /* q, where the local plane (or sphere) was found */
  double plane_normal[3]; /* of the local plane; APSS: the normal */
  double h;               /* the scale there */
  int n_neighbours;       /* samples (and clusters) that weighed something */
  conic_surface_outcome outcome;
} conic_surface_point;

/* Projects `count` points in world coordinates onto the surface: points[i] is the projection of positions[i]. Errors:
 * MEMORY, CANCELLED; the points are then undefined. */
CONIC_API conic_status conic_surface_project(conic_surface *surface, size_t count, const double (*positions)[3],
                                             conic_surface_point *points);

/* The distances of one surface's points from another surface. */
typedef struct conic_surface_distance {
  double max, rms;
  size_t n_measured, n_failed; /* points of the first surface; those with nothing of the second near them */
  uint64_t reserved[4];
} conic_surface_distance;

/* How points were moved, and how many could not be. */
typedef struct conic_surface_report {
  size_t n_in, n_out;
  size_t outcomes[CONIC_MAX_SURFACE_OUTCOMES]; /* of the points projected */
  double moved_rms, moved_max;                 /* in world units, over the DONE points */
  double mean_neighbours;
  double h;     /* the median of the samples' h */
  double error; /* thin: the greatest contribution of a point that was removed; densify: the widest gap left */
  conic_surface_distance there,
      back;             /* thin, where it is measured: from the set's surface to the new one's, and back */
  size_t n_evaluations; /* projections that were computed */
  uint64_t n_flat;      /* densify: new points that stay in their triangle, because no surface was found */
  uint64_t n_merged;    /* of the points projected by polynomials: those between two sheets */
  uint64_t reserved[6];
} conic_surface_report;

/* Projects the surface's own points. `projected` gets the DONE ones, in their old order, with normals and colours where
 * the samples have some; duplicates stay. The caller releases it. Errors: MEMORY, CANCELLED; *projected is then
 * empty. */
CONIC_API conic_status conic_surface_clean(conic_surface *surface, conic_splats *projected,
                                           conic_surface_report *report);

/* Where the points of a large set come from. Each call hands all of them to `receive`, batch by batch, in the same
 * order and with the same optional arrays and origin. */
typedef conic_status conic_points_source(void *cookie, conic_batch_receiver *receive, void *to);

/* Where the DONE points go: first `begin`, with how many there will be and which arrays they have; then `receive`, with
 * the points in their old order, in batches. */
typedef struct conic_points_sink {
  conic_status (*begin)(void *cookie, const conic_surface_report *report, unsigned fields);
  conic_batch_receiver *receive;
  void *cookie;
  uint64_t reserved[4];
} conic_points_sink;

typedef struct conic_clean_options {
  size_t size;                   /* sizeof(conic_clean_options), set by the init function */
  conic_surface_options surface; /* with h, and without clusters */
  size_t memory_bytes;           /* the most to take at a time; 0: no limit */
  const char *scratch;           /* data that does not fit goes beside this path, to files without a name; null:
                                    nowhere */
  const char *name;              /* of the set that the points are read from, for messages; null: "surface" */
} conic_clean_options;

/* The surface's defaults, for which h is still to be set. */
CONIC_API void conic_clean_options_init_sized(conic_clean_options *options, size_t size);
#define conic_clean_options_init(options) conic_clean_options_init_sized(options, sizeof *(options))

/* conic_surface_clean for sets of any size, cell by cell of a lattice with sides of 64 h, each with the points within
 * (neglect + 1.5) h about it. The memory changes no bit. Algebraic spheres find normals for points that have none, and
 * hand none over. Errors: ARGUMENT, INPUT (no finite point), UNSUPPORTED, MEMORY (a cell that does not fit), IO,
 * CANCELLED, the source's and the sink's. */
CONIC_API conic_status conic_surface_clean_cells(conic_context *context, const conic_clean_options *options,
                                                 conic_points_source *source, void *source_cookie,
                                                 const conic_points_sink *sink, conic_surface_report *report);

typedef struct conic_thin_options {
  size_t size;      /* sizeof(conic_thin_options), set by the init function */
  size_t count;     /* points to keep; 0: as few as the error allows */
  double max_error; /* the two surfaces stay within this of each other, as far as it can be measured; 0: no limit */
  int is_measured;  /* measure how far apart they are, even without a limit */
} conic_thin_options;

/* Neither a count nor an error: one of them must be set. */
CONIC_API void conic_thin_options_init_sized(conic_thin_options *options, size_t size);
#define conic_thin_options_init(options) conic_thin_options_init_sized(options, sizeof *(options))

/* Removes the points that matter least, the least first. A point matters by its distance from the surface of the others
 * that are left (PSS §5.1). After a removal, the neighbours are measured anew before they can be removed. The rest is a
 * subset in the old order, with the set's normals and colours. Points that cannot be measured (too few others near
 * them) stay. The caller releases *thinned. Errors: ARGUMENT (neither a count nor an error), MEMORY, CANCELLED. */
CONIC_API conic_status conic_surface_thin(conic_surface *surface, const conic_thin_options *options,
                                          conic_splats *thinned, conic_surface_report *report);

/* How much each point of the set matters: its distance from the surface of the others (PSS §5.1), one for each point;
 * NaN for those that cannot be measured. Coincident points have one value. Errors: MEMORY, CANCELLED. */
CONIC_API conic_status conic_surface_contributions(conic_surface *surface, float *contributions);

typedef struct conic_densify_options {
  size_t size;                    /* sizeof(conic_densify_options), set by the init function */
  double spacing;                 /* no circle of a greater radius stays empty */
  double hole;                    /* wider circles are holes and stay; 0: 1.25 h. Not for given triangles */
  size_t max_count;               /* points in all; 0: 2³² - 2 */
  size_t n_triangles;             /* 0: the triangles that points make with their neighbours */
  const uint32_t (*triangles)[3]; /* where the surface is; each a number below the set's count */
} conic_densify_options;

/* Holes wider than 1.25 h stay, any number of points; the spacing must be set. */
CONIC_API void conic_densify_options_init_sized(conic_densify_options *options, size_t size);
#define conic_densify_options_init(options) conic_densify_options_init_sized(options, sizeof *(options))

/* Adds points of the surface where the set has gaps, the widest first (PSS §5.2), within triangles of points: borders
 * stay where they are. Where nothing can be projected, the new point lies in its triangle, as a splat would, if the
 * triangle is a mesh's or its corners face the same way. The old points come first, unchanged. The caller releases
 * *dense. Errors: ARGUMENT, MEMORY, CANCELLED. */
CONIC_API conic_status conic_surface_densify(conic_surface *surface, const conic_densify_options *options,
                                             conic_splats *dense, conic_surface_report *report);

/* Projects the points of `from` onto `from`, and the results onto `to`; measures the second step. The greater distance
 * of both directions is the Hausdorff distance, as far as the points tell. Errors: MEMORY, CANCELLED. */
CONIC_API conic_status conic_surface_deviation(conic_surface *from, conic_surface *to,
                                               conic_surface_distance *distance);

CONIC_END_C
#endif
