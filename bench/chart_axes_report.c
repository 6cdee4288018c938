/* The chart of a user's scenes: its table, its picture, and what is printed. */

#include "bench/chart_axes.h"
#include "bench/plot.h"

/* --- the table --- */

static void write_axis_point(FILE *to, const cli_axis_chart *chart, const cli_axis_point *p) {
  cli_chart_write_quoted(to, chart->asked.scenes[p->way.i_scene]);
  fprintf(to, ",%s,%s,%d,%d,%llu,%llu,%.4f,%.4f", p->way.axis, p->way.value, chart->size[0], chart->size[1],
          (unsigned long long)p->splats, (unsigned long long)p->triangles, p->ms, p->lod_ms);
  cli_chart_write_error(to, &p->error);
  fprintf(to, ",%zu,%d,%.4g,%.5g,%llu,%.3g,%d,%d\n", p->holes, p->is_best[CLI_COST_TIME], p->error.delta_e,
          p->stated_px, (unsigned long long)p->bytes, p->spread, p->is_best[CLI_COST_PRIMITIVES],
          p->is_best[CLI_COST_BYTES]);
}

static void write_table(FILE *to, const void *cookie) {
  const cli_axis_chart *chart = cookie;
  fputs("scene,axis,value,width,height,splats,triangles,ms,lod_ms,max,rmse,psnr,flip,holes,front,delta_e,stated_px,"
        "bytes,spread,primitives_front,bytes_front\n",
        to);
  for (int i = 0; i < chart->n_points; i++)
    write_axis_point(to, chart, &chart->points[i]);
}

/* --- the picture --- */

/* Errors: a row of panels each. */
typedef enum axis_error { ERROR_COLOR, ERROR_PLACE, N_ERRORS } axis_error;

static double error_of(const cli_axis_point *p, axis_error error) {
  return error == ERROR_COLOR ? fmax(1e-3, p->error.delta_e) : p->stated_px;
}

/* The points of one scene and axis: how many follow `first`. */
static int length_of_series(const cli_axis_chart *chart, int first) {
  int n = 1;
  while (first + n < chart->n_points && chart->points[first + n].way.i_scene == chart->points[first].way.i_scene &&
         strcmp(chart->points[first + n].way.axis, chart->points[first].way.axis) == 0)
    n++;
  return n;
}

static int count_series(const cli_axis_chart *chart) {
  int n = 0;
  for (int first = 0; first < chart->n_points; first += length_of_series(chart, first))
    n++;
  return n;
}

static void draw_series(cli_plot *plot, const cli_axis_chart *chart, int first, cli_chart_cost cost, axis_error error,
                        const cli_plot_style *style) {
  for (int i = first; i < first + length_of_series(chart, first); i++) {
    const cli_axis_point *p = &chart->points[i];
    const double x = cli_axis_cost(p, cost), y = error_of(p, error);
    char tip[192];
    snprintf(tip, sizeof tip, "%s %s: %.3g, %.3g", p->way.axis, p->way.value, x, y);
    cli_plot_mark(plot, style, x, y, p->is_best[cost] ? 6.0 : 4.0, tip);
    cli_plot_words(plot, style->color, x, y, p->way.value);
  }
}

static const cli_plot_style front_style = {.color = "#999999", .is_line = 1, .is_dashed = 1};

static const cli_plot_style floor_style = {.color = "#cc3311", .is_line = 1};

/* What the points of the front would take by the machine's rates alone. */
static void draw_floor(cli_plot *plot, const cli_axis_chart *chart, axis_error error) {
  double floors[chart->n_points + 1][2];
  int n = 0;
  for (int i = 0; i < chart->n_points; i++)
    if (chart->points[i].floor_ms > 0.0 && chart->points[i].is_best[CLI_COST_TIME]) {
      floors[n][0] = chart->points[i].floor_ms;
      floors[n][1] = error_of(&chart->points[i], error);
      cli_plot_mark(plot, &floor_style, floors[n][0], floors[n][1], 3.0, "floor");
      n++;
    }
  cli_plot_front(plot, &floor_style, n, floors);
}

static void draw_panel(cli_plot *plot, const cli_axis_chart *chart, cli_chart_cost cost, axis_error error) {
  static const char *const costs[] = {"ms a frame, with the choice of what is drawn", "splats and triangles",
                                      "bytes of them in memory"};
  static const char *const errors[] = {"ΔE, mean over touched pixels", "stated error in pixels"};
  cli_plot_axis x = {costs[cost], 1, 0.0, 0.0}, y = {errors[error], 1, 0.0, 0.0};
  for (int i = 0; i < chart->n_points; i++) {
    cli_plot_include(&x, cli_axis_cost(&chart->points[i], cost));
    if (cost == CLI_COST_TIME)
      cli_plot_include(&x, chart->points[i].floor_ms);
    cli_plot_include(&y, error_of(&chart->points[i], error));
  }
  cli_plot_panel(plot, "", &x, &y);
  double best[chart->n_points + 1][2];
  int n_best = 0;
  for (int i = 0; i < chart->n_points && error == ERROR_COLOR; i++)
    if (chart->points[i].is_best[cost]) {
      best[n_best][0] = cli_axis_cost(&chart->points[i], cost);
      best[n_best++][1] = error_of(&chart->points[i], error);
    }
  cli_plot_front(plot, &front_style, n_best, best);
  if (cost == CLI_COST_TIME)
    draw_floor(plot, chart, error);
  for (int first = 0, i = 0; first < chart->n_points; first += length_of_series(chart, first), i++) {
    const cli_plot_style style = cli_plot_style_of(i);
    draw_series(plot, chart, first, cost, error, &style);
  }
}

