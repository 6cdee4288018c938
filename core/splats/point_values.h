/* What points have by name besides what a splat has, such as all attributes of a scan: a number a point each, in the
 * order of the points. A reader fills columns; from them come the points' scalars, which points are left out, and what
 * is kept. */
#pragma once

#include "conic/model.h"
#include "core/splats/point_filter.h"

enum { CONIC_MOST_POINT_VALUES = 128 };

struct conic_point_values {
  size_t n, count; /* values that are kept, and points */
  conic_model_field field[CONIC_MOST_POINT_VALUES];
  double *value[CONIC_MOST_POINT_VALUES]; /* `count` of each, of those kept first; NaN where a point has none */

  /* While a file is read */
  size_t n_columns, room;
  int source[CONIC_MOST_POINT_VALUES]; /* of each column: the file's field; −1, −2, −3: the place's x, y, z */
  int scalar;                          /* the column that the points' scalars are; −1: none */
  int is_scalar_origin_set;            /* the first of them has been seen, or they are floats */
  conic_filter *filter;                /* null: all points are wanted */
  int filtered_by[CONIC_FILTER_MOST_NAMES]; /* columns */
};
typedef struct conic_point_values conic_point_values;

/* Room for `room` points, of which `count` are kept. Errors: MEMORY. */
conic_status conic_point_values_reserve(conic_context *context, conic_point_values *values, size_t room);
void conic_point_values_destroy(conic_context *context, conic_point_values *values);

/* Makes these the only values of the set that have a name, as many as there are splats. Errors: MEMORY. */
conic_status conic_splats_keep_value(conic_context *context, conic_splats *splats, const char *name,
                                     const float *values);

/* From the columns of all points of the set: scalars; and what the filter does not pass is left out of the set, clip
 * lines with it. */
void conic_point_values_settle(conic_splats *points);
