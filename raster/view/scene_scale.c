#include "raster/view/scene_scale.h"

conic_status conic_scene_scale(conic_context *context, const conic_splats *splats, conic_render_options *options) {
  if (!(options->near_z > 0.0))
    options->near_z = conic_default_near(splats);
  if (!(options->splat_length > 0.0) && options->epsilon < 0.0)
    return conic_splats_length(context, splats, &options->splat_length);
  return CONIC_OK;
}
