#include "gaussians/formats/gaussian_formats.h"

conic_status conic_gaussians_copy_lent(conic_context *context, const char *name, const conic_gaussians *lent,
                                       const conic_gaussians_read_options *options, conic_gaussians *gaussians) {
  conic_status status = conic_gaussians_check(context, lent, name);
  if (status == CONIC_OK && !lent->sh)
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the harmonics that are lent are floats", name);
  if (status != CONIC_OK)
    return status;
  conic_gaussians whole = *lent, *set = gaussians;
  int degree = lent->sh_degree < options->most_sh_degree ? lent->sh_degree : options->most_sh_degree;
  size_t n_lent = conic_harmonics_of_degree(lent->sh_degree), n_kept = conic_harmonics_of_degree(degree);
  unsigned fields = (lent->scale[2] ? 0 : (unsigned)CONIC_GAUSSIANS_2D);
  fields |= options->half_harmonics ? (unsigned)CONIC_GAUSSIANS_HALF : 0;
  fields |= options->keeps_source && lent->logit_opacity ? (unsigned)CONIC_GAUSSIANS_SOURCE : 0;
  status = conic_gaussians_allocate(context, lent->count, degree, fields, set);
  if (status != CONIC_OK)
    return status;
  if (!set->logit_opacity)
    whole.logit_opacity = whole.log_scale[0] = whole.log_scale[1] = whole.log_scale[2] = NULL;
  float **from[CONIC_MOST_GAUSSIAN_COLUMNS], **to[CONIC_MOST_GAUSSIAN_COLUMNS];
  int n_columns = conic_gaussians_list_columns(&whole, from);
  conic_gaussians_list_columns(set, to);
  for (int i = 0; i < n_columns; i++)
    memcpy(*to[i], *from[i], lent->count * sizeof(float));
  for (size_t i = 0; i < lent->count; i++)
    for (size_t k = 0; k < n_kept; k++)
      if (set->sh)
        set->sh[i * n_kept + k] = lent->sh[i * n_lent + k];
      else
        set->sh_half[i * n_kept + k] = conic_half_of_float(lent->sh[i * n_lent + k]);
  memcpy(set->origin, lent->origin, sizeof set->origin);
  memcpy(set->frame, lent->frame, sizeof set->frame);
  memcpy(set->up, lent->up, sizeof set->up);
  set->kind = lent->kind;
  set->is_antialiased = lent->is_antialiased;
  set->is_linear = lent->is_linear;
  return CONIC_OK;
}
