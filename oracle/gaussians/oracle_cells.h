/* Bounds of many pixels: Gaussians are binned by what they may reach, and each cell of pixels looks at its own. */
#pragma once

#include "oracle/gaussians/oracle_uncertain.h"

/* Takes what a pixel may be: the i-th of those asked for. No two calls at a time have the same thread. */
typedef void oracle_bound_taker(void *data, size_t i, size_t pixel, const conic_gaussian_bound *bound, int i_thread);

/* Takes what may cover it, in its order, with what is noted of each. */
typedef void oracle_meeting_taker(void *data, size_t pixel, const oracle_meeting *meetings, size_t n, int i_thread);

typedef struct oracle_bound_request {
  conic_context *context;
  oracle_doubting doubting;                /* whose camera is that of the samples */
  const float *background;                 /* 3 */
  const conic_gaussian_surfaces *surfaces; /* null: there are none */
  int samples;                             /* N × N a pixel */
  int width, height;                       /* in pixels */
  const uint32_t *pixels;                  /* null: all */
  size_t n_pixels;
  oracle_bound_taker *take; /* null, as the next may be: nobody asks */
  oracle_meeting_taker *note;
  void *data;
  const char *task; /* as which progress is reported; null: "verify" */
} oracle_bound_request;

/* Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_bound_all(const oracle_bound_request *bounding);

/* Those Gaussians that may reach a place of the screen, in their order there. On success the caller releases
 * *gaussians, which *meetings refer to, and *meetings. Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_meet_all(const oracle_bound_request *bounding, double x, double y,
                                   oracle_uncertain **gaussians, oracle_meeting **meetings, size_t *n);

/* What the functions of conic/gaussian_judge.h make of their arguments. */

/* Its parts refer to each other: it stays where it is. */
typedef struct oracle_entry {
  conic_gaussian_options options;
  conic_float_model model;
  conic_camera fine; /* the camera of the samples */
  oracle_gaussian_view view;
  oracle_bound_request bounding;
} oracle_entry;

/* Checks the arguments, and fills in all but the pixels and who takes their bounds. Errors: ARGUMENT. */
conic_status conic_oracle_enter(conic_context *context, const conic_gaussians *gaussians, const conic_camera *camera,
                                const conic_gaussian_options *options, const conic_float_model *model, int samples,
                                oracle_entry *e);
