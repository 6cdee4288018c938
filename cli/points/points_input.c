#include "cli/points/points_input.h"

#include "core/files/file.h"
#include "core/formats/model_read.h"
#include "lod/layers/draw/layers_gather.h"

/* A COPC on disk is also a LAZ, which gives more values. */
int cli_points_are_hierarchy(const char *path) {
  int may_be_copc = conic_file_is_there(path) && !conic_file_has_ending(path, "json");
  return conic_layers_is_url(path) || (!may_be_copc && conic_layers_is_hierarchy(path));
}

int cli_points_may_be_text(conic_context *context, const char *path) {
  conic_model_kind kind = CONIC_MODEL_XYZ;
  conic_input input;
  if (cli_points_are_hierarchy(path) || conic_layers_is_file(path))
    return 0;
  if (!conic_file_is_there(path) || conic_model_open(context, path, &input, &kind) != CONIC_OK)
    return 1;
  conic_input_close(&input);
  return kind == CONIC_MODEL_XYZ;
}

int cli_points_are_surveys(const char *const *paths, int n_paths) {
  int n_surveys = 0;
  for (int i = 0; i < n_paths; i++)
    n_surveys += conic_file_begins_with(paths[i], "LASF", 4) || conic_file_begins_with(paths[i], "ASTM-E57", 8) ||
                 conic_file_has_ending(paths[i], "ptx") || cli_points_are_hierarchy(paths[i]);
  return n_paths > 0 && n_surveys == n_paths;
}

conic_status cli_points_open(cli_session *session, const char *path, uint64_t memory_bytes, conic_layers **layers) {
  conic_layers_access access;
  conic_layers_access_init(&access);
  if (memory_bytes)
    access.memory_bytes = memory_bytes;
  if (session->stall_seconds > 0.0)
    access.connect_seconds = access.stall_seconds = session->stall_seconds;
  if (session->deadline > 0.0 && conic_layers_is_url(path))
    access.seconds = fmax(session->late_seconds - cli_seconds(), 1e-3);
  return conic_layers_open(session->context, path, &access, layers);
}

conic_status cli_points_find_reference(cli_session *session, const char *path, conic_georeference *reference) {
  conic_layers *layers;
  if (!conic_layers_is_file(path) && !cli_points_are_hierarchy(path))
    return conic_georeference_read(session->context, path, reference);
  memset(reference, 0, sizeof *reference);
  conic_status status = cli_points_open(session, path, 0, &layers);
  if (status == CONIC_OK)
    status = conic_layers_find_georeference(layers, reference);
  conic_layers_close(layers);
  return status;
}

conic_status cli_points_find_epsg(cli_session *session, const char *path, int keeps_none, unsigned *epsg) {
  conic_georeference reference;
  conic_status status = cli_points_find_reference(session, path, &reference);
  *epsg = status == CONIC_OK ? reference.epsg : 0;
  if (status == CONIC_OK && (keeps_none ? *epsg > 0 : !*epsg && (reference.keys || reference.is_unknown)))
    cli_warn(session, "%s: its coordinate system%s is left out", path,
             keeps_none ? ", which the output cannot hold," : " has no EPSG code, and");
  if (status == CONIC_OK)
    conic_georeference_release(session->context, &reference);
  return status;
}

conic_status cli_points_write(cli_session *session, const char *input, const char *output, float cutoff,
                              const conic_splats *points) {
  conic_write_options options;
  conic_write_options_init(&options);
  options.cutoff = cutoff;
  conic_status status = cli_points_find_epsg(session, input, 0, &options.epsg);
  return status == CONIC_OK ? conic_splats_write(session->context, output, points, &options) : status;
}

/* A hierarchy gives only places and colours; options that need more are refused, not ignored. */
static conic_status stream_hierarchy(cli_session *session, const char *path, const conic_read_options *options,
                                     conic_batch_receiver *receive, void *cookie) {
  conic_layers *layers;
  const char *asked = options->where ? "--where" : options->keep ? "--keep" : options->field ? "--color-by" : NULL;
  if (asked && !(options->field && options->field_is_optional && !options->where && !options->keep))
    return conic_fail(session->context, CONIC_ERROR_INPUT,
                      "%s: only places and colours are read of it, without values by name: not with %s", path, asked);
  conic_status status = cli_points_open(session, path, 0, &layers);
  if (status == CONIC_OK)
    status = conic_layers_stream(layers, receive, cookie);
  conic_layers_close(layers);
  return status;
}

conic_status cli_points_stream(cli_session *session, const char *path, const conic_read_options *options,
                               conic_batch_receiver *receive, void *cookie) {
  return cli_points_are_hierarchy(path) ? stream_hierarchy(session, path, options, receive, cookie)
                                        : conic_model_stream(session->context, path, options, receive, cookie);
}

typedef struct collecting {
  conic_context *context;
  conic_model *model;
  int has_begun;
} collecting;

static conic_status collect(void *cookie, const conic_splats *batch) {
  collecting *c = cookie;
  if (!c->has_begun) {
    conic_status status = conic_splats_allocate(c->context, 0, conic_splats_fields(batch), &c->model->points);
    if (status != CONIC_OK)
      return status;
    memcpy(c->model->points.origin, batch->origin, sizeof batch->origin);
    c->has_begun = 1;
  }
  return conic_splats_append(c->context, &c->model->points, batch);
}

conic_status cli_points_read(cli_session *session, const char *path, const conic_read_options *options,
                             conic_model *model) {
  collecting c = {.context = session->context, .model = model};
  if (!cli_points_are_hierarchy(path))
    return conic_gaussians_read_model(session->context, path, options, model);
  memset(model, 0, sizeof *model);
  conic_status status = stream_hierarchy(session, path, options, collect, &c);
  if (status != CONIC_OK)
    conic_model_release(session->context, model);
  return status;
}
