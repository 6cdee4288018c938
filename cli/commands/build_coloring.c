#include "cli/commands/build_coloring.h"

#include <string.h>

#include "cli/commands/points_input.h"
#include "core/base/memory.h"
#include "core/coloring/coloring_stream.h"

void cli_coloring_init(cli_coloring *coloring) {
  memset(coloring, 0, sizeof *coloring);
  conic_coloring_options_init(&coloring->options);
  coloring->options.by = NULL;
}

int cli_coloring_check(const cli_session *session, cli_coloring *coloring) {
  if (coloring->is_up_given && !coloring->options.by && !coloring->keeps_up)
    return cli_usage("%s: --up is about --color-by height; give it, too", session->command);
  return cli_color_check(session, &coloring->options, 0);
}

void cli_coloring_read(const cli_coloring *coloring, conic_read_options *reading) {
  if (coloring->options.by)
    conic_coloring_read(&coloring->options, reading);
}

static void use_up(cli_coloring *coloring, const double up[3]) {
  if (!coloring->is_up_given)
    memcpy(coloring->options.up, up, sizeof coloring->options.up);
}

conic_status cli_coloring_apply(cli_session *session, cli_coloring *coloring, const double up[3], conic_splats *splats,
                                conic_triangles *triangles) {
  if (!coloring->options.by)
    return CONIC_OK;
  use_up(coloring, up);
  return conic_drawing_color(session->context, &coloring->options, splats, triangles, &coloring->done);
}

typedef struct range_search {
  const conic_coloring_options *options;
  conic_value_sample *sample;
} range_search;

static conic_status see_batch(void *cookie, const conic_splats *batch) {
  const range_search *search = cookie;
  conic_coloring_sample(search->options, batch, search->sample);
  return CONIC_OK;
}

conic_status cli_coloring_find_range(cli_session *session, cli_coloring *coloring, const char *const *inputs,
                                     int n_inputs, const conic_read_options *reading) {
  conic_coloring_options *options = &coloring->options;
  conic_status status = CONIC_OK;
  if (!options->by)
    return CONIC_OK;
  int are_surveys = cli_points_are_surveys(inputs, n_inputs);
  use_up(coloring, (const double[3]){0.0, are_surveys ? 0.0 : 1.0, are_surveys ? 1.0 : 0.0});
  if (!conic_coloring_needs_range(options))
    return CONIC_OK;
  range_search search = {options, conic_memory_allocate_zeroed(session->context, 1, sizeof *search.sample)};
  if (!search.sample)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < n_inputs && status == CONIC_OK; i++)
    status = cli_points_stream(session->context, inputs[i], reading, see_batch, &search);
  conic_value_sample_limits(search.sample, &options->minimum, &options->maximum);
  options->has_range = options->minimum < options->maximum;
  conic_memory_release(session->context, search.sample);
  return status;
}
