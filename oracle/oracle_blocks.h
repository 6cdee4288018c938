/* The oracle's work: blocks of pixels, each with the splats and triangles that may show in it. */
#pragma once

#include "oracle/oracle_bounds.h"

typedef struct oracle_job {
  conic_context *context;
  const conic_render_options *options;
  const oracle_scene *scene; /* seen by a camera of samples × samples as many pixels */
  const oracle_mesh *mesh;
  int samples;
  conic_reference *reference; /* allocated; `pixels` say which */
} oracle_job;

/* Fills the reference. Errors: MEMORY, CANCELLED. */
conic_status conic_oracle_work(const oracle_job *job);
