/* The pictures of the chart of methods: an error over the time of a frame, a panel a scene. */

#include "bench/chart_methods.h"
#include "bench/plot.h"

/* A picture: its title, and whether its errors are against the surface. */
typedef struct figure {
  const char *title, *error;
  int against_truth, is_log; /* errors span decades */
} figure;

static const figure figures[] = {
    {"Error against the exact kernel over time: larger marks have larger cutoffs", "RMSE against the exact kernel", 0,
     1},
    {"Error against the surface over time: larger marks have larger cutoffs", "RMSE against the surface", 1, 0},
};

enum { N_KERNEL_TYPES = 4 };

static const cli_plot_style front_style = {.color = "#999999", .is_line = 1, .is_dashed = 1};

/* A colour a method, a shape a kernel. */
static cli_plot_style point_style(const cli_chart_point *point) {
  cli_plot_style style = cli_plot_style_of((int)point->method);
  style.shape = (cli_plot_shape)point->kernel.type;
  return style;
}

static void draw_best(cli_plot *plot, const figure *f, const cli_chart_scene *scene, const cli_chart_point *points,
                      int n_points) {
  double best[n_points + 1][2];
  int n = 0;
  for (int i = 0; i < n_points; i++)
    if (points[i].scene == scene && points[i].is_front[f->against_truth]) {
      best[n][0] = points[i].ms;
      best[n++][1] = cli_chart_error_of(&points[i], f->against_truth)->rmse;
    }
  cli_plot_front(plot, &front_style, n, best);
}

static void draw_chart_point(cli_plot *plot, const cli_plot_style *style, const cli_chart_point *point, double error,
                             double radius) {
  char tip[128];
  snprintf(tip, sizeof tip, "%s, %s %g, %s: %.3g ms, %.3g", conic_method_name(point->method),
           conic_kernel_type_name(point->kernel.type), (double)point->kernel.cutoff, point->scene->name, point->ms,
           error);
  cli_plot_mark(plot, style, point->ms, error, radius, tip);
}

static void draw_scene_panel(cli_plot *plot, const figure *f, const cli_chart_scene *scene,
                             const cli_chart_point *points, int n_points) {
  cli_plot_axis x = {"ms a frame", 1, 0.0, 0.0}, y = {f->error, f->is_log, 0.0, 0.0};
  char title[96];
  for (int i = 0; i < n_points; i++) {
    const cli_chart_error *error = cli_chart_error_of(&points[i], f->against_truth);
    if (points[i].scene == scene && error->is_measured) {
      cli_plot_include(&x, points[i].ms);
      cli_plot_include(&y, error->rmse);
    }
  }
  snprintf(title, sizeof title, "%s, %zu splats", scene->name, scene->n_splats);
  cli_plot_panel(plot, title, &x, &y);
  draw_best(plot, f, scene, points, n_points);
  for (int i = 0; i < n_points; i++) {
    const cli_chart_error *error = cli_chart_error_of(&points[i], f->against_truth);
    cli_plot_style style = point_style(&points[i]);
    if (points[i].scene == scene && error->is_measured)
      draw_chart_point(plot, &style, &points[i], error->rmse, 3.0 + 1.2 * (double)points[i].kernel.cutoff);
  }
}

static void write_figure(FILE *to, const figure *f, const cli_method_chart *chart) {
  const cli_plot_grid grid = {2, CLI_N_CHART_SCENES, 460, 360, CONIC_N_METHODS + N_KERNEL_TYPES + 3};
  cli_plot plot;
  cli_plot_begin(&plot, to, f->title, &grid);
  for (int i = 0; i < CLI_N_CHART_SCENES; i++)
    draw_scene_panel(&plot, f, &cli_chart_scenes[i], chart->points, chart->n_points);
  cli_plot_key(&plot, NULL, "method");
  for (int i = 0; i < CONIC_N_METHODS; i++) {
    cli_plot_style style = cli_plot_style_of(i);
    cli_plot_key(&plot, &style, conic_method_name((conic_method)i));
  }
  cli_plot_key(&plot, NULL, "kernel");
  for (int i = 0; i < N_KERNEL_TYPES; i++) {
    cli_plot_style style = {.color = "#999999", .shape = (cli_plot_shape)i};
    cli_plot_key(&plot, &style, conic_kernel_type_name((conic_kernel_type)i));
  }
  cli_plot_key(&plot, &front_style, "best for its time");
  cli_plot_end(&plot);
}

/* Whether a point is one of those that say the most: the methods that know the tilt, with the default kernel. */
static int is_in_summary(const cli_chart_point *point) {
  return point->kernel.type == CONIC_KERNEL_GAUSS && point->kernel.cutoff == 1.5f && point->oracle.is_measured;
}

/* One panel of all scenes: a colour a method, a shape a scene. */
static void write_summary(FILE *to, const void *cookie) {
  const cli_method_chart *chart = cookie;
  const cli_chart_point *points = chart->points;
  const cli_plot_grid grid = {1, 1, 520, 350, CONIC_N_METHODS + CLI_N_CHART_SCENES + 2};
  cli_plot_axis x = {"milliseconds a frame", 1, 0.0, 0.0}, y = {"error of the colour", 1, 0.0, 0.0};
  int has_method[CONIC_N_METHODS] = {0};
  cli_plot plot;
  for (int i = 0; i < chart->n_points; i++)
    if (is_in_summary(&points[i])) {
      has_method[points[i].method] = 1;
      cli_plot_include(&x, points[i].ms);
      cli_plot_include(&y, points[i].oracle.rmse);
    }
  cli_plot_begin(&plot, to, "Time of a frame and error of its colours", &grid);
  cli_plot_panel(&plot, "", &x, &y);
  for (int i = 0; i < chart->n_points; i++) {
    cli_plot_style style = cli_plot_style_of((int)points[i].method);
    style.shape = (cli_plot_shape)(points[i].scene - cli_chart_scenes);
    if (is_in_summary(&points[i]))
      draw_chart_point(&plot, &style, &points[i], points[i].oracle.rmse, 6.0);
  }
  cli_plot_key(&plot, NULL, "method");
  for (int i = 0; i < CONIC_N_METHODS; i++) {
    cli_plot_style style = cli_plot_style_of(i);
    if (has_method[i])
      cli_plot_key(&plot, &style, conic_method_name((conic_method)i));
  }
  cli_plot_key(&plot, NULL, "scene");
  for (int i = 0; i < CLI_N_CHART_SCENES; i++) {
    cli_plot_style style = {.color = "#999999", .shape = (cli_plot_shape)i};
    cli_plot_key(&plot, &style, cli_chart_scenes[i].name);
  }
  cli_plot_end(&plot);
}

static void write_against_oracle(FILE *to, const void *chart) {
  write_figure(to, &figures[0], chart);
}

static void write_against_surface(FILE *to, const void *chart) {
  write_figure(to, &figures[1], chart);
}

conic_status cli_method_chart_draw(const cli_session *session, const char *folder, const cli_method_chart *chart) {
  conic_status status = cli_chart_put(session, folder, "chart-oracle.svg", write_against_oracle, chart);
  if (status == CONIC_OK)
    status = cli_chart_put(session, folder, "chart-scene.svg", write_against_surface, chart);
  return status == CONIC_OK ? cli_chart_put(session, folder, "chart.svg", write_summary, chart) : status;
}
