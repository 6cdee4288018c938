/* The picture of the chart of representations: time and error over the size of a triangle, and which of them is the
 * fastest within an error. */
#include <math.h>

#include "bench/chart_mesh.h"
#include "bench/plot.h"

static const double least_error = 1e-6; /* smaller ones are drawn as this */

static double drawn_error(const cli_mesh_point *point) {
  return fmax(least_error, point->error.rmse);
}

/* The front of a size, from the fastest to the nearest; returns how many. */
static int sort_front(const cli_mesh_chart *chart, int i_size, int models[CLI_N_CHART_MODELS]) {
  int n = 0;
  for (int model = 0; model < CLI_N_CHART_MODELS; model++) {
    if (!chart->points[model][i_size].is_front)
      continue;
    int k = n++;
    for (; k > 0 && chart->points[models[k - 1]][i_size].ms > chart->points[model][i_size].ms; k--)
      models[k] = models[k - 1];
    models[k] = model;
  }
  return n;
}

/* Half way to the next size, or as far beyond the last; in the direction of `step`. */
static double border_of(const cli_mesh_chart *chart, int i_size, int step) {
  const cli_mesh_size *size = &chart->sizes[i_size];
  int next = i_size + step;
  if (next < 0 || next >= chart->n_sizes)
    return size->pixels_per_triangle * (step < 0 ? 1.4 : 1.0 / 1.4);
  return sqrt(size->pixels_per_triangle * chart->sizes[next].pixels_per_triangle);
}

static void find_mesh_axes(const cli_mesh_chart *chart, cli_plot_axis *size, cli_plot_axis *ms, cli_plot_axis *error) {
  *size = (cli_plot_axis){"pixels a triangle", 1, 0.0, 0.0};
  *ms = (cli_plot_axis){"ms a frame", 1, 0.0, 0.0};
  *error = (cli_plot_axis){"RMSE", 1, 0.0, 0.0};
  cli_plot_include(size, border_of(chart, chart->n_sizes - 1, 1));
  cli_plot_include(size, border_of(chart, 0, -1));
  for (int model = 0; model < CLI_N_CHART_MODELS; model++)
    for (int i = 0; i < chart->n_sizes; i++) {
      cli_plot_include(ms, chart->points[model][i].ms);
      cli_plot_include(error, drawn_error(&chart->points[model][i]));
    }
}

static cli_plot_style model_style(int model) {
  cli_plot_style style = cli_plot_style_of(model);
  style.is_line = 1;
  return style;
}

/* The sizes and the times or errors of a representation as a line of marks. */
static void draw_curve(cli_plot *plot, const cli_mesh_chart *chart, int model, int is_error) {
  cli_plot_style style = model_style(model);
  double x[CLI_MAX_MESH_SIZES], y[CLI_MAX_MESH_SIZES];
  for (int i = 0; i < chart->n_sizes; i++) {
    x[i] = chart->sizes[i].pixels_per_triangle;
    y[i] = is_error ? drawn_error(&chart->points[model][i]) : chart->points[model][i].ms;
  }
  cli_plot_line(plot, &style, chart->n_sizes, x, y);
  for (int i = 0; i < chart->n_sizes; i++) {
    char tip[96];
    snprintf(tip, sizeof tip, "%s, %.3g px: %.3g", cli_chart_model_name((cli_chart_model)model), x[i], y[i]);
    cli_plot_mark(plot, &style, x[i], y[i], 4.0, tip);
  }
}

/* Where others become as fast as triangles: dashed lines down the panel. */
static void draw_crossings(cli_plot *plot, const cli_mesh_chart *chart) {
  double at[CLI_MAX_MESH_SIZES];
  for (int model = CLI_CHART_TRIANGLES + 1; model < CLI_N_CHART_MODELS; model++) {
    cli_plot_style style = model_style(model);
    style.is_dashed = 1;
    int n = cli_mesh_chart_crossings(chart, model, at);
    for (int k = 0; k < n; k++) {
      const double x[2] = {at[k], at[k]}, y[2] = {plot->y.low, plot->y.high};
      char words[16];
      snprintf(words, sizeof words, "%.2g", at[k]);
      cli_plot_line(plot, &style, 2, x, y);
      cli_plot_words(plot, style.color, at[k], plot->y.low * pow(plot->y.high / plot->y.low, 0.05 * model), words);
    }
  }
}

/* Over the size and the error that is allowed: boxes of the fastest's colour. */
static void draw_map(cli_plot *plot, const cli_mesh_chart *chart) {
  for (int i = 0; i < chart->n_sizes; i++) {
    int front[CLI_N_CHART_MODELS], n = sort_front(chart, i, front);
    const double x[2] = {border_of(chart, i, 1), border_of(chart, i, -1)};
    for (int k = 0; k < n; k++) {
      const double y[2] = {drawn_error(&chart->points[front[k]][i]),
                           k ? drawn_error(&chart->points[front[k - 1]][i]) : plot->y.high};
      cli_plot_style style = cli_plot_style_of(front[k]);
      cli_plot_box(plot, &style, x, y);
    }
  }
}

void cli_mesh_chart_draw(FILE *to, const void *cookie) {
  const cli_mesh_chart *chart = cookie;
  const cli_plot_grid grid = {3, 3, 420, 400, CLI_N_CHART_MODELS + 2};
  cli_plot_axis size, ms, error;
  cli_plot plot;
  char title[96];
  snprintf(title, sizeof title, "Ways to draw a mesh of %zu triangles", chart->n_triangles);
  find_mesh_axes(chart, &size, &ms, &error);
  cli_plot_begin(&plot, to, title, &grid);
  cli_plot_panel(&plot, "time; dashed: as fast as triangles", &size, &ms);
  draw_crossings(&plot, chart);
  for (int model = 0; model < CLI_N_CHART_MODELS; model++)
    draw_curve(&plot, chart, model, 0);
  cli_plot_panel(&plot, "error against the mesh, 4 × 4 samples a pixel", &size, &error);
  for (int model = 0; model < CLI_N_CHART_MODELS; model++)
    draw_curve(&plot, chart, model, 1);
  error.label = "RMSE allowed";
  cli_plot_panel(&plot, "fastest within an error", &size, &error);
  draw_map(&plot, chart);
  cli_plot_key(&plot, NULL, "drawn as");
  for (int model = 0; model < CLI_N_CHART_MODELS; model++) {
    cli_plot_style style = cli_plot_style_of(model);
    cli_plot_key(&plot, &style, cli_chart_model_name((cli_chart_model)model));
  }
  cli_plot_end(&plot);
}
