/* The profile of a kernel under the prefilter: docs/reference/picture.md, Profile. */
#ifndef CONIC_ORACLE_PROFILE_H
#define CONIC_ORACLE_PROFILE_H

#include "conic/context.h"
#include "oracle/oracle_splat.h"

/* Gives the view the profile of its kernel, if that has one. Errors: MEMORY. */
conic_status conic_oracle_profile_create(conic_context *context, oracle_view *view);
void conic_oracle_profile_release(conic_context *context, oracle_view *view);

/* The kernel's value at q, or its profile's where it has one: of a splat with the two shares of the filter, the lesser
 * first, in the direction, or with a part of q across. `doubt`, unless null, is by how much that may be another where
 * rounding decides how the profile is taken. */
double conic_oracle_response(const oracle_view *view, const double share[2], double direction, double across, double q,
                             double *doubt);

/* The direction, from N and M of the page, and what is added for what is round. */
double conic_oracle_direction(const oracle_view *view, const double share[2], double n, double m, double round);

#endif
