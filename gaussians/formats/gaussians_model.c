/* Gaussian scenes as models of splats, for what draws, measures or keeps surfaces. */

#include "core/base/gaussian.h"
#include "gaussians/formats/gaussian_formats.h"

/* The formulas, and their order, are those of a .ply's columns, so that a converted scene gives the same bits. */
static void store_splat(const conic_gaussians *set, size_t i, conic_splats *splats) {
  double scales[3] = {0.0, 0.0, 0.0}, rotation[4], tangent_u[3], tangent_v[3];
  float room[CONIC_MOST_HARMONICS];
  const float *sh = conic_gaussians_harmonics(set, i, room);
  const int n_scales = set->scale[2] ? 3 : 2;
  for (int axis = 0; axis < n_scales; axis++)
    scales[axis] = (double)conic_gaussians_log_scale(set, axis, i);
  for (int k = 0; k < 4; k++)
    rotation[k] = (double)set->rotation[k][i];
  conic_gaussian_axes(scales, n_scales, rotation, tangent_u, tangent_v);
  for (int axis = 0; axis < 3; axis++) {
    double linear = 0.5 + CONIC_SH_CONSTANT * (double)sh[axis];
    splats->position[axis][i] = set->position[axis][i];
    splats->tangent_u[axis][i] = (float)tangent_u[axis];
    splats->tangent_v[axis][i] = (float)tangent_v[axis];
    splats->color[axis][i] = (float)(!set->is_linear ? conic_gaussian_color((double)sh[axis])
                                     : linear < 0.0  ? 0.0
                                                     : linear);
  }
  splats->opacity[i] = (float)conic_gaussian_opacity((double)conic_gaussians_logit(set, i));
}

conic_status conic_gaussians_to_splats(conic_context *context, const conic_gaussians *gaussians, conic_splats *splats) {
  memset(splats, 0, sizeof *splats);
  conic_status status = conic_gaussians_check(context, gaussians, "gaussians");
  if (status == CONIC_OK)
    status = conic_splats_allocate(context, gaussians->count,
                                   CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES, splats);
  if (status != CONIC_OK)
    return status;
  memcpy(splats->origin, gaussians->origin, sizeof splats->origin);
  for (size_t i = 0; i < gaussians->count; i++)
    store_splat(gaussians, i, splats);
  return CONIC_OK;
}

static conic_status read_scene_as_splats(conic_context *context, const char *path, conic_model *model) {
  conic_gaussians_read_options reading;
  conic_gaussians scene;
  conic_gaussians_read_options_init(&reading);
  reading.keeps_source = 1;
  reading.most_sh_degree = 0;
  conic_status status = conic_gaussians_read(context, path, &reading, &scene);
  if (status == CONIC_OK)
    status = conic_gaussians_to_splats(context, &scene, &model->points);
  if (status == CONIC_OK)
    conic_gaussians_find_up(&scene, model->up);
  conic_gaussians_release(context, &scene);
  return status;
}

conic_status conic_gaussians_read_model(conic_context *context, const char *path, const conic_read_options *options,
                                        conic_model *model) {
  if (!conic_gaussians_is_packed(context, path))
    return conic_model_read(context, path, options, model);
  memset(model, 0, sizeof *model);
  if (options && options->field && !options->field_is_optional)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the Gaussians have no '%s'", path, options->field);
  if (options && (options->where || options->keep))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the Gaussians have no values by name", path);
  return read_scene_as_splats(context, path, model);
}
