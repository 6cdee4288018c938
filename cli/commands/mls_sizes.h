/* Ellipses for what conic mls writes. */
#ifndef CONIC_MLS_SIZES_H
#define CONIC_MLS_SIZES_H

#include "conic/model.h"

/* Gives `dense`, of which the first points are those of `from`, its ellipses. Those of `from` keep the ones that its
 * own picture has, dots or not, where they cover what the new points do not. No other becomes a dot, as points that
 * lie close together on something thin would. Errors: MEMORY, CANCELLED. */
conic_status cli_mls_size_dense(conic_context *context, const conic_model *from, conic_splats *dense);

/* Gives `thinned`, points of `from` in its order, ellipses: each covers the outlines of the points of `from` that it is
 * the nearest to, on its side of what is thin, and a dot has the area of all dots that it stands for. Errors: MEMORY,
 * CANCELLED. */
conic_status cli_mls_size_thinned(conic_context *context, const conic_model *from, conic_splats *thinned);

/* Gives points their ellipses, with clip lines at creases over 30°. Errors: MEMORY, CANCELLED. */
conic_status cli_mls_size_sharp(conic_context *context, conic_splats *points);

#endif
