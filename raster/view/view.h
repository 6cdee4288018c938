/* What one frame asks for, brought into the form that the stages compute with. */
#pragma once

#include "conic/camera.h"
#include "conic/context.h"
#include "conic/render.h"
#include "conic/splats.h"
#include "core/splats/profile.h"

/* c of the automatic ε = c·F_g·max(|t_u|, |t_v|). */
#define CONIC_EPSILON_C 1.0f

typedef struct conic_view {
  int width, height;
  double rotation[3][3];      /* camera from world */
  double translation[3];      /* of positions that are relative to the splat set's origin */
  float rotation_float[3][3]; /* for directions */
  double fx, fy, cx, cy;
  float focal_px; /* √(fx·fy) */
  double near_z;
  conic_method method;
  conic_kernel kernel;
  float cutoff;    /* F_g */
  float support;   /* a pixel is covered where q < support */
  float prefilter; /* h, px² */
  float growth_px; /* F_g·√h: how far the prefilter moves an outline at most */
  int cull_back;
  float eye[3];          /* in the frame of positions; with cull_back, for a first look at what faces away: */
  float nearest_sure;    /* no look is sure of splats that are nearer to it than this; infinite where none is */
  float thin;            /* px²: a projected variance with a smaller eigenvalue is not drawn by ray */
  float auto_limit;      /* the square of the error at which `auto` takes ray, over that of its bound's factor */
  float epsilon_scale;   /* ε = epsilon_scale · F_g·max(|t_u|, |t_v|) … */
  float epsilon_cap;     /* … at most this; with a fixed ε the scale is infinite */
  int needs_nearness;    /* footprints have theirs, else 0, since nothing blends; */
  int needs_slope;       /* likewise plane_dx and plane_dy of what is no ray */
  unsigned slips;        /* raster/view/slips.h: only plain C makes them */
  conic_profile profile; /* of the kernel under the prefilter; last, since it has a pointer */
} conic_view;

/* Checks camera and options and fills the view. `splat_length` is the lower median of max(|t_u|, |t_v|), `near_z`
 * the near distance in use. Errors: ARGUMENT. */
conic_status conic_view_init(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                             const conic_render_options *options, double near_z, double splat_length, conic_view *view);
