/* The point-octree: a hierarchy over a set of splats, so that no more of them are drawn than a picture needs
 * (docs/reference/octree.md). */
#ifndef CONIC_OCTREE_H
#define CONIC_OCTREE_H

#include "conic/render.h"

CONIC_BEGIN_C

typedef struct conic_octree conic_octree;

typedef struct conic_octree_options {
  size_t size;  /* sizeof(conic_octree_options), set by the init function */
  float cutoff; /* F_g of the kernel that will draw: all bounds are for outlines at this cutoff */
  int quantize; /* rounds the splats, too, for a file of about half the size (docs/reference/format-cot.md) */
} conic_octree_options;

/* Cutoff 1.5, not quantised. */
CONIC_API void conic_octree_options_init_sized(conic_octree_options *options, size_t size);
#define conic_octree_options_init(options) conic_octree_options_init_sized(options, sizeof *(options))

/* Builds the hierarchy of splats with tangent axes. It takes the arrays over: *splats is empty afterwards, on failure
 * too. Splats that cannot be drawn are kept beside the hierarchy. The result depends on the splats and the options
 * only, never on the threads. On success the caller owns *octree, which must not outlive the context. Errors: ARGUMENT,
 * INPUT (nothing to draw, or farther out than 1e15), MEMORY, CANCELLED, UNSUPPORTED (the context's instruction set). */
CONIC_API conic_status conic_octree_build(conic_context *context, conic_splats *splats,
                                          const conic_octree_options *options, conic_octree **octree);

/* Null is allowed. */
CONIC_API void conic_octree_destroy(conic_octree *octree);

/* Writes a .cot file (docs/reference/format-cot.md), which appears under its name only when it is whole. Errors:
 * MEMORY, IO. */
CONIC_API conic_status conic_octree_write(conic_octree *octree, const char *path);

/* Maps the file into memory and checks all of it: sums, sizes, structure. On success the caller owns *octree, which
 * must not outlive the context. The file must not be changed while it is in use. Errors: INPUT, MEMORY. */
CONIC_API conic_status conic_octree_read(conic_context *context, const char *path, conic_octree **octree);

/* Whether a file that can be read begins like a .cot. */
CONIC_API int conic_octree_is_file(const char *path);

typedef struct conic_octree_info {
  size_t n_points; /* splats it was built from */
  size_t n_leaves; /* of n_points, in the hierarchy; the others cannot be drawn */
  size_t n_nodes;  /* inner nodes */
  int n_levels;    /* of inner nodes */
  int is_quantized;
  float cutoff;
  double minimum[3], maximum[3]; /* of the finite centres it was built from, as conic_splats_bounds */
  double splat_length;           /* as conic_splats_length of these */
  double near_z;                 /* as conic_default_near of these */
  double position_error;         /* no centre was moved farther, in world units; 0 unless quantised */
  double radius[3];              /* of the inner nodes: least, median, greatest */
  double cone[3];                /* cosines of half the opening of their normal cones: least, median, greatest */
  uint64_t n_bytes;              /* of the file that holds it */
  uint64_t reserved[8];
} conic_octree_info;

CONIC_API conic_status conic_octree_describe(const conic_octree *octree, conic_octree_info *info);

/* What is wrong in an octree: how many inner nodes break their bounds. */
typedef struct conic_octree_defects {
  size_t ellipses; /* a leaf's disc, seen along the normal, reaches out of the node's */
  size_t spheres;  /* a leaf's disc, or the node's own, reaches out of the sphere */
  size_t cones;    /* a leaf's normal is outside the cone */
  size_t errors;   /* a leaf's disc is farther from the node's than the error says, or the error exceeds the diameter */
  size_t splats;   /* leaves in the hierarchy that cannot be drawn */
  uint64_t reserved[8];
} conic_octree_defects;

/* Looks at every leaf of every node. Errors: MEMORY, CANCELLED. */
CONIC_API conic_status conic_octree_check(conic_octree *octree, conic_octree_defects *defects);

/* The splats it was built from, in their order: what an error of 0 draws. Bit for bit, unless quantised. The caller
 * releases *splats. Errors: MEMORY. */
CONIC_API conic_status conic_octree_leaves(const conic_octree *octree, conic_splats *splats);

/* A picture of how the octree divides its points. It shows `image` in colours of the nodes of a level, with a box of
 * lines around the centres of each such node's leaves, fainter behind what is drawn. The root's level is 0; below 0
 * stands for the deepest level with no more than 64 nodes. `image` was drawn from this octree with this camera, and has
 * rgba, Z and id. On success the caller owns *map. Errors: ARGUMENT, MEMORY, CANCELLED. */
CONIC_API conic_status conic_octree_draw_boxes(const conic_octree *octree, const conic_camera *camera, int level,
                                               const conic_image *image, conic_image *map);

typedef struct conic_selection_options {
  size_t size;     /* sizeof(conic_selection_options), set by the init function */
  double error_px; /* above 0: the greatest error on the screen */
  uint64_t budget; /* or, where not 0: the least error that this many splats can give */
} conic_selection_options;

/* An error of 1 pixel. */
CONIC_API void conic_selection_options_init_sized(conic_selection_options *options, size_t size);
#define conic_selection_options_init(options) conic_selection_options_init_sized(options, sizeof *(options))

/* A picture's splats, in the order of the hierarchy. Zero before the first use; the memory is kept from call to call.
 */
typedef struct conic_selection {
  conic_splats splats;
  uint32_t *ids;   /* index in the input; for an inner node n_points + its number */
  size_t n_inner;  /* how many are inner nodes */
  size_t n_culled; /* subtrees that are out of sight */
  double error_px; /* asked for, or what the budget led to: infinite if it had room for a single node of any size */
  size_t room;     /* of the arrays */
  void *scratch;   /* private */
  uint64_t reserved[8];
} conic_selection;

/* Chooses what to draw. For every leaf in sight it is the leaf itself or a node above it: the first, from the root,
 * whose error is at most so many pixels wherever in its sphere it is projected. Nodes seen from their side may err
 * more. The kernel's cutoff must be the octree's. Errors: ARGUMENT, MEMORY, UNSUPPORTED (the options' instruction set
 * is not here). */
CONIC_API conic_status conic_octree_select(conic_octree *octree, const conic_camera *camera,
                                           const conic_render_options *render, const conic_selection_options *options,
                                           conic_selection *selection);

/* Replaces the numbers in an image's id plane, which are indices in the selection, by its ids. */
CONIC_API void conic_selection_name(const conic_selection *selection, conic_image *image);

/* Releases the memory that selecting has kept, and leaves an empty selection. */
CONIC_API void conic_selection_release(conic_context *context, conic_selection *selection);

CONIC_END_C
#endif
