#include "cli/commands/build_coloring.h"

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

conic_status cli_coloring_apply(cli_build *build, cli_coloring *coloring, const double up[3], conic_splats *splats,
                                conic_triangles *triangles) {
  if (!coloring->options.by)
    return CONIC_OK;
  use_up(coloring, up);
  conic_status status =
      conic_drawing_color(build->session->context, &coloring->options, splats, triangles, &coloring->done);
  return status == CONIC_OK && !coloring->done.field[0]
             ? cli_build_know(build, build->effects.possible & ~CLI_FACT(VALUED))
             : status;
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

static conic_status sample_pieces(const cli_points_share *share, const conic_read_options *reading,
                                  range_search *search) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < share->n && status == CONIC_OK; i++)
    status = cli_points_share_stream(share, &share->pieces[i], reading, see_batch, search);
  return status;
}

/* Makes one sample of all processes' values: every so many-th value of all. A second reading takes these values, once
 * their number is known. */
static conic_status sample_together(const cli_points_share *share, const conic_read_options *reading,
                                    range_search *search) {
  conic_value_sample *sample = search->sample;
  const conic_team *team = share->team;
  uint64_t n_seen[CONIC_MOST_IN_TEAM], n_before = 0, n_all = 0;
  size_t sizes[CONIC_MOST_IN_TEAM];
  conic_team_collect(team, &sample->n_seen, sizeof sample->n_seen, n_seen);
  for (int i = 0; i < team->count; i++) {
    n_before += i < team->index ? n_seen[i] : 0;
    n_all += n_seen[i];
  }
  uint64_t stride = conic_value_stride(n_all, CONIC_MOST_VALUES);
  conic_status status = CONIC_OK;
  if (stride > 1) {
    sample->n_seen = n_before;
    sample->stride = stride;
    sample->n = 0;
    status = conic_team_agree(team, sample_pieces(share, reading, search));
  }
  if (status != CONIC_OK)
    return status;
  double *all = team->collect(team->data, sample->values, sample->n * sizeof *sample->values, sizes);
  sample->n = 0;
  for (int i = 0; i < team->count; i++)
    sample->n += sizes[i] / sizeof *all;
  memcpy(sample->values, all, sample->n * sizeof *all);
  team->release(team->data, all);
  return CONIC_OK;
}

conic_status cli_coloring_find_range(cli_coloring *coloring, const cli_points_share *share,
                                     const conic_read_options *reading) {
  conic_coloring_options *options = &coloring->options;
  if (!options->by)
    return CONIC_OK;
  use_up(coloring, (const double[3]){0.0, share->are_surveys ? 0.0 : 1.0, share->are_surveys ? 1.0 : 0.0});
  if (!conic_coloring_needs_range(options))
    return CONIC_OK;
  conic_context *context = share->session->context;
  range_search search = {options, conic_memory_allocate_zeroed(context, 1, sizeof *search.sample)};
  conic_status status = search.sample ? sample_pieces(share, reading, &search) : CONIC_ERROR_MEMORY;
  status = conic_team_agree(share->team, status);
  if (status == CONIC_OK && share->team)
    status = sample_together(share, reading, &search);
  if (status == CONIC_OK)
    conic_value_sample_limits(search.sample, &options->minimum, &options->maximum);
  options->has_range = options->minimum < options->maximum;
  conic_memory_release(context, search.sample);
  return status;
}
