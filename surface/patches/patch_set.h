/* A set's patches, and the samples that a picture takes from them. */
#pragma once

#include "conic/patches.h"
#include "core/image/viewpoint.h"
#include "surface/patches/patch_mesh.h"

/* A camera for choosing patches: which spheres are in sight, and lengths on the screen. */

typedef struct conic_patches_view {
  conic_viewpoint from;    /* for places from the set's origin; its sides are as far out as the prefilter reaches */
  double near_z, focal_px; /* the longer focal length */
  double step_px;
  int cull_back;
} conic_patches_view;

/* `default_near` is used where the options have none. */
static inline void conic_patches_view_init(conic_patches_view *view, const conic_camera *camera,
                                           const conic_render_options *render, const double origin[3],
                                           double default_near, double step_px) {
  double growth_px = (double)render->kernel.cutoff * sqrt((double)render->prefilter) + 2.0; /* the filter widens
                                                                                               outlines by that */
  conic_viewpoint_init(&view->from, camera, origin, growth_px);
  view->near_z = render->near_z > 0.0 ? render->near_z : 0.999 * default_near;
  view->focal_px = camera->fx > camera->fy ? camera->fx : camera->fy;
  view->step_px = step_px;
  view->cull_back = render->cull_back;
}

/* Whether a sphere about p, in camera space, may be seen. */
static inline int conic_patches_sees(const conic_patches_view *view, const double p[3], double radius) {
  return p[2] + radius > view->near_z && !conic_viewpoint_misses(&view->from, p, radius);
}

/* The most pixels that a length takes in a sphere about p. */
static inline double conic_patches_pixels(const conic_patches_view *view, const double p[3], double radius,
                                          double length) {
  double nearest = p[2] - radius;
  return length * view->focal_px / (nearest > view->near_z ? nearest : view->near_z);
}

/* The plan of a slot in a picture; from PLAN_GRID on, the grid of the pyramid. FADING is added to a grid: the splat is
 * drawn, too, so that one fades into the other. */
enum { CONIC_PLAN_CULLED = 0, CONIC_PLAN_SPLAT = 1, CONIC_PLAN_DEEP = 2, CONIC_PLAN_GRID = 3, CONIC_PLAN_FADING = 64 };

/* The grids of the pyramid, each at most 1.5 times as fine as the one before. */
enum { CONIC_N_GRIDS = 10 };
extern const int conic_grid_sizes[CONIC_N_GRIDS];

/* A picture's samples. */
typedef struct conic_patches_frame {
  conic_splats splats; /* with room for more */
  uint32_t *points;    /* the point of every sample */
  size_t room;
  uint8_t *plans;   /* by slot */
  uint32_t *starts; /* by slot: its first sample, if it is drawn */
} conic_patches_frame;

#define CONIC_NO_SIDE UINT32_MAX

struct conic_patches {
  conic_context *context;
  conic_patches_options options;
  conic_splats splats;       /* the caller's */
  float *block;              /* side-by-side copies of the strided arrays */
  conic_surface *surface;    /* its tree is the hierarchy */
  conic_patch *patches;      /* by slot; of a mesh's vertex, the bounds of its sides' patches */
  conic_patch *sides;        /* the patches of a mesh's vertices, of each side one, … */
  conic_patch_fence *fences; /* … and its fence */
  uint32_t *side_of_point;   /* null: there is no mesh; 0: the point shows its slot's patch; else 1 + its side's number,
                                or CONIC_NO_SIDE: nothing, as all sides are the first points' there */
  float *node_reach;         /* by node of the tree: the greatest reach of its points, as patches and as splats */
  float *node_radius;        /* by node: the greatest radius of its patches */
  conic_patches_report report;

  uint32_t *counts;              /* by slot: samples, where its plan is DEEP */
  conic_patches_frame frames[2]; /* of this picture, and of the last one, whose grids are taken over */
  int i_frame;
};

/* The patch that a point shows where its slot's plan says so; null: none. */
static inline const conic_patch *conic_patches_shown(const conic_patches *patches, size_t point, uint32_t slot) {
  uint32_t side = patches->side_of_point ? patches->side_of_point[point] : 0;
  return side == 0 ? &patches->patches[slot] : side == CONIC_NO_SIDE ? NULL : &patches->sides[side - 1];
}

/* Releases the memory of pictures. */
void conic_patches_release_frames(conic_patches *patches);

/* Decides the plan of every slot, and the number of samples of DEEP ones. */
void conic_patches_plan(conic_patches *patches, const conic_patches_view *view, uint8_t *plans);

/* The weight of a FADING slot's patch; its splat has the rest. */
double conic_patches_share(const conic_patches *patches, const conic_patches_view *view, size_t slot);

/* Samples a patch that needs finer grids than the pyramid's, as cells of its own, each as fine as needed. `to` may be
 * null. Returns how many samples there are. */
size_t conic_patch_sample_deep(const conic_patches_view *view, const conic_patch *patch, int degree, double cutoff,
                               const conic_grid_samples *to);
