#include "cli/layer/layer_job.h"
#include "cli/points/points_input.h"

conic_status cli_layer_open_input(cli_layer_job *job, const char *path, conic_layers **layers) {
  job->base.input = path;
  return cli_points_open(job->base.session, path, job->options.memory_bytes / 2, layers);
}

/* The values of a continued file become those of the whole. */
static conic_status take_value_names(cli_layer_job *job, const conic_layers *layers) {
  conic_context *context = job->base.session->context;
  conic_model_field field;
  size_t n = 0, room = 0;
  for (size_t i = 0; conic_layers_value(layers, i, &field); i++)
    room += strlen(field.name) + 2;
  if (room == 0)
    return CONIC_OK;
  job->continued = conic_memory_allocate(context, room, 1);
  if (!job->continued)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; conic_layers_value(layers, i, &field); i++)
    n += (size_t)snprintf(job->continued + n, room - n, "%s%s", i ? "," : "", field.name);
  job->keep = job->continued;
  return CONIC_OK;
}

/* Whether a file has the same values as the first one, in any order. */
static conic_status check_value_names(const cli_layer_job *job, const conic_layers *layers, const conic_layers *first) {
  const conic_layers *pairs[2][2] = {{first, layers}, {layers, first}};
  for (int k = 0; k < 2; k++) {
    conic_model_field field, other;
    for (size_t i = 0; conic_layers_value(pairs[k][0], i, &field); i++) {
      int is_there = 0;
      for (size_t j = 0; !is_there && conic_layers_value(pairs[k][1], j, &other); j++)
        is_there = strcmp(field.name, other.name) == 0 && strcmp(field.type, other.type) == 0;
      if (!is_there)
        return conic_fail(job->base.session->context, CONIC_ERROR_INPUT,
                          "%s: its samples have other values by name than those of %s: '%s' (%s) is in one alone",
                          job->base.input, job->inputs[0], field.name, field.type);
    }
  }
  return CONIC_OK;
}

conic_status cli_layer_continue(cli_layer_job *job, const char *const *paths, int n_paths) {
  conic_layers_options first = job->options;
  conic_layers *opened = NULL; /* the first file */
  conic_status status = CONIC_OK;
  for (int i = 0; i < n_paths && status == CONIC_OK; i++) {
    conic_layers *layers;
    status = cli_layer_open_input(job, paths[i], &layers);
    if (status != CONIC_OK)
      break;
    conic_layers_continue(layers, &job->options);
    if (i == 0)
      first = job->options;
    else if (memcmp(first.up, job->options.up, sizeof first.up) != 0) /* a direction that not all files state is
                                                                         unknown */
      memset(first.up, 0, sizeof first.up);
    if (first.epsg != job->options.epsg)
      first.epsg = 0;
    first.is_unoriented = job->options.is_unoriented;
    first.keeps_all = job->options.keeps_all;
    status = i == 0 ? take_value_names(job, layers) : check_value_names(job, layers, opened);
    if (i == 0)
      opened = layers;
    else
      conic_layers_close(layers);
  }
  conic_layers_close(opened);
  if (status == CONIC_OK && n_paths)
    job->options = first;
  return status;
}
