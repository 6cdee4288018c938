/* A set's patches, and what a picture takes of them. */
#ifndef SURFACE_PATCHES_H
#define SURFACE_PATCHES_H

#include "conic/patches.h"
#include "surface/patch.h"

struct conic_patches {
  conic_context *context;
  conic_patches_options options;
  const conic_splats *splats; /* the caller's */
  conic_surface *surface;     /* whose tree is the hierarchy */
  conic_patch *patches;       /* by slot */
  float *node_reach;          /* by node of the tree: the greatest reach of its points, as patches and as splats */
  float *node_radius;         /* and the greatest radius of its patches */
  conic_patches_report report;

  /* Of the picture at hand. */
  uint8_t *plans;   /* by slot: what becomes of it */
  uint32_t *counts; /* by slot: samples, where it is a patch */
};

#endif
