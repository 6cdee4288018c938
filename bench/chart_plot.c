/* Drawing the chart by gnuplot, a program that need not be there. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/chart.h"

/* A figure: a file's name, the table's column of the error, and what the error is called. */
typedef struct figure {
  const char *name, *error, *label;
  int is_log; /* errors span decades */
} figure;

static const figure figures[] = {
    {"chart-oracle", "oracle_rmse", "RMSE against the exact kernel", 1},
    {"chart-scene", "scene_rmse", "RMSE against the surface", 0},
};

enum { N_FIGURES = sizeof figures / sizeof figures[0] };

static void write_style(FILE *to) {
  static const char *const colors[] = {"#1b6ca8", "#c0392b", "#2e8b57", "#8e44ad", "#d68910", "#555555"};
  static const int symbols[] = {7, 5, 9, 13}; /* a kernel: circle, square, triangle, diamond */
  fputs("set datafile separator ','\nset datafile columnheaders\nset logscale x\nset xtics (0.1, 0.2, 0.5, 1, 2, 5, "
        "10, 20, 50, 100, 200, 500)\nset grid lc "
        "rgb '#dddddd' lt 1\n"
        "set border lc rgb '#666666'\nset xlabel 'ms a frame'\nset key outside right top\n",
        to);
  for (int i = 0; i < CONIC_N_METHODS; i++)
    fprintf(to, "color_%s = '%s'\n", conic_method_name((conic_method)i), colors[i % 6]);
  for (int i = 0; i < 4; i++)
    fprintf(to, "symbol_%s = %d\n", conic_kernel_type_name((conic_kernel_type)i), symbols[i]);
}

static int by_time(const void *a, const void *b) {
  const cli_chart_point *first = *(const cli_chart_point *const *)a, *second = *(const cli_chart_point *const *)b;
  return (first->ms > second->ms) - (first->ms < second->ms);
}

/* The front of a scene as gnuplot's data: time and error, a corner for each step down. */
static void write_front(FILE *to, int i_figure, int i_scene, const cli_chart_point *points, int n_points) {
  const cli_chart_point *front[n_points > 0 ? n_points : 1];
  size_t n = 0;
  for (int i = 0; i < n_points; i++)
    if (points[i].scene == &cli_chart_scenes[i_scene] && points[i].is_front[i_figure])
      front[n++] = &points[i];
  qsort(front, n, sizeof front[0], by_time); /* NOLINT(bugprone-sizeof-expression): pointers are sorted */
  fprintf(to, "$front_%d_%d << END\nms,error\n", i_figure, i_scene);
  for (size_t i = 0; i < n; i++) {
    if (i)
      fprintf(to, "%.6g,%.6g\n", front[i]->ms, cli_chart_error_of(front[i - 1], i_figure)->rmse);
    fprintf(to, "%.6g,%.6g\n", front[i]->ms, cli_chart_error_of(front[i], i_figure)->rmse);
  }
  fputs("END\n", to);
}

/* What the panel spans: its points, and a little around them. */
static void write_ranges(FILE *to, int i_figure, int i_scene, const cli_chart_point *points, int n_points) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {0.0, 0.0};
  for (int i = 0; i < n_points; i++) {
    const cli_chart_error *error = cli_chart_error_of(&points[i], i_figure);
    const double at[2] = {points[i].ms, error->rmse};
    for (int k = 0; k < 2 && points[i].scene == &cli_chart_scenes[i_scene] && error->is_measured; k++) {
      low[k] = at[k] < low[k] ? at[k] : low[k];
      high[k] = at[k] > high[k] ? at[k] : high[k];
    }
  }
  fprintf(to, "set xrange [%.6g:%.6g]\n", low[0] / 1.3, high[0] * 1.3);
  if (figures[i_figure].is_log)
    fprintf(to, "set logscale y\nset format y '10^{%%T}'\nset yrange [%.6g:%.6g]\n", low[1] / 2.0, high[1] * 2.0);
  else
    fprintf(to, "unset logscale y\nset format y '%%g'\nset yrange [0:%.6g]\n", high[1] * 1.1);
}

/* A panel: the front, then the points of each method and kernel; larger for larger cutoffs. */
static void write_panel(FILE *to, int i_figure, int i_scene) {
  const figure *f = &figures[i_figure];
  const cli_chart_scene *scene = &cli_chart_scenes[i_scene];
  fprintf(to, "set title '%s, %zu splats'\nset ylabel '%s'\n%s\n", scene->name, scene->n_splats, f->label,
          i_scene % 2 ? "set key outside right top" : "unset key");
  fprintf(to, "plot $front_%d_%d using 1:2 with lines lc rgb '#999999' lw 2 dt 2 title 'best for its time'", i_figure,
          i_scene);
  for (int method = 0; method < CONIC_N_METHODS; method++)
    for (int kernel = 0; kernel < 4; kernel++) {
      const char *m = conic_method_name((conic_method)method), *k = conic_kernel_type_name((conic_kernel_type)kernel);
      fprintf(to,
              ", \\\n  'chart.csv' using (strcol('scene') eq '%s' && strcol('method') eq '%s' && strcol('kernel') eq "
              "'%s' ? column('ms') : NaN):(column('%s')):(0.5 + 0.4 * column('cutoff')) with points pt symbol_%s "
              "ps variable lc rgb color_%s title '%s, %s'",
              scene->name, m, k, f->error, k, m, m, k);
    }
  fputs("\n", to);
}

conic_status cli_chart_write_script(cli_session *session, const char *folder, const cli_chart_point *points,
                                    int n_points) {
  conic_output *output;
  conic_status status = cli_chart_open(session, folder, "chart.gp", &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  write_style(to);
  for (int i = 0; i < N_FIGURES; i++)
    for (int i_scene = 0; i_scene < CLI_N_CHART_SCENES; i_scene++)
      write_front(to, i, i_scene, points, n_points);
  for (int i = 0; i < N_FIGURES; i++)
    for (int is_png = 0; is_png < 2; is_png++) {
      fprintf(to, "set terminal %s size 1500,1000 font '%s'\nset output '%s.%s'\n",
              is_png ? "pngcairo" : "svg enhanced", is_png ? "Sans,10" : "Sans,12", figures[i].name,
              is_png ? "png" : "svg");
      fprintf(to, "set multiplot layout 2,2 title '%s over time: larger symbols are larger cutoffs'\n",
              figures[i].label);
      for (int k = 0; k < CLI_N_CHART_SCENES; k++) {
        write_ranges(to, i, k, points, n_points);
        write_panel(to, i, k);
      }
      fputs("unset multiplot\nset output\n", to);
    }
  return conic_output_commit(output);
}
