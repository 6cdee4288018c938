/* A surface's members, and the functions that its parts share. */
#pragma once

#include "core/estimate/neighbours.h"
#include "surface/loops/surface_loops.h"

/* Cells of the tree that are summed as one sample each (PSS §3.4.2); made on request. */
typedef struct conic_surface_clusters {
  double (*centroid)[3];
  double *mass;
  float *size;        /* the diagonal of the node's box */
  float (*normal)[3]; /* means; null where the samples have none */
  float (*color)[3];
  float *h;
} conic_surface_clusters;

/* A sharp surface's data of each slot. */
typedef struct conic_surface_creases {
  float (*side)[3]; /* the unit normal, of either sign, of the slot's side; null: the surface is not sharp */
  float *spacing;
} conic_surface_creases;

struct conic_surface {
  conic_context *context;
  conic_surface_options options;
  conic_surface_loops loops;
  conic_weighing weighing;
  conic_splats points; /* a copy: positions, unit normals and colours, by point */
  conic_neighbours tree;
  float *h;          /* by slot; NaN: the slot does not take part */
  float *mass;       /* by slot: how many points coincide there */
  float *node_reach; /* by node of the tree: the greatest neglect distance in it */
  float *normal[3];  /* by slot; null where the points have none */
  float *color[3];   /* by slot; null where the points have none */
  double median_h;
  conic_surface_clusters clusters;
  conic_surface_creases creases;
};

/* A point's unit normal: its axes', else the given one; zero where there is none. */
void conic_surface_unit_normal(const conic_splats *points, size_t i, double normal[3]);

/* The samples near a box, in the tree's order, from which the points in it choose their neighbours. */
typedef struct conic_candidates {
  size_t n, capacity;
  uint32_t *sources;  /* slots; clusters as CONIC_CLUSTER_BIT and the node */
  conic_near samples; /* the same as `select` takes them */
} conic_candidates;

#define CONIC_CLUSTER_BIT UINT32_C(0x80000000)

/* The polynomial over a plane, in coordinates about its origin q = r + t·n, in units of h along the frame's first two
 * rows. The height over q is h · Σ c_k · x^i y^j, k counting 1, x, y, x², xy, y², x³ …. The factor of the samples'
 * columns tells how errors grow (conic_fit_gain). */
typedef struct conic_fit {
  double value, slope[2];      /* at q */
  double frame[3][3], foot[3]; /* q - r */
  double coefficients[CONIC_MAX_COLUMNS];
  int n_columns; /* without the heights, which are the last column */
  double upper[CONIC_MAX_COLUMNS][CONIC_MAX_COLUMNS], norms2[CONIC_MAX_COLUMNS];
} conic_fit;

/* A thread's memory. */
typedef struct conic_workspace {
  conic_context *context;
  conic_candidates shared; /* for all points of a box */
  conic_candidates single; /* for one point */
  conic_near near;
  conic_near other_near; /* of a second point, while the first point's are still needed */
  conic_fit fit;         /* of the last projected point; valid where a polynomial made it DONE */
  const float *side;     /* if not null, samples whose normals point away from this do not count */
  size_t n_evaluations;
  int is_trusting;      /* found points are not looked for again: for measuring, not for results */
  int is_out_of_memory; /* set where memory ran out; the result is then missing */
} conic_workspace;

/* Makes one workspace for each thread. Errors: MEMORY. */
conic_status conic_workspaces_create(conic_context *context, conic_workspace **workspaces);
void conic_workspaces_release(conic_context *context, conic_workspace *workspaces);
/* MEMORY where any workspace ran out of memory. */
conic_status conic_workspaces_check(const conic_context *context, const conic_workspace *workspaces);
/* Adds the evaluations that the workspaces counted, in all processes of a team, and resets the counts. Errors:
 * CANCELLED. */
conic_status conic_workspaces_count(conic_context *context, conic_workspace *workspaces, size_t *n_evaluations);

/* Finds the samples whose neglect distance, plus the margin, reaches into the box (least x, y, z, greatest x, y, z);
 * `candidates` is one of the workspace's. */
