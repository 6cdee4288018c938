/* The chart of a Gaussian scene as a table, as JSON, and as a picture. */

#include "bench/chart_gaussians.h"
#include "bench/plot.h"

static void write_profiles(FILE *to, const void *cookie) {
  const cli_gaussian_chart *chart = cookie;
  fputs("profile,ms,ms_setup,ms_sort,ms_bin,ms_composite,drawn,entries,pairs", to);
  for (int i = 0; i < chart->n_truths; i++)
    fprintf(to, ",%s_max,%s_rmse,%s_psnr,%s_front", cli_truth_names[i], cli_truth_names[i], cli_truth_names[i],
            cli_truth_names[i]);
  fputs("\n", to);
  for (int k = 0; k < chart->n_points; k++) {
    const cli_profile_point *p = &chart->points[k];
    const conic_gaussian_statistics *s = &p->statistics;
    fprintf(to, "%s,%.4f,%.4f,%.4f,%.4f,%.4f,%zu,%zu,%zu", conic_gaussian_profile_name(p->profile), p->ms,
            1e3 * s->seconds_setup, 1e3 * s->seconds_sort, 1e3 * s->seconds_bin, 1e3 * s->seconds_composite,
            s->gaussians_drawn, s->entries, (size_t)s->pairs);
    for (int i = 0; i < chart->n_truths; i++)
      fprintf(to, ",%.6g,%.6g,%.3f,%d", p->errors[i].max, p->errors[i].rmse, p->errors[i].psnr, p->errors[i].is_front);
    fputs("\n", to);
  }
}

/* A panel a truth: the error of every profile over its time. */
static void draw_profiles(FILE *to, const void *cookie) {
  const cli_gaussian_chart *chart = cookie;
  const cli_plot_grid grid = {chart->n_truths, chart->n_truths, 560, 440, CONIC_N_GAUSSIAN_PROFILES + 2};
  cli_plot plot;
  char title[96];
  snprintf(title, sizeof title, "%zu Gaussians, %d pixels compared", chart->n_gaussians, chart->n_pixels);
  cli_plot_begin(&plot, to, title, &grid);
  for (int i = 0; i < chart->n_truths; i++) {
    cli_plot_axis x = {"ms a frame", 1, 0.0, 0.0}, y = {"RMSE", 1, 0.0, 0.0};
    for (int k = 0; k < chart->n_points; k++) {
      cli_plot_include(&x, chart->points[k].ms);
      cli_plot_include(&y, chart->points[k].errors[i].rmse);
    }
    snprintf(title, sizeof title, "against the truth by %s", cli_truth_names[i]);
    cli_plot_panel(&plot, title, &x, &y);
    for (int k = 0; k < chart->n_points; k++) {
      const cli_profile_point *p = &chart->points[k];
      const cli_plot_style style = cli_plot_style_of(k);
      cli_plot_mark(&plot, &style, p->ms, p->errors[i].rmse, 6.0, conic_gaussian_profile_name(p->profile));
    }
  }
  cli_plot_key(&plot, NULL, "profile");
  for (int k = 0; k < chart->n_points; k++) {
    const cli_plot_style style = cli_plot_style_of(k);
    cli_plot_key(&plot, &style, conic_gaussian_profile_name(chart->points[k].profile));
  }
  cli_plot_end(&plot);
}

conic_status cli_gaussian_chart_write(cli_session *session, const char *folder, const cli_gaussian_chart *chart) {
  conic_status status = cli_chart_put(session, folder, "profiles.csv", write_profiles, chart);
  return status == CONIC_OK ? cli_chart_put(session, folder, "profiles.svg", draw_profiles, chart) : status;
}

void cli_gaussian_chart_print(const cli_gaussian_chart *chart) {
  printf("%zu Gaussians, %d pixels compared\n%-14s %9s %10s", chart->n_gaussians, chart->n_pixels, "profile", "ms",
         "M pairs");
  for (int i = 0; i < chart->n_truths; i++)
    printf("  %s: %-9s %-9s %-7s", cli_truth_names[i], "max", "rmse", "psnr");
  puts("");
  for (int k = 0; k < chart->n_points; k++) {
    const cli_profile_point *p = &chart->points[k];
    printf("%-14s %9.2f %10.3f", conic_gaussian_profile_name(p->profile), p->ms, 1e-6 * (double)p->statistics.pairs);
    for (int i = 0; i < chart->n_truths; i++)
      printf("  %*s  %-9.3g %-9.3g %6.2f%s", (int)sizeof "overlap" - 1 - (i == 1), "", p->errors[i].max,
             p->errors[i].rmse, p->errors[i].psnr, p->errors[i].is_front ? "*" : " ");
    puts("");
  }
  puts("* best for its time");
}

void cli_gaussian_chart_report(cli_json *json, const cli_gaussian_chart *chart) {
  cli_json_count(json, "truth_pixels", (uint64_t)chart->n_pixels);
  cli_json_array(json, "profiles");
  for (int k = 0; k < chart->n_points; k++) {
    const cli_profile_point *p = &chart->points[k];
    cli_json_object(json, NULL);
    cli_json_text(json, "profile", conic_gaussian_profile_name(p->profile));
    cli_json_number(json, "ms", p->ms);
    cli_json_count(json, "pairs", p->statistics.pairs);
    for (int i = 0; i < chart->n_truths; i++) {
      cli_json_object(json, cli_truth_names[i]);
      cli_json_figures(json, NULL, {"max", p->errors[i].max}, {"rmse", p->errors[i].rmse}, {"psnr", p->errors[i].psnr},
                       {"quadrature", chart->quadrature[i]});
      cli_json_close(json);
    }
    cli_json_close(json);
  }
  cli_json_close(json);
}
