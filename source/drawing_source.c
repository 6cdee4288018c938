/* Splats and triangles in memory: of any number of files, or of a caller's arrays. */
#include <string.h>

#include "core/base/clock.h"
#include "core/base/message.h"
#include "core/splats/columns.h"
#include "core/splats/estimate.h"
#include "core/splats/repairs_log.h"
#include "source/mesh_input.h"
#include "source/source_kind.h"

typedef struct drawing_source {
  conic_source base;
  conic_splats splats;
  conic_triangles triangles;
} drawing_source;

static int takes_drawing(const char *path, const conic_source_options *options) {
  (void)path;
  (void)options;
  return 1;
}

static conic_status append_to_drawing(drawing_source *d, conic_splats *more) {
  conic_status status = CONIC_OK;
  if (d->splats.count == 0) { /* the first input's arrays are taken over, not copied */
    conic_splats_release(d->base.context, &d->splats);
    d->splats = *more;
    memset(more, 0, sizeof *more);
  } else
    status = conic_splats_append(d->base.context, &d->splats, more);
  conic_splats_release(d->base.context, more);
  return status;
}

/* A model's faces become triangles. */
static conic_status take_triangles(drawing_source *d, const char *path, conic_model *model) {
  conic_context *context = d->base.context;
  conic_triangles triangles;
  conic_status status = conic_triangles_take(context, model, &triangles);
  if (status == CONIC_OK)
    status = conic_mesh_check(context, path, &triangles);
  if (status == CONIC_OK)
    status = conic_triangles_append(context, &d->triangles, &triangles);
  conic_triangles_release(context, &triangles);
  return status;
}

/* Gives the points axes where they have none. */
static conic_status take_points(drawing_source *d, const char *path, const conic_source_options *options,
                                conic_model *model) {
  conic_context *context = d->base.context;
  conic_estimate_options estimate;
  conic_repairs repairs;
  conic_estimate_options_init(&estimate);
  estimate.cutoff = options->cutoff;
  estimate.n_neighbours = options->n_neighbours;
  estimate.stays_at_mesh = 1;
  if (model->n_triangles && !model->points.tangent_u[0])
    d->base.tolerance = conic_mesh_tolerance(&model->points);
  conic_status status = conic_model_to_splats(context, &estimate, model, &repairs);
  if (status != CONIC_OK)
    return status;
  conic_repairs_log(context, path, &repairs);
  return append_to_drawing(d, &model->points);
}

/* *kind is what the model turned out to be. */
static conic_status read_model(drawing_source *d, const char *path, const conic_source_options *options,
                               conic_model_kind *kind) {
  conic_context *context = d->base.context;
  conic_read_options reading;
  conic_model model;
  double low[3], high[3];
  conic_read_options_init(&reading);
  reading.cutoff = options->cutoff;
  reading.keeps_faces = options->as == CONIC_AS_MESH;
  conic_status status = conic_model_read(context, path, &reading, &model);
  if (status != CONIC_OK)
    return status;
  double start = conic_seconds_now();
  *kind = model.kind;
  if (conic_splats_bounds(&model.points, low, high) == 0)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot be drawn: %s", path,
                        model.points.count ? "no point is finite" : "it holds no points");
  else if (reading.keeps_faces && model.n_triangles)
    status = take_triangles(d, path, &model);
  else
    status = take_points(d, path, options, &model);
  conic_model_release(context, &model);
  d->base.scale.estimate_seconds += conic_seconds_now() - start;
  return status;
}

static conic_status read_into_drawing(drawing_source *d, const char *path, const conic_source_options *options,
                                      conic_model_kind *kind) {
  const conic_source_kind *special = conic_source_kind_of_file(path);
  conic_source *part;
  conic_splats splats;
  if (!special || !special->take_splats)
    return read_model(d, path, options, kind);
  conic_status status = conic_source_open_kind(d->base.context, special, &path, 1, options, &part);
  if (status != CONIC_OK)
    return status;
  status = special->take_splats(part, &splats);
  conic_source_close(part);
  return status == CONIC_OK ? append_to_drawing(d, &splats) : status;
}

