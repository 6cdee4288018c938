/* The chart of a user's scenes as a table and as a picture. */
#include <stdlib.h>

#include "bench/chart_axes.h"
#include "bench/plot.h"
#include "core/files/file.h"

static void write_axis_point(FILE *to, const cli_axis_chart *chart, const cli_axis_point *p) {
  const conic_render_statistics *s = &p->statistics;
  cli_chart_write_quoted(to, chart->paths[p->i_scene]);
  fprintf(to, ",%s,%s,%d,%d,%llu,%llu,%.4f,%.4f", cli_chart_axis_name(p->i_axis), p->value, chart->size[0],
          chart->size[1], (unsigned long long)s->splats_in, (unsigned long long)s->triangles_in, p->ms, s->ms.lod);
  cli_chart_write_error(to, &p->error);
  fprintf(to, ",%zu,%d\n", p->holes, p->is_front);
}

static void write_table(FILE *to, const void *cookie) {
  const cli_axis_chart *chart = cookie;
  fputs("scene,axis,value,width,height,splats,triangles,ms,lod_ms,max,rmse,psnr,flip,holes,front\n", to);
  for (int i = 0; i < chart->n_points; i++)
    write_axis_point(to, chart, &chart->points[i]);
}

/* The points of one scene and axis: how many follow `first`. */
static int length_of_series(const cli_axis_chart *chart, int first) {
  int n = 1;
  while (first + n < chart->n_points && chart->points[first + n].i_scene == chart->points[first].i_scene &&
         chart->points[first + n].i_axis == chart->points[first].i_axis)
    n++;
  return n;
}

static int count_series(const cli_axis_chart *chart) {
  int n = 0;
  for (int first = 0; first < chart->n_points; first += length_of_series(chart, first))
    n++;
  return n;
}

/* Axes of words are no line. */
static int is_ordered(const char *value) {
  return value[0] >= '0' && value[0] <= '9';
}

static void draw_series(cli_plot *plot, const cli_axis_chart *chart, int first, int n, const cli_plot_style *style) {
  double x[n], y[n];
  for (int i = 0; i < n; i++) {
    x[i] = chart->points[first + i].ms;
    y[i] = chart->points[first + i].error.rmse;
  }
  if (is_ordered(chart->points[first].value))
    cli_plot_line(plot, style, n, x, y);
  for (int i = 0; i < n; i++) {
    const cli_axis_point *p = &chart->points[first + i];
    char tip[160];
    snprintf(tip, sizeof tip, "%s %s: %.3g ms, %.3g", cli_chart_axis_name(p->i_axis), p->value, x[i], y[i]);
    cli_plot_mark(plot, style, x[i], y[i], 5.0, tip);
    cli_plot_words(plot, style->color, x[i], y[i], p->value);
  }
}

static void name_series(const cli_axis_chart *chart, const cli_axis_point *point, char *name, size_t room) {
  if (chart->n_paths > 1)
    snprintf(name, room, "%.18s, %s", conic_file_name(chart->paths[point->i_scene]),
             cli_chart_axis_name(point->i_axis));
  else
    snprintf(name, room, "%s", cli_chart_axis_name(point->i_axis));
}

static void draw_chart(FILE *to, const void *cookie) {
  const cli_axis_chart *chart = cookie;
  const cli_plot_grid grid = {1, 1, 760, 520, count_series(chart) + 2};
  cli_plot_axis x = {"ms a frame, with the choice of what is drawn", 1, 0.0, 0.0}, y = {"RMSE", 1, 0.0, 0.0};
  cli_plot plot;
  char title[160];
  for (int i = 0; i < chart->n_points; i++) {
    cli_plot_include(&x, chart->points[i].ms);
    cli_plot_include(&y, chart->points[i].error.rmse);
  }
  snprintf(title, sizeof title, "%.60s%s: error over time", conic_file_name(chart->paths[0]),
           chart->n_paths > 1 ? " and others" : "");
  cli_plot_begin(&plot, to, title, &grid);
  snprintf(title, sizeof title, "against the first scene in full detail, %d × %d samples a pixel", chart->truth_samples,
           chart->truth_samples);
  cli_plot_panel(&plot, title, &x, &y);
  for (int first = 0, i = 0; first < chart->n_points; first += length_of_series(chart, first), i++) {
    const cli_plot_style style = cli_plot_style_of(i);
    draw_series(&plot, chart, first, length_of_series(chart, first), &style);
  }
  cli_plot_key(&plot, NULL, "what changes");
  for (int first = 0, i = 0; first < chart->n_points; first += length_of_series(chart, first), i++) {
    const cli_plot_style style = cli_plot_style_of(i);
    char name[64];
    name_series(chart, &chart->points[first], name, sizeof name);
    cli_plot_key(&plot, &style, name);
  }
  cli_plot_end(&plot);
}

conic_status cli_axis_chart_write(const cli_session *session, const char *folder, const cli_axis_chart *chart) {
  conic_status status = cli_chart_put(session, folder, "scene.csv", write_table, chart);
  return status == CONIC_OK ? cli_chart_put(session, folder, "scene.svg", draw_chart, chart) : status;
}

void cli_axis_chart_print(const cli_axis_chart *chart) {
  puts("best for their time:");
  for (int i = 0; i < chart->n_points; i++) {
    const cli_axis_point *p = &chart->points[i];
    if (p->is_front)
      printf("  %-24.24s %-10s %-10s %8.2f ms  rmse %.3g  %.2f dB\n", conic_file_name(chart->paths[p->i_scene]),
             cli_chart_axis_name(p->i_axis), p->value, p->ms, p->error.rmse, p->error.psnr);
  }
}
