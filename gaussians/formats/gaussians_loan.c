#include "gaussians/formats/gaussian_formats.h"

conic_status conic_gaussians_copy_lent(conic_context *context, const char *name, const conic_gaussians *lent,
                                       const conic_gaussians_read_options *options, conic_gaussians *gaussians) {
  conic_status status = conic_gaussians_check(context, lent, name);
  if (status == CONIC_OK && !lent->sh)
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the harmonics that are lent are floats", name);
  const unsigned fields = conic_gaussians_fields(lent) & ~(unsigned)CONIC_GAUSSIANS_HALF;
  if (status == CONIC_OK)
    status = conic_gaussians_begin(context, name, options, lent->count, lent->sh_degree, fields, gaussians);
  if (status != CONIC_OK)
    return status;
  conic_gaussians_put(lent, gaussians, 0);
  memcpy(gaussians->origin, lent->origin, sizeof gaussians->origin);
  memcpy(gaussians->frame, lent->frame, sizeof gaussians->frame);
  memcpy(gaussians->up, lent->up, sizeof gaussians->up);
  gaussians->kind = lent->kind;
  gaussians->is_antialiased = lent->is_antialiased;
  gaussians->is_linear = lent->is_linear;
  return CONIC_OK;
}