void conic_surface_gather(const conic_surface *surface, const double box[6], double margin, conic_workspace *workspace,
                          conic_candidates *candidates);

/* conic_surface_gather for the points of a leaf of the tree, into the workspace's shared candidates. */
void conic_surface_share_leaf(const conic_surface *surface, size_t i_leaf, conic_workspace *workspace);

/* Makes the candidates that reach r, plus the margin, the workspace's neighbours, without the slot `except`
 * (CONIC_NO_SLOT: none). */
void conic_surface_select(const conic_surface *surface, const conic_candidates *candidates, const double r[3],
                          double margin, uint32_t except, conic_workspace *workspace);

/* The projection of r, which is relative to the set's origin. */
typedef struct conic_landing {
  double offset[3]; /* from r */
  double normal[3];
  double foot[3]; /* q - r */
  double plane_normal[3];
  double h;
  int n_neighbours;
  conic_surface_outcome outcome;
} conic_landing;

/* Projects r, where the scale is h. With `has_shared`, the workspace's shared candidates are those of a box that holds
 * r, with a margin of at least twice conic_surface_margin(h); else it gathers its own. */
void conic_surface_project_one(const conic_surface *surface, const double r[3], double h, uint32_t except,
                               int has_shared, conic_workspace *workspace, conic_landing *projection);

/* How far a foot may be from its point before neighbours must be gathered anew. */
double conic_surface_margin(const conic_surface *surface, double h);

/* The samples' attributes, weighted like the workspace's neighbours: the unit normal (zero where there is none) and the
 * colour (white where there is none). */
void conic_surface_attributes(const conic_surface *surface, const conic_workspace *workspace, double normal[3],
                              double color[3]);

/* The scale about a place: the option's, or that of the nearest slot. */
double conic_surface_scale(const conic_surface *surface, const double r[3]);

/* Finds the reference plane near r from the workspace's neighbours, which reach r with `margin`; |t| stays within it.
 * Begins at the given frame and t. On DONE, the frame's third row is n and q = r + t·n. */
conic_surface_outcome conic_surface_find_plane(const conic_surface *surface, double h, double margin,
                                               conic_workspace *workspace, double frame[3][3], double *t);

/* A frame whose third row is the neighbours' direction of least spread, by their covariance about their centroid, with
 * weights about r; also the centroid's height over r. TOO_FEW where that is not defined. */
conic_surface_outcome conic_surface_first_plane(const conic_surface *surface, size_t n_least,
                                                conic_workspace *workspace, double frame[3][3], double *height);

/* Fits the polynomial over a plane at its origin q = r + t·n, with the workspace's weights, which are about q. Returns
 * TOO_FEW, ILL_CONDITIONED or DONE. */
conic_surface_outcome conic_surface_fit(const conic_surface *surface, double h, conic_workspace *workspace,
                                        double frame[3][3], double t, conic_fit *fit);

/* Finds the coefficients of the best polynomial of a degree, which must not exceed the fitted one. */
void conic_fit_solve(conic_fit *fit, int degree);

/* The variance of the polynomial's value at (x, y), in units of h, if each sample has the variance 1 / weight. */
double conic_fit_gain(const conic_fit *fit, int degree, double x, double y);

/* Finds the algebraic sphere's point for r. */
conic_surface_outcome conic_surface_find_sphere(const conic_surface *surface, double h, double margin,
                                                conic_workspace *workspace, conic_landing *projection);

/* Surfaces with creases: which side of a crease each sample is on, and projection where sides meet. */

/* Finds the normal of each slot's side, and its spacing. Errors: MEMORY, CANCELLED. */
conic_status conic_creases_find(conic_surface *surface);
void conic_creases_release(conic_surface *surface);

/* Projects r onto the nearest of the pieces that meet near it, or onto the edge or corner where they meet. Where there
 * is only one piece, returns 0; only the workspace's neighbours are then changed. */
int conic_creases_project(const conic_surface *surface, const double r[3], double h, uint32_t except,
                          conic_workspace *workspace, conic_landing *landing);
