/* Gaussians of what is lent (conic/loan.h). */
#ifndef CONIC_GAUSSIANS_LOAN_H
#define CONIC_GAUSSIANS_LOAN_H

#include "conic/gaussians.h"

/* Copies them; the options leave out what they would of a file. On failure *gaussians is empty. Errors: ARGUMENT,
 * MEMORY. */
conic_status conic_gaussians_copy_lent(conic_context *context, const char *name, const conic_gaussians *lent,
                                       const conic_gaussians_read_options *options, conic_gaussians *gaussians);

#endif
