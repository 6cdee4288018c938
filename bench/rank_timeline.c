/* The picture of a job: what each rank did when. */
#include "bench/plot.h"
#include "bench/rank_schedule.h"
#include "core/files/file.h"

enum { ROW_HEIGHT = 16, LEAST_HEIGHT = 200, MOST_HEIGHT = 4000 };

static const char *const kind_names[CLI_RANK_N_KINDS] = {"each by itself", "shares",        "",      "opens",
                                                         "draws",          "joins results", "writes"};
static const char *const kind_colors[CLI_RANK_N_KINDS] = {"#f0e442", "#56b4e9", "",       "#888888",
                                                          "#0072b2", "#d55e00", "#009e73"};

/* The first event is at 0. Rank 0 is the lowest row. */
static void draw_span(cli_plot *plot, const cli_rank_trace *trace, const cli_rank_event *event, double begin_s,
                      double end_s) {
  const cli_plot_style style = {.color = kind_colors[event->kind], .shape = CLI_PLOT_SQUARE};
  const double x[2] = {begin_s - trace->first_event, end_s - trace->first_event},
               y[2] = {event->rank - 0.4, event->rank + 0.4};
  if (begin_s < end_s)
    cli_plot_box(plot, &style, x, y);
}

/* A stage's waiting is told next by its rank, and lies at its end. */
static double end_of_work(const cli_rank_trace *trace, size_t i) {
  const cli_rank_event *stage = &trace->events[i], *next = stage + 1, *end = trace->events + trace->n_events;
  while (next < end && (next->rank != stage->rank || next->kind > CLI_RANK_WAITS))
    next++;
  return next < end && next->kind == CLI_RANK_WAITS ? next->begin_s : stage->end_s;
}

/* Boxes let through what is below them: of building, what lies between stages. */
static void draw_between(cli_plot *plot, const cli_rank_trace *trace, const cli_rank_event *whole) {
  double at = whole->begin_s;
  for (size_t i = 0; i < trace->n_events; i++) {
    const cli_rank_event *event = &trace->events[i];
    if (event->rank != whole->rank || event->kind != CLI_RANK_SHARES)
      continue;
    draw_span(plot, trace, whole, at, event->begin_s);
    at = event->end_s > at ? event->end_s : at;
  }
  draw_span(plot, trace, whole, at, whole->end_s);
}

static void draw_events(cli_plot *plot, const cli_rank_trace *trace) {
  for (size_t i = 0; i < trace->n_events; i++) {
    const cli_rank_event *event = &trace->events[i];
    if (event->kind == CLI_RANK_BUILDS)
      draw_between(plot, trace, event);
    else if (event->kind != CLI_RANK_WAITS)
      draw_span(plot, trace, event, event->begin_s,
                event->kind == CLI_RANK_SHARES ? end_of_work(trace, i) : event->end_s);
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
  draw_events(&plot, trace);
  for (int kind = 0; kind < CLI_RANK_N_KINDS; kind++) {
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
