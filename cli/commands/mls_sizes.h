/* Ellipses for the points that conic mls writes. */
#pragma once

#include "conic/model.h"

/* Gives the points of `dense` ellipses. Its first points are those of `from`. An old point keeps the ellipse, or dot,
 * of its own picture if that covers a place that the new points do not. No other point becomes a dot, though points
 * close together on a thin part would. Errors: MEMORY, CANCELLED. */
conic_status cli_mls_size_dense(conic_context *context, const conic_model *from, conic_splats *dense);

/* Gives the points of `thinned`, which are some of `from` in its order, ellipses. Each ellipse covers the outlines of
 * the points of `from` to which its point is the nearest, on the same side of a thin part. A dot has the area of all
 * dots that it replaces. Errors: MEMORY, CANCELLED. */
conic_status cli_mls_size_thinned(conic_context *context, const conic_model *from, conic_splats *thinned);

/* Gives points their ellipses, with clip lines at creases over 30°. Errors: MEMORY, CANCELLED. */
conic_status cli_mls_size_sharp(conic_context *context, conic_splats *points);