static int has_floor(const cli_axis_chart *chart) {
  int has = 0;
  for (int i = 0; i < chart->n_points; i++)
    has |= chart->points[i].floor_ms > 0.0;
  return has;
}

static void write_legend(cli_plot *plot, const cli_axis_chart *chart) {
  cli_plot_key(plot, NULL, "what changes");
  for (int first = 0, i = 0; first < chart->n_points; first += length_of_series(chart, first), i++) {
    const cli_plot_style style = cli_plot_style_of(i);
    const cli_axis_point *point = &chart->points[first];
    char name[96];
    if (chart->asked.n_scenes > 1)
      snprintf(name, sizeof name, "%.18s, %s", conic_file_name(chart->asked.scenes[point->way.i_scene]),
               point->way.axis);
    else
      snprintf(name, sizeof name, "%s", point->way.axis);
    cli_plot_key(plot, &style, name);
  }
  cli_plot_key(plot, &front_style, "best for its cost");
  if (has_floor(chart))
    cli_plot_key(plot, &floor_style, "floor of the best, by the machine's rates");
}

static void draw_chart(FILE *to, const void *cookie) {
  const cli_axis_chart *chart = cookie;
  char title[192];
  int n_rows = 1;
  for (int i = 0; i < chart->n_points; i++)
    n_rows = chart->points[i].stated_px > 0.0 ? 2 : n_rows;
  const cli_plot_grid grid = {CLI_N_CHART_COSTS, n_rows * CLI_N_CHART_COSTS, 470, 400, count_series(chart) + 4};
  cli_plot plot;
  snprintf(title, sizeof title, "%.60s%s against the first scene in full detail, %d × %d samples a pixel",
           conic_file_name(chart->asked.scenes[0]), chart->asked.n_scenes > 1 ? " and others" : "",
           chart->truth_samples, chart->truth_samples);
  cli_plot_begin(&plot, to, title, &grid);
  for (int row = 0; row < n_rows; row++)
    for (int cost = 0; cost < CLI_N_CHART_COSTS; cost++)
      draw_panel(&plot, chart, (cli_chart_cost)cost, (axis_error)row);
  write_legend(&plot, chart);
  cli_plot_end(&plot);
}

conic_status cli_axis_chart_write(const cli_session *session, const char *folder, const cli_axis_chart *chart) {
  conic_status status = cli_chart_put(session, folder, "scene.csv", write_table, chart);
  return status == CONIC_OK ? cli_chart_put(session, folder, "scene.svg", draw_chart, chart) : status;
}

/* --- what is printed --- */

/* A word as a shell takes it. */
static void put_word(char *to, size_t room, const char *word) {
  size_t n = strlen(to);
  const char *quote = word[strcspn(word, " '\"$*?&;|<>()\\`!#~")] ? "'" : "";
  snprintf(to + n, room - n, " %s%s%s", quote, word, quote);
}

void cli_axis_command(const cli_axis_chart *chart, const cli_axis_point *point, char *to, size_t room) {
  static const char *const own[] = {"o", "over", "time", "beside", "truth", "json", "mesh", "quick", "q", "quiet"};
  enum { N_OWN = sizeof own / sizeof own[0], N_FLAGS = 3 };
  const char *argv[chart->asked.argc + CLI_MOST_WORDS];
  int n = cli_chart_words(&chart->asked, point->way.i_scene, &point->way, argv);
  snprintf(to, room, "conic render");
  for (int i = 1; i < n; i++) {
    const char *name = argv[i] + strspn(argv[i], "-");
    const size_t length = strcspn(name, "=");
    int k = name == argv[i] ? N_OWN : 0;
    while (k < N_OWN && (strlen(own[k]) != length || strncmp(name, own[k], length) != 0))
      k++;
    if (k == N_OWN)
      put_word(to, room, argv[i]);
    else if (k < N_OWN - N_FLAGS && !name[length])
      i++; /* its value */
  }
}

void cli_axis_chart_print(const cli_axis_chart *chart) {
  puts("best for their time:");
  for (int i = 0; i < chart->n_points; i++) {
    const cli_axis_point *p = &chart->points[i];
    if (p->is_best[CLI_COST_TIME])
      printf("  %-24.24s %-10s %-10s %8.2f ms  rmse %.3g  %.2f dB\n",
             conic_file_name(chart->asked.scenes[p->way.i_scene]), p->way.axis, p->way.value, p->ms, p->error.rmse,
             p->error.psnr);
  }
  if (!(chart->most_seconds > 0.0))
    return;
  const cli_axis_point *nearest = cli_axis_in_time(chart);
  char line[1024] = "nothing of it";
  if (nearest)
    cli_axis_command(chart, nearest, line, sizeof line);
  printf("in %g s: %s\n", chart->most_seconds, line);
}
