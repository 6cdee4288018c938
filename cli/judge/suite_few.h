/* The suite's scenes of few Gaussians. On success the caller owns *gaussians. Errors: MEMORY. */
#ifndef CONIC_SUITE_FEW_H
#define CONIC_SUITE_FEW_H

#include "conic/gaussians.h"

conic_status cli_suite_ball(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_ellipse(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_solid(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_harmonics(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_disc(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_overlap(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_faint(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_ring(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_discs(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_extremes(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_least(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_end(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_ties(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_quaternions(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_broken(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_far_away(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_near(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_aside(conic_context *context, conic_gaussians *gaussians);
conic_status cli_suite_edge_on(conic_context *context, conic_gaussians *gaussians);

#endif
