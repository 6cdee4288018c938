/* A set's patches, and what a picture takes of them. */
#ifndef CONIC_PATCH_SET_H
#define CONIC_PATCH_SET_H

#include "conic/patches.h"
#include "surface/patches/patch.h"
#include "surface/patches/patches_view.h"

/* What becomes of a slot in a picture; from PLAN_GRID on, which grid of the pyramid. FADING is beside a grid: the splat
 * is drawn too, so that one goes over into the other. */
enum { CONIC_PLAN_CULLED = 0, CONIC_PLAN_SPLAT = 1, CONIC_PLAN_DEEP = 2, CONIC_PLAN_GRID = 3, CONIC_PLAN_FADING = 64 };

/* The grids of the pyramid, each at most 1.5 times as fine as the one before. */
enum { CONIC_N_GRIDS = 10 };
extern const int conic_grid_sizes[CONIC_N_GRIDS];

/* One picture's samples. */
typedef struct conic_patches_frame {
  conic_splats splats; /* with room for more */
  uint32_t *points;    /* of every sample */
  size_t room;
  uint8_t *plans;   /* by slot */
  uint32_t *starts; /* by slot: its first sample, where it is drawn */
} conic_patches_frame;

struct conic_patches {
  conic_context *context;
  conic_patches_options options;
  conic_splats splats;    /* the caller's */
  float *block;           /* what of them was strided */
  conic_surface *surface; /* whose tree is the hierarchy */
  conic_patch *patches;   /* by slot */
  float *node_reach;      /* by node of the tree: the greatest reach of its points, as patches and as splats */
  float *node_radius;     /* and the greatest radius of its patches */
  conic_patches_report report;

  uint32_t *counts;              /* by slot: samples, where its plan is DEEP */
  conic_patches_frame frames[2]; /* this picture's, and the last one's, whose grids are taken over */
  int i_frame;
};

/* Releases what pictures took. */
void conic_patches_release_frames(conic_patches *patches);

/* Decides what becomes of every slot; also how many samples the DEEP ones have. */
void conic_patches_plan(conic_patches *patches, const conic_patches_view *view, uint8_t *plans);

/* Unit vectors, 45° apart. */
extern const double conic_eight_directions[8][2];

/* Whether the polynomial of the workspace's fit, on a circle, on one half as large and in the middle, is within the
 * options' most_off of the splats of the points that it was fitted to. */
int conic_patch_stays_at_points(const conic_patches *patches, const conic_workspace *workspace, int degree, double h,
                                double radius);

/* What a FADING slot's patch weighs; the rest is its splat's. */
double conic_patches_share(const conic_patches *patches, const conic_patches_view *view, size_t slot);

/* How many rows a patch needs, seen from no nearer than a sphere about p. */
double conic_patch_rows(const conic_patches_view *view, const conic_patch *patch, const double p[3], double around);

/* A patch that no grid of the pyramid is fine enough for, as cells of its own, each as fine as it needs. `to` may be
 * null. Returns how many samples there are. */
size_t conic_patch_sample_deep(const conic_patches_view *view, const conic_patch *patch, int degree, double cutoff,
                               const conic_grid_samples *to);

#endif
