/* Hybrid models: a mesh in clusters, which are drawn as triangles where the surface is flat and as surfels where it is
 * not (docs/reference/hybrid.md). */
#ifndef CONIC_HYBRID_H
#define CONIC_HYBRID_H

#include "conic/layers_draw.h"

CONIC_BEGIN_C

typedef struct conic_hybrid conic_hybrid;

/* How surfels are put on clusters. */
typedef enum conic_sampling {
  CONIC_SAMPLING_BLUE = 0, /* blue noise, ellipses that cover the cluster */
  CONIC_SAMPLING_BOX = 1   /* where lines along the three axes meet it (HQP §3.3.2), for comparison */
} conic_sampling;

typedef struct conic_hybrid_options {
  size_t size;      /* sizeof(conic_hybrid_options), set by the init function */
  double phase1;    /* flat faces are joined up to this cost */
  double phase2;    /* small clusters are gathered up to this cost, and become surfels */
  double most_area; /* the largest share of the whole area that a cluster of the first phase may have; 0: by the number
                       of faces */
  conic_sampling sampling;
  double density;    /* surfels along the mean edge of a cluster */
  double most_error; /* of a cluster's surfels as built, in distances between them: with more it stays triangles; 0: all
                        do. Not for BOX */
  float cutoff;      /* F_g of the kernel that will draw */
  int has_single_levels; /* leave out what only --error needs: simpler levels, and the other kind of each cluster */
} conic_hybrid_options;

/* 0.12, 0.4, by the number of faces, BLUE, 2 surfels, 0.5, cutoff 1.5, all levels. */
CONIC_API void conic_hybrid_options_init_sized(conic_hybrid_options *options, size_t size);
#define conic_hybrid_options_init(options) conic_hybrid_options_init_sized(options, sizeof *(options))

/* What became of the mesh's faces, and how long that took. */
typedef struct conic_hybrid_report {
  size_t n_faces;
  size_t nan, zero;              /* of n_faces, left out: a corner is not finite; the corners are not three places */
  size_t welded;                 /* vertices at the place of an earlier one */
  size_t open, crowded, twisted; /* edges of one face, of over two, and with faces that cannot agree */
  size_t turned;                 /* faces wound against their neighbours */
  size_t n_pieces;               /* connected parts */
  size_t n_first;                /* clusters after the first phase */
  double cluster_seconds, sample_seconds, simplify_seconds; /* the last two: summed over all threads */
  uint64_t n_points, n_kept;                                /* of a set of splats: all, and those that stay splats */
  uint64_t reserved[6];
} conic_hybrid_report;

/* Takes the mesh's arrays and textures over: *mesh is empty afterwards, on failure too. The result depends on the mesh
 * and the options alone, not on the threads. `report` may be null. On success the caller owns *hybrid, which must not
 * outlive the context. Errors: ARGUMENT, INPUT (no face to draw), MEMORY, CANCELLED. */
CONIC_API conic_status conic_hybrid_build(conic_context *context, conic_triangles *mesh,
                                          const conic_hybrid_options *options, conic_hybrid **hybrid,
                                          conic_hybrid_report *report);

/* How a mesh that is larger than memory is read and built. */
typedef struct conic_hybrid_streaming {
  size_t size;           /* sizeof(conic_hybrid_streaming), set by the init function */
  uint64_t memory_bytes; /* what building may take, without temporary files and 1 KiB a patch; the model does not depend
                            on it */
  double crease_deg;     /* above 0: a mesh without normals gets them by conic_triangles_crease */
  int is_smooth;         /* all normals are replaced by conic_triangles_smooth's */
} conic_hybrid_streaming;

/* 1 GiB, 30 degrees. */
CONIC_API void conic_hybrid_streaming_init_sized(conic_hybrid_streaming *streaming, size_t size);
#define conic_hybrid_streaming_init(streaming) conic_hybrid_streaming_init_sized(streaming, sizeof *(streaming))

