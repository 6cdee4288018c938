/* The chart of representations: its table, and what is printed. */
#include <math.h>
#include <stdio.h>

#include "bench/chart_mesh.h"

static void write_line(FILE *to, const cli_mesh_chart *chart, int model, int i_size) {
  const cli_mesh_size *size = &chart->sizes[i_size];
  const cli_mesh_point *p = &chart->points[model][i_size];
  cli_chart_write_quoted(to, chart->path ? chart->path : "terrain");
  fprintf(to, ",%zu,%s,%.4g,%d,%d,%.4g,%zu,%.4f,%.4f", chart->n_triangles, cli_chart_model_name((cli_chart_model)model),
          size->pixels_per_triangle, size->edge, size->edge, size->zoom, p->primitives, p->ms, p->lod_ms);
  cli_chart_write_error(to, &p->error);
  fprintf(to, ",%zu,%d\n", p->holes, p->is_front);
}

static void write_table(FILE *to, const void *cookie) {
  const cli_mesh_chart *chart = cookie;
  fputs("mesh,triangles,representation,pixels_per_triangle,width,height,zoom,primitives,ms,lod_ms,max,rmse,psnr,flip,"
        "holes,front\n",
        to);
  for (int model = 0; model < CLI_N_CHART_MODELS; model++)
    for (int i = 0; i < chart->n_sizes; i++)
      write_line(to, chart, model, i);
}

conic_status cli_mesh_chart_write(const cli_session *session, const char *folder, const cli_mesh_chart *chart) {
  conic_status status = cli_chart_put(session, folder, "representations.csv", write_table, chart);
  return status == CONIC_OK ? cli_chart_put(session, folder, "representations.svg", cli_mesh_chart_draw, chart)
                            : status;
}

int cli_mesh_chart_crossings(const cli_mesh_chart *chart, int model, double at[CLI_MAX_MESH_SIZES]) {
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
    int n = cli_mesh_chart_crossings(chart, model, at);
    printf("  %-10s", cli_chart_model_name((cli_chart_model)model));
    for (int k = 0; k < n; k++)
      printf("%s %.2g", k ? "," : " at", at[k]);
    int is_faster = chart->points[model][0].ms < chart->points[CLI_CHART_TRIANGLES][0].ms;
    puts(n ? " px a triangle" : is_faster ? " nowhere, but faster" : " nowhere, but slower");
  }
}
