/* What the functions of conic/gaussian_judge.h make of their arguments. */
#ifndef CONIC_ORACLE_ENTRY_H
#define CONIC_ORACLE_ENTRY_H

#include "oracle/gaussians/oracle_cells.h"

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

#endif