/* Builds a model of a PLY of any size, in cells of some 200,000 faces. Between cells no vertex is removed, and the
 * whole is not simplified as one. The temporary files have no name, and lie beside `path` until the model is destroyed.
 * The model depends on the mesh and the options alone. `report` may be null; its counts of open, crowded, twisted,
 * turned and welded, and of pieces, stay 0. On success the caller owns *hybrid, which must not outlive the context.
 * Errors: ARGUMENT, INPUT, IO, MEMORY, CANCELLED. */
CONIC_API conic_status conic_hybrid_build_file(conic_context *context, const char *mesh, const char *path,
                                               const conic_hybrid_options *options,
                                               const conic_hybrid_streaming *streaming, conic_hybrid **hybrid,
                                               conic_hybrid_report *report);
/* Builds a model of splats, which have tangent axes and no strides. Where they lie as a surface does, they become
 * triangles. The others stay splats, without clip lines and opacities. The set is taken over: *splats is empty
 * afterwards, on failure too. n_faces counts the triangles that were made. Errors: ARGUMENT, INPUT (nothing to draw),
 * MEMORY, CANCELLED. */
CONIC_API conic_status conic_hybrid_build_points(conic_context *context, conic_splats *splats,
                                                 const conic_hybrid_options *options, conic_hybrid **hybrid,
                                                 conic_hybrid_report *report);

/* Null is allowed. */
CONIC_API void conic_hybrid_destroy(conic_hybrid *hybrid);

/* Writes a .chy (docs/reference/format-chy.md). Errors: MEMORY, IO, CANCELLED. */
CONIC_API conic_status conic_hybrid_write(conic_hybrid *hybrid, const char *path);

/* Maps the file into memory and checks all of it: sums, sizes, structure. On success the caller owns *hybrid, which
 * must not outlive the context. The file must not be changed while it is in use. Errors: INPUT, IO, MEMORY. */
CONIC_API conic_status conic_hybrid_read(conic_context *context, const char *path, conic_hybrid **hybrid);

/* Opens a path or a URL: reads and checks all but the chunks; pictures read the chunks that they show
 * (docs/reference/format-chy.md). `access` says how a URL is read and, if its memory_bytes are not 0, bounds the memory
 * of index, chunks and the drawn arrays; null: the defaults of conic_layers_access_init, without a bound. A picture may
 * fail later, if part of the file is damaged or cannot be read. On success the caller owns *hybrid, which must not
 * outlive the context; one thread at a time may use it. Errors: INPUT, IO, UNSUPPORTED (a URL, without libcurl),
 * MEMORY, CANCELLED. */
CONIC_API conic_status conic_hybrid_open(conic_context *context, const char *name, const conic_layers_access *access,
                                         conic_hybrid **hybrid);

/* Whether a name is a URL whose path ends in .chy. */
CONIC_API int conic_hybrid_is_url(const char *name);

/* Whether a file that can be read begins like a .chy. */
CONIC_API int conic_hybrid_is_file(const char *path);

typedef struct conic_hybrid_info {
  size_t n_clusters, n_surfel_clusters; /* all clusters, and those that are surfels as built */
  size_t n_triangles, n_surfels;        /* drawn as built, if all is in sight */
  size_t n_levels, n_node_levels; /* ways to draw, of all clusters, and of all nodes of their tree, without points */
  size_t n_all_triangles, n_all_surfels;
  size_t n_vertices, n_textures, n_nodes;
  float cutoff;
  double minimum[3], maximum[3]; /* of the vertices */
  double splat_length;           /* as conic_splats_length of the surfels as built */
  double near_z;                 /* 1e-4 × the box's diagonal */
  uint64_t n_bytes;              /* of the file that holds it */
  uint64_t has_colors;           /* by vertex or by materials */
  uint64_t reserved[7];
} conic_hybrid_info;

CONIC_API conic_status conic_hybrid_describe(const conic_hybrid *hybrid, conic_hybrid_info *info);