/* What the options say of triangles. */
static conic_status dress(drawing_source *d, const conic_source_options *options) {
  conic_context *context = d->base.context;
  conic_status status = CONIC_OK;
  if (options->as == CONIC_AS_MESH && d->triangles.count == 0)
    conic_log(context, CONIC_LOG_WARNING, "%s: there are no faces to draw as a mesh; the points are drawn",
              d->base.name);
  if (d->triangles.count == 0)
    return CONIC_OK;
  if (options->is_smooth)
    status = conic_triangles_smooth(context, &d->triangles);
  return status == CONIC_OK && options->texture_path
             ? conic_mesh_lay_texture(context, options->texture_path, &d->triangles)
             : status;
}

static conic_status measure_drawing(drawing_source *d) {
  conic_source_scale *scale = &d->base.scale;
  double start = conic_seconds_now();
  conic_source_choice *choice = &d->base.choice;
  choice->drawing = (conic_drawing){&d->splats, &d->triangles};
  choice->is_all = 1;
  conic_drawing_bounds(&choice->drawing, scale->minimum, scale->maximum);
  scale->near_z = conic_drawing_near(&choice->drawing);
  scale->n_splats = d->splats.count;
  scale->n_triangles = d->triangles.count;
  scale->has_colors = d->splats.color[0] || d->triangles.color[0] || d->triangles.n_materials;
  conic_status status =
      d->splats.count ? conic_splats_length(d->base.context, &d->splats, &scale->splat_length) : CONIC_OK;
  scale->estimate_seconds += conic_seconds_now() - start;
  return status;
}

static conic_status open_drawing(conic_source *source, const char *const *paths, size_t n_paths,
                                 const conic_source_options *options) {
  drawing_source *d = (drawing_source *)source;
  conic_source_scale *scale = &source->scale;
  size_t n_surveys = 0;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n_paths && status == CONIC_OK; i++) {
    conic_model_kind kind = CONIC_MODEL_PLY;
    status = read_into_drawing(d, paths[i], options, &kind);
    n_surveys += kind == CONIC_MODEL_LAS;
  }
  if (status == CONIC_OK)
    status = dress(d, options);
  if (n_surveys == n_paths) { /* which have heights in z */
    scale->up[1] = 0.0;
    scale->up[2] = 1.0;
  }
  return status == CONIC_OK ? measure_drawing(d) : status;
}

conic_status conic_source_of_drawing(conic_context *context, conic_splats *splats, conic_triangles *triangles,
                                     conic_source **source) {
  *source = NULL;
  conic_status status = conic_splats_check_own(context, "source", splats);
  if (status == CONIC_OK && triangles)
    status = conic_triangles_check_own(context, "source", triangles);
  if (status != CONIC_OK)
    return status;
  status = conic_source_create(context, &conic_source_kind_drawing, "drawing", source);
  if (status != CONIC_OK) {
    conic_splats_release(context, splats);
    if (triangles)
      conic_triangles_release(context, triangles);
    return status;
  }
  drawing_source *d = (drawing_source *)*source;
  d->splats = *splats;
  memset(splats, 0, sizeof *splats);
  if (triangles) {
    d->triangles = *triangles;
    memset(triangles, 0, sizeof *triangles);
  }
  return conic_source_finish(measure_drawing(d), source);
}

static void close_drawing(conic_source *source) {
  drawing_source *d = (drawing_source *)source;
  conic_splats_release(source->context, &d->splats);
  conic_triangles_release(source->context, &d->triangles);
}

static conic_status find_drawing_spacing(conic_source *source, double *spacing) {
  return conic_splats_spacing(source->context, &((drawing_source *)source)->splats, spacing);
}

const conic_source_kind conic_source_kind_drawing = {
    .size = sizeof(drawing_source),
    .company = CONIC_SOURCE_MANY,
    .takes = takes_drawing,
    .open = open_drawing,
    .close = close_drawing,
    .find_spacing = find_drawing_spacing,
};
