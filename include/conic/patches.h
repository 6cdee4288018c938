/* Point-set surfaces, drawn: a polynomial a point, and the samples of it that a picture needs.
 *
 * Every point of a set gets the polynomial that moving least squares fits about it, over a disc of its plane. For a
 * picture, the polynomials in sight are sampled on grids as fine as the screen needs. The samples are splats like any
 * others; their weights blend neighbouring polynomials into one smooth surface (docs/reference/surfaces.md). A
 * selection depends on the set, the options and the camera alone: not on threads, instruction sets or the frames
 * before. */
#ifndef CONIC_PATCHES_H
#define CONIC_PATCHES_H

#include "conic/surface.h"

CONIC_BEGIN_C

typedef struct conic_patches_options {
  size_t size;                   /* sizeof(conic_patches_options), set by the init function */
  conic_surface_options surface; /* of type MLS */
  float cutoff;                  /* F_g of the kernel that will draw; 0.25 to 5 */
  double step_px; /* samples of a patch facing the camera are no farther apart on the screen; 0.25 to 16 */
  const struct conic_triangles *mesh; /* where not null, patches go through its vertices, which splats were made of, and
                                         have its normals there; none crosses a crease or a border. Needed until the
                                         patches are laid */
} conic_patches_options;

/* The surface's defaults, cutoff 1.5, steps of 2 px, patches that reach as far as they are sound. */
CONIC_API void conic_patches_options_init_sized(conic_patches_options *options, size_t size);
#define conic_patches_options_init(options) conic_patches_options_init_sized(options, sizeof *(options))

typedef struct conic_patches conic_patches;

/* What became of a set's points. */
typedef struct conic_patches_report {
  size_t n_points;
  size_t outcomes[CONIC_MAX_SURFACE_OUTCOMES]; /* of the points' projections */
  size_t n_patches;                            /* points with a patch: DONE, with a polynomial that is sound all over
                                                  its disc */
  size_t n_bytes;                              /* of the patches and their hierarchy */
  double mesh_off; /* of a mesh: how far patches are off the vertices next to their own, as the root of the mean square;
                      below 0: most of the points are none of a mesh */
  uint64_t reserved[7];
} conic_patches_report;

/* Lays a patch about every point of `splats` (with tangent axes) that can have one. The set must outlive the patches,
 * which draw its splats where there is no patch or none is needed. Splats with clip lines stay splats. `options` may be
 * null for the defaults. On success the caller owns *patches. Errors: ARGUMENT, INPUT (no finite point), UNSUPPORTED
 * (the instruction set), MEMORY, CANCELLED. */
CONIC_API conic_status conic_patches_create(conic_context *context, const conic_splats *splats,
                                            const conic_patches_options *options, conic_patches **patches);
CONIC_API void conic_patches_destroy(conic_patches *patches);

CONIC_API void conic_patches_describe(const conic_patches *patches, conic_patches_report *report);

/* A picture's splats, in the order of the points. The patches own its memory; the contents stay until the next picture
 * is selected. */
typedef struct conic_patch_selection {
  conic_splats splats;
  const uint32_t *points; /* of every splat: the point that it shows */
  size_t n_patches;       /* patches that were sampled */
  size_t n_samples;       /* splats that they were sampled into */
  size_t n_splats;        /* points that are drawn as their own splats */
  size_t n_culled;        /* points out of sight */
  size_t n_kept;          /* samples taken over from the last picture */
  uint64_t reserved[8];
} conic_patch_selection;

/* Chooses and samples what a camera sees. The near distance, prefilter and culling of `render` count. A point whose
 * patch would take few pixels is its own splat. Grids that the last picture had are not made again. Errors: ARGUMENT,
 * MEMORY. */
CONIC_API conic_status conic_patches_select(conic_patches *patches, const conic_camera *camera,
                                            const conic_render_options *render, conic_patch_selection *selection);

/* Replaces the numbers in an image's id plane, which are indices in the selection, by the points' numbers. */
CONIC_API void conic_patch_selection_name(const conic_patch_selection *selection, conic_image *image);

CONIC_END_C
#endif
