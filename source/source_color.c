/* Colours of a source, made from what its points hold. */

#include "source/source_kind.h"
#include "source/upright.h"

int conic_coloring_is_asked(const conic_source_options *options) {
  const char *by = options->coloring ? options->coloring->by : "rgb";
  return by && strcmp(by, "rgb") != 0 && strcmp(by, "auto") != 0;
}

conic_status conic_coloring_refuse(conic_context *context, const char *path, const conic_source_options *options) {
  return conic_fail(context, CONIC_ERROR_INPUT,
                    "%s: it keeps colours, not '%s': colour what it is made of (--color-by of conic prepare, octree, "
                    "layer and hybrid)",
                    path, options->coloring->by);
}

/* Finds which way is up, which heights and the front of normals need. */
static conic_status find_upright(conic_source *source, conic_splats *splats, conic_triangles *triangles) {
  static conic_splats no_splats;
  static conic_triangles no_triangles;
  conic_source_scale *scale = &source->scale;
  const conic_drawing drawing = {splats ? splats : &no_splats, triangles ? triangles : &no_triangles};
  if (scale->up_basis != CONIC_UP_HABIT)
    return CONIC_OK;
  conic_status status =
      conic_upright_look(source->context, &source->shares, &drawing, &scale->up_basis, source->fronts);
  if (status == CONIC_OK && scale->up_basis != CONIC_UP_HABIT)
    memcpy(scale->up, (const double[3]){0.0, 0.0, 1.0}, sizeof scale->up);
  return status;
}

conic_status conic_source_color(conic_source *source, const conic_source_options *options, conic_splats *splats,
                                conic_triangles *triangles) {
  conic_coloring_options own;
  conic_status status = CONIC_OK;
  conic_coloring_options_init(&own);
  if (!options->coloring)
    return CONIC_OK;
  if (!conic_options_take(&own, options->coloring) || !own.by)
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "source: the colouring's options were not initialised");
  if (own.up[0] == 0.0 && own.up[1] == 0.0 && own.up[2] == 0.0) {
    if (strcmp(own.by, "height") == 0 || strcmp(own.by, "normal") == 0)
      status = find_upright(source, splats, triangles);
    memcpy(own.up, source->scale.up, sizeof own.up);
  }
  return status == CONIC_OK ? conic_drawing_color(source->context, &own, splats, triangles, &source->coloring) : status;
}

const conic_coloring *conic_source_coloring(const conic_source *source) {
  return source->coloring.field[0] ? &source->coloring : NULL;
}
