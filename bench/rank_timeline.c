/* The picture of a job: what each rank did when. */
#include "bench/plot.h"
#include "bench/rank_schedule.h"
#include "core/files/file.h"

enum { ROW_HEIGHT = 16, LEAST_HEIGHT = 200, MOST_HEIGHT = 4000 };

static const char *const kind_names[CLI_RANK_N_KINDS] = {"each by itself", "shares",        "waits", "opens",
                                                         "draws",          "joins results", "writes"};
static const char *const kind_colors[CLI_RANK_N_KINDS] = {"#f0e442", "#56b4e9", "#ffffff", "#888888",
                                                          "#0072b2", "#d55e00", "#009e73"};

/* The first event is at 0. Rank 0 is the lowest row. */
static void draw_events(cli_plot *plot, const cli_rank_trace *trace, cli_rank_kind kind) {
  for (size_t i = 0; i < trace->n_events; i++) {
    const cli_rank_event *event = &trace->events[i];
    if (event->kind != kind)
      continue;
    const cli_plot_style style = {.color = kind_colors[event->kind], .shape = CLI_PLOT_SQUARE};
    const double x[2] = {event->begin_s - trace->first_event, event->end_s - trace->first_event},
                 y[2] = {event->rank - 0.4, event->rank + 0.4};
    cli_plot_box(plot, &style, x, y);
  }
}

static void write_timeline(FILE *to, const cli_rank_trace *trace) {
  int height = 100 + ROW_HEIGHT * trace->n_ranks;
  height = height < LEAST_HEIGHT ? LEAST_HEIGHT : height < MOST_HEIGHT ? height : MOST_HEIGHT;
  const cli_plot_grid grid = {1, 1, 1000, height, CLI_RANK_N_KINDS};
  cli_plot_axis time = {.label = "seconds"}, rank = {.label = "rank"};
  cli_plot plot;
  cli_plot_include(&time, trace->seconds);
  cli_plot_include(&rank, -0.5);
  cli_plot_include(&rank, trace->n_ranks - 0.5);
  cli_plot_begin(&plot, to, "What the ranks did", &grid);
  cli_plot_panel(&plot, "", &time, &rank);
  for (int kind = 0; kind < CLI_RANK_N_KINDS; kind++) {
    draw_events(&plot, trace, (cli_rank_kind)kind);
    const cli_plot_style style = {.color = kind_colors[kind], .shape = CLI_PLOT_SQUARE};
    if (kind != CLI_RANK_WAITS) /* gaps */
      cli_plot_key(&plot, &style, kind_names[kind]);
  }
  cli_plot_end(&plot);
}

conic_status cli_rank_trace_draw(conic_context *context, const cli_rank_trace *trace, const char *path) {
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  write_timeline(conic_output_stream(output), trace);
  return conic_output_commit(output);
}
