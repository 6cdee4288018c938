/* Which level of each patch a picture needs. */
#ifndef LOD_HYBRID_CHOOSE_H
#define LOD_HYBRID_CHOOSE_H

#include "lod/hybrid.h"

/* A camera as the patches are looked at by. */
typedef struct conic_hybrid_camera {
  double rotation[3][3], translation[3], eye[3]; /* from the model's origin */
  double side[4][3]; /* planes of the picture's sides: unit normals, inwards, through the eye */
  double focal_px, near_z;
  int cull_back;
  double margin_px2; /* what the prefilter adds to a splat's squared radius */
} conic_hybrid_camera;

void conic_hybrid_camera_init(const conic_hybrid *hybrid, const conic_camera *camera,
                              const conic_render_options *render, conic_hybrid_camera *view);

/* Whether nothing within the sphere is in the picture, or with cull_back all that the cone holds faces away. */
int conic_hybrid_is_hidden(const conic_hybrid_camera *view, const conic_hybrid_bound *bound, double reach);

/* How many pixels places of the patch may be off where the level draws it: infinite where its sphere reaches near. */
double conic_hybrid_error_px(const conic_hybrid_camera *view, const conic_hybrid_patch *patch,
                             const conic_hybrid_level *level);

/* A level for the patch, from its first; `error_px` and `only_kind` as in conic_hybrid_view. */
uint32_t conic_hybrid_choose(const conic_hybrid *hybrid, const conic_hybrid_camera *view,
                             const conic_hybrid_patch *patch, double error_px, int only_kind);

#endif
