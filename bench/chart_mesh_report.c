/* The chart of representations: its table, what is printed, and gnuplot's script. */
#include <math.h>
#include <stdio.h>

#include "bench/chart_mesh.h"

static void write_quoted(FILE *to, const char *text) {
  fputc('"', to);
  for (; *text; text++)
    fprintf(to, *text == '"' ? "\"\"" : "%c", *text);
  fputc('"', to);
}

static void write_line(FILE *to, const cli_mesh_chart *chart, int model, int i_size) {
  const cli_mesh_size *size = &chart->sizes[i_size];
  const cli_mesh_point *p = &chart->points[model][i_size];
  write_quoted(to, chart->path ? chart->path : "terrain");
  fprintf(to, ",%zu,%s,%.4g,%d,%d,%.4g,%zu,%.4f,%.4f", chart->n_triangles, cli_chart_model_name((cli_chart_model)model),
          size->pixels_per_triangle, size->edge, size->edge, size->zoom, p->primitives, p->ms, p->lod_ms);
  cli_chart_write_error(to, &p->error);
  fprintf(to, ",%zu,%d\n", p->holes, p->is_front);
}

conic_status cli_mesh_chart_write(cli_session *session, const char *folder, const cli_mesh_chart *chart) {
  conic_output *output;
  conic_status status = cli_chart_open(session, folder, "representations.csv", &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  fputs("mesh,triangles,representation,pixels_per_triangle,width,height,zoom,primitives,ms,lod_ms,max,rmse,psnr,flip,"
        "holes,front\n",
        to);
  for (int model = 0; model < CLI_N_CHART_MODELS; model++)
    for (int i = 0; i < chart->n_sizes; i++)
      write_line(to, chart, model, i);
  return conic_output_commit(output);
}

/* Where a representation takes as long as triangles: the pixels a triangle, from large to small; returns how many.
 * Between two sizes both times are taken for powers of the size. */
static int find_crossings(const cli_mesh_chart *chart, int model, double at[CLI_MAX_MESH_SIZES]) {
  int n = 0;
  double before = 0.0, size_before = 0.0;
  for (int i = 0; i < chart->n_sizes; i++) {
    double lead = log(chart->points[CLI_CHART_TRIANGLES][i].ms / chart->points[model][i].ms);
    double size = log(chart->sizes[i].pixels_per_triangle);
    if (i && (lead > 0.0) != (before > 0.0))
      at[n++] = exp(size_before + (size - size_before) * before / (before - lead));
    before = lead;
    size_before = size;
  }
  return n;
}

void cli_mesh_chart_print(const cli_mesh_chart *chart) {
  double at[CLI_MAX_MESH_SIZES];
  printf("best for their time, of a mesh of %zu triangles:\n", chart->n_triangles);
  for (int i = 0; i < chart->n_sizes; i++)
    for (int model = 0; model < CLI_N_CHART_MODELS; model++) {
      const cli_mesh_point *p = &chart->points[model][i];
      if (p->is_front)
        printf("  %6.3g px a triangle  %-10s %8.2f ms  rmse %.3g\n", chart->sizes[i].pixels_per_triangle,
               cli_chart_model_name((cli_chart_model)model), p->ms, p->error.rmse);
    }
  puts("as fast as triangles:");
  for (int model = CLI_CHART_TRIANGLES + 1; model < CLI_N_CHART_MODELS; model++) {
    int n = find_crossings(chart, model, at);
    printf("  %-10s", cli_chart_model_name((cli_chart_model)model));
    for (int k = 0; k < n; k++)
      printf("%s %.2g", k ? "," : " at", at[k]);
    int is_faster = chart->points[model][0].ms < chart->points[CLI_CHART_TRIANGLES][0].ms;
    puts(n ? " px a triangle" : is_faster ? " nowhere, but faster" : " nowhere, but slower");
  }
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

/* The errors of all, widened a little. */
static void find_chart_errors(const cli_mesh_chart *chart, double range[2]) {
  range[0] = HUGE_VAL;
  range[1] = 0.0;
  for (int model = 0; model < CLI_N_CHART_MODELS; model++)
    for (int i = 0; i < chart->n_sizes; i++) {
      double rmse = fmax(1e-6, chart->points[model][i].error.rmse);
      range[0] = fmin(range[0], rmse / 1.5);
      range[1] = fmax(range[1], rmse * 1.5);
    }
}

/* Boxes over the size and the error that is allowed, where this representation is the fastest; returns how many. */
static int write_boxes(FILE *to, const cli_mesh_chart *chart, int model, const double range[2]) {
  int n_boxes = 0;
  fprintf(to, "$cheapest_%d << END\n", model);
  for (int i = 0; i < chart->n_sizes; i++) {
    int front[CLI_N_CHART_MODELS], n = sort_front(chart, i, front);
    for (int k = 0; k < n; k++) {
      if (front[k] != model)
        continue;
      double low = fmax(1e-6, chart->points[model][i].error.rmse);
      double high = k ? fmax(1e-6, chart->points[front[k - 1]][i].error.rmse) : range[1];
      fprintf(to, "%.6g %.6g %.6g %.6g %.6g %.6g\n", chart->sizes[i].pixels_per_triangle, sqrt(low * high),
              border_of(chart, i, 1), border_of(chart, i, -1), low, high);
      n_boxes++;
    }
  }
  fputs("END\n", to);
  return n_boxes;
}

static void write_style(FILE *to, const cli_mesh_chart *chart) {
  static const char *const colors[CLI_N_CHART_MODELS] = {"#1b6ca8", "#c0392b", "#2e8b57", "#8e44ad", "#d68910"};
  static const int symbols[CLI_N_CHART_MODELS] = {7, 5, 9, 13, 11};
  fputs("set datafile columnheaders\nset logscale xy\nset xlabel 'pixels a triangle'\n"
        "set xtics (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)\nset grid lc rgb '#dddddd' lt 1\n"
        "set border lc rgb '#666666'\nset key bottom right opaque\n",
        to);
  fprintf(to, "set xrange [%.6g:%.6g]\n", border_of(chart, chart->n_sizes - 1, 1), border_of(chart, 0, -1));
  for (int i = 0; i < CLI_N_CHART_MODELS; i++)
    fprintf(to, "set style line %d lc rgb '%s' lw 2 pt %d\n", i + 1, colors[i], symbols[i]);
}

/* Where others become as fast as triangles: lines down the panel. */
static void write_crossings(FILE *to, const cli_mesh_chart *chart) {
  double at[CLI_MAX_MESH_SIZES];
  for (int model = CLI_CHART_TRIANGLES + 1; model < CLI_N_CHART_MODELS; model++) {
    int n = find_crossings(chart, model, at);
    for (int k = 0; k < n; k++)
      fprintf(to,
              "set arrow from %.4g, graph 0 to %.4g, graph 1 nohead ls %d lw 1 dt 2\n"
              "set label '%.2g' at %.4g, graph %.2f offset 0.4, 0 font ',9'\n",
              at[k], at[k], model + 1, at[k], at[k], 0.98 - 0.05 * model);
  }
}

/* A column of the table over the size, a line a representation. */
static void write_curves(FILE *to, const char *title, const char *column) {
  fprintf(to, "set datafile separator ','\nset title '%s'\nset ylabel '%s'\nplot", title, column);
  for (int i = 0; i < CLI_N_CHART_MODELS; i++) {
    const char *name = cli_chart_model_name((cli_chart_model)i);
    fprintf(to,
            "%s 'representations.csv' using (strcol('representation') eq '%s' ? column('pixels_per_triangle') : "
            "NaN):(column('%s')) with linespoints ls %d title '%s'",
            i ? ", \\\n " : "", name, column, i + 1, name);
  }
  fputs("\n", to);
}

static void write_map(FILE *to, const int n_boxes[CLI_N_CHART_MODELS], const double range[2]) {
  const char *comma = "";
  fprintf(to,
          "unset datafile\nset title 'fastest within an error'\nset ylabel 'rmse allowed'\nset yrange [%.6g:%.6g]\n"
          "set style fill solid 0.7 noborder\nplot",
          range[0], range[1]);
  for (int i = 0; i < CLI_N_CHART_MODELS; i++) {
    if (n_boxes[i] == 0)
      continue;
    fprintf(to, "%s $cheapest_%d using 1:2:3:4:5:6 with boxxyerror ls %d title '%s'", comma, i, i + 1,
            cli_chart_model_name((cli_chart_model)i));
    comma = ", \\\n ";
  }
  fputs("\nset yrange [*:*]\n", to);
}

conic_status cli_mesh_chart_write_script(cli_session *session, const char *folder, const cli_mesh_chart *chart) {
  conic_output *output;
  int n_boxes[CLI_N_CHART_MODELS];
  double range[2];
  conic_status status = cli_chart_open(session, folder, "representations.gp", &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  find_chart_errors(chart, range);
  for (int i = 0; i < CLI_N_CHART_MODELS; i++)
    n_boxes[i] = write_boxes(to, chart, i, range);
  write_style(to, chart);
  for (int is_png = 0; is_png < 2; is_png++) {
    fprintf(to, "set terminal %s size 1500,520 font 'Sans,%d'\nset output 'representations.%s'\n",
            is_png ? "pngcairo" : "svg enhanced", is_png ? 10 : 12, is_png ? "png" : "svg");
    fprintf(to, "set multiplot layout 1,3 title 'a mesh of %zu triangles'\n", chart->n_triangles);
    write_crossings(to, chart);
    write_curves(to, "time; dashed: as fast as triangles", "ms");
    fputs("unset arrow\nunset label\nunset key\n", to); /* the colours are the same */
    write_curves(to, "error against the mesh, 4 × 4 samples a pixel", "rmse");
    write_map(to, n_boxes, range);
    fputs("unset multiplot\nset output\nset key bottom right opaque\n", to);
  }
  return conic_output_commit(output);
}
