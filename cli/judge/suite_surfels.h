/* The suite's scenes of surface splats. On success the caller owns *splats. Errors: MEMORY. */
#ifndef CONIC_SUITE_SURFELS_H
#define CONIC_SUITE_SURFELS_H

#include "conic/splats.h"

conic_status cli_suite_splat(conic_context *context, conic_splats *splats);
conic_status cli_suite_sheet(conic_context *context, conic_splats *splats);
conic_status cli_suite_corner(conic_context *context, conic_splats *splats);
conic_status cli_suite_steep(conic_context *context, conic_splats *splats);

#endif