/* What is wrong in a hybrid model, in counts. */
typedef struct conic_hybrid_defects {
  size_t values;  /* numbers that are not finite */
  size_t spheres; /* clusters and nodes that reach beyond their sphere, and points that do not hide all of their node */
  size_t cones;   /* clusters with a face outside their cone, and nodes with such a cluster */
  size_t levels;  /* clusters and nodes whose levels' errors do not grow, clusters without a level of error 0, and
                     points whose error is less than their radius */
  uint64_t reserved[8];
} conic_hybrid_defects;

/* Errors: MEMORY. */
CONIC_API conic_status conic_hybrid_check(const conic_hybrid *hybrid, conic_hybrid_defects *defects);

typedef enum conic_hybrid_kind { CONIC_HYBRID_TRIANGLES = 0, CONIC_HYBRID_SURFELS = 1 } conic_hybrid_kind;

typedef struct conic_hybrid_view {
  size_t size;        /* sizeof(conic_hybrid_view), set by the init function */
  double error_px;    /* above 0: the fewest triangles and surfels whose error on the screen is at most this; 0: as
                         built */
  int only_kind;      /* -1: either; else the conic_hybrid_kind of all clusters: the finest level, or with error_px the
                         fewest that are good enough */
  uint64_t budget;    /* or, where not 0: the least error that so many triangles and surfels in sight can give */
  double color_error; /* above 0: with error_px, how much colours may differ, in hundredths of the way from black to
                         white in OKLab; with a budget, the difference that counts as much as a pixel. 2 is just
                         visible; infinite: colours do not matter */
} conic_hybrid_view;

/* As built, of either kind, colours by 2 steps. */
CONIC_API void conic_hybrid_view_init_sized(conic_hybrid_view *view, size_t size);
#define conic_hybrid_view_init(view) conic_hybrid_view_init_sized(view, sizeof *(view))

/* The contents of one picture. With an error or a budget, a node of the tree that does not reach the near distance may
 * replace all of its clusters, by triangles, by a few surfels or by one splat that faces the camera. Zero before the
 * first use; the memory is kept from call to call. */
typedef struct conic_hybrid_selection {
  conic_splats splats;
  conic_triangles triangles; /* the hybrid owns the textures; the cluster numbers are the hybrid's */
  uint32_t *splat_cluster;   /* the cluster of each splat; nodes are numbered after all clusters */
  size_t n_clusters[2];      /* drawn as triangles, and as surfels, each by itself */
  size_t n_joined;           /* clusters in sight that nodes replace, … */
  size_t n_nodes, n_points;  /* … by so many levels of surfels, and points */
  size_t n_culled;           /* clusters that are out of sight */
  size_t n_simpler;          /* drawn by another level than as built */
  double error_px;    /* no drawn place is farther, in pixels, from its true one; infinite where a cluster that is not
                         drawn by its own triangles reaches the near distance */
  void *scratch;      /* private */
  double color_error; /* no colour differs by more than this from the true one, in steps as in conic_hybrid_view */
  /* For a model that was opened, not read: chunks that this picture took; chunks read since the opening, and the bytes
   * read; bytes that came over the network; bytes of chunks that are kept. */
  uint64_t n_chunks, n_chunks_read, n_bytes_read, n_bytes_received, n_bytes_kept;
  uint64_t reserved[2];
} conic_hybrid_selection;

/* Chooses what to draw. Clusters out of sight are left out, with cull_back also clusters that face away. Neighbours
 * meet without a gap whatever their levels. Errors: ARGUMENT (also a budget below the coarsest of all levels),
 * MEMORY. */
CONIC_API conic_status conic_hybrid_select(const conic_hybrid *hybrid, const conic_camera *camera,
                                           const conic_render_options *render, const conic_hybrid_view *view,
                                           conic_hybrid_selection *selection);

/* Fills the image's cluster plane from its id plane; both must be there. */
CONIC_API void conic_hybrid_name(const conic_hybrid_selection *selection, conic_image *image);

CONIC_API void conic_hybrid_selection_release(conic_context *context, conic_hybrid_selection *selection);

CONIC_END_C
#endif
