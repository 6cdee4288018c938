/* conic diff of two folders: a table of views and means, as papers have it. */

#include "cli/commands/diff_views.h"
#include "core/files/file.h"

static const char *const match_names[] = {"", "name", "number", "order"};

/* The columns of a table that are averaged over the views. */
enum { PSNR, SSIM, SSIM_PADDED, FLIP, N_MEASURES };
static const char *const measure_names[N_MEASURES] = {"psnr", "ssim", "ssim_padded", "flip"};

static double measure_of(const conic_difference *difference, int i) {
  const double measures[N_MEASURES] = {difference->psnr, difference->ssim, difference->ssim_padded, difference->flip};
  return difference->has_color ? measures[i] : NAN;
}

/* The mean over the views with colour; NaN where there are none. */
static double mean_over_views(const cli_diff_views *views, int i) {
  double sum = 0.0, n = 0.0;
  for (size_t k = 0; k < views->n; k++) {
    if (!views->views[k].difference.has_color)
      continue;
    sum += measure_of(&views->views[k].difference, i);
    n += 1.0;
  }
  return n > 0.0 ? sum / n : NAN;
}

static size_t count_past(const cli_diff_views *views) {
  size_t n = 0;
  for (size_t i = 0; i < views->n; i++)
    n += (size_t)views->views[i].is_past;
  return n;
}

static size_t count_lone(const cli_diff_views *views, int which) {
  return views->lists[which].n - views->n;
}

static int is_identical(const cli_diff_views *views) {
  for (size_t i = 0; i < views->n; i++)
    if (!views->views[i].difference.identical)
      return 0;
  return count_lone(views, 0) == 0 && count_lone(views, 1) == 0;
}

/* --- JSON --- */

static void report_lone(cli_json *json, const char *key, const cli_diff_views *views, int which) {
  cli_json_array(json, key);
  for (size_t i = 0; i < views->lists[which].n; i++)
    if (!views->has_view[which][i])
      cli_json_text(json, NULL, views->lists[which].files[i].path);
  cli_json_close(json);
}

static void report_view(cli_json *json, const cli_diff_view *view) {
  char name[256];
  snprintf(name, sizeof name, "%.*s", view->files[0]->n_stem, view->files[0]->name);
  cli_json_object(json, NULL);
  cli_json_texts(json, NULL, {"name", name}, {"a", view->files[0]->path}, {"b", view->files[1]->path});
  cli_json_bool(json, "pass", !view->is_past);
  cli_diff_report(json, &view->difference);
  cli_json_close(json);
}

static int report_views(const cli_diff_job *job, const cli_diff_views *views) {
  cli_json *json;
  int exit_code = cli_json_open(job->session, &json);
  if (!json)
    return exit_code;
  cli_json_bool(json, "identical", is_identical(views));
  cli_json_text(json, "matched_by", match_names[views->match]);
  cli_json_count(json, "views_past_limits", count_past(views));
  cli_json_object(json, "mean");
  for (int i = 0; i < N_MEASURES; i++)
    cli_json_number(json, measure_names[i], mean_over_views(views, i));
  cli_json_close(json);
  cli_json_array(json, "views");
  for (size_t i = 0; i < views->n; i++)
    report_view(json, &views->views[i]);
  cli_json_close(json);
  report_lone(json, "only_in_a", views, 0);
  report_lone(json, "only_in_b", views, 1);
  return cli_json_finish(json);
}

/* --- CSV --- */

/* Text as in RFC 4180. */
static void write_csv_text(FILE *to, const char *text) {
  fputc('"', to);
  for (; *text; text++) {
    if (*text == '"')
      fputc('"', to);
    fputc(*text, to);
  }
  fputc('"', to);
}

static conic_status write_csv(const cli_diff_job *job, const cli_diff_views *views) {
  conic_output *output;
  conic_status status = conic_output_open(job->session->context, job->csv_path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  fputs("a,b", to);
  for (int i = 0; i < N_MEASURES; i++)
    fprintf(to, ",%s", measure_names[i]);
  fputs(",max_abs,rmse,pass\r\n", to);
  for (size_t k = 0; k < views->n; k++) {
    const cli_diff_view *view = &views->views[k];
    write_csv_text(to, view->files[0]->path);
    fputc(',', to);
    write_csv_text(to, view->files[1]->path);
    for (int i = 0; i < N_MEASURES; i++)
      fprintf(to, ",%.9g", measure_of(&view->difference, i));
    fprintf(to, ",%.9g,%.9g,%d\r\n", view->difference.max_abs, view->difference.rmse, !view->is_past);
  }
  return conic_output_commit(output);
}

/* --- the table --- */

static void print_row(const char *name, int n_name, int width, const double measures[N_MEASURES], const char *mark) {
  printf("%-*.*s %8.3f %8.5f %8.5f %8.5f%s\n", width, n_name, name, measures[PSNR], measures[SSIM],
         measures[SSIM_PADDED], measures[FLIP], mark);
}

static void print_lone_pictures(const cli_diff_job *job, const cli_diff_views *views, int which) {
  if (count_lone(views, which) == 0)
    return;
  printf("only in %s:", job->paths[which]);
  for (size_t i = 0; i < views->lists[which].n; i++)
    if (!views->has_view[which][i])
      printf(" %s", views->lists[which].files[i].name);
  putchar('\n');
}

static void print_views(const cli_diff_job *job, const cli_diff_views *views) {
  double measures[N_MEASURES];
  const cli_diff_limits *limits = &job->limits;
  int width = 12,
      has_limits = limits->has_max_abs || limits->has_min_psnr || limits->has_min_ssim || limits->has_max_flip;
  for (size_t k = 0; k < views->n; k++)
    width = views->views[k].files[0]->n_stem > width ? views->views[k].files[0]->n_stem : width;
  printf("%-*s %8s %8s %8s %8s\n", width, "view", "psnr", "ssim", "padded", "flip");
  for (size_t k = 0; k < views->n; k++) {
    const cli_diff_view *view = &views->views[k];
    for (int i = 0; i < N_MEASURES; i++)
      measures[i] = measure_of(&view->difference, i);
    print_row(view->files[0]->name, view->files[0]->n_stem, width, measures, view->is_past && has_limits ? " *" : "");
  }
  for (int i = 0; i < N_MEASURES; i++)
    measures[i] = mean_over_views(views, i);
  print_row("mean", 4, width, measures, "");
  if (has_limits && count_past(views))
    printf("* past a limit: %zu of %zu views\n", count_past(views), views->n);
  if (!has_limits && is_identical(views))
    puts("all identical");
  if (views->match != CLI_MATCH_NAME)
    printf("matched by %s: %s is %s, and so on\n", match_names[views->match], views->views[0].files[0]->path,
           views->views[0].files[1]->path);
  print_lone_pictures(job, views, 0);
  print_lone_pictures(job, views, 1);
}

/* --- the work --- */

/* "H.png" becomes "H.NAME.png"; null without memory, or if no heat map is wanted. */
static char *heatmap_name(const cli_diff_job *job, const cli_diff_file *file) {
  const char *path = job->heatmap_path;
  if (!path)
    return NULL;
  const char *name = conic_file_name(path), *dot = strrchr(name, '.'), *end = dot ? dot : path + strlen(path);
  size_t room = strlen(path) + (size_t)file->n_stem + 2;
  char *made = malloc(room);
  if (made)
    snprintf(made, room, "%.*s.%.*s%s", (int)(end - path), path, file->n_stem, file->name, end);
  return made;
}

static int measure_view(const cli_diff_job *job, cli_diff_view *view) {
  const char *const paths[2] = {view->files[0]->path, view->files[1]->path};
  conic_image images[2] = {{.width = 0}, {.width = 0}};
  char *heatmap = heatmap_name(job, view->files[0]);
  int exit_code = job->heatmap_path && !heatmap ? cli_error(CLI_RESOURCE, "diff: out of memory") : CLI_DONE;
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(cli_diff_measure(job, paths, heatmap, 1, images, &view->difference));
  for (int i = 0; i < 2; i++)
    conic_image_release(job->session->context, &images[i]);
  free(heatmap);
  view->is_past = cli_diff_is_past(&job->limits, &view->difference);
  return exit_code;
}

static int tell_views(const cli_diff_job *job, const cli_diff_views *views) {
  const char *csv = job->csv_path;
  int exit_code = csv ? cli_exit_of(write_csv(job, views)) : CLI_DONE;
  if (exit_code == CLI_DONE)
    exit_code = report_views(job, views);
  if (exit_code == CLI_DONE && cli_json_leaves_text(job->session) && !(csv && strcmp(csv, "-") == 0))
    print_views(job, views);
  return exit_code;
}

int cli_diff_folders(cli_diff_job *job) {
  cli_diff_views views;
  int exit_code = cli_diff_views_find(job, &views);
  for (size_t i = 0; i < views.n && exit_code == CLI_DONE; i++) {
    cli_session_part(job->session, "view", (int)i + 1, (int)views.n);
    exit_code = measure_view(job, &views.views[i]);
    job->is_told = 1;
  }
  if (exit_code == CLI_DONE)
    exit_code = tell_views(job, &views);
  if (exit_code == CLI_DONE &&
      (count_past(&views) || count_lone(&views, 1) || (count_lone(&views, 0) && !job->is_subset)))
    exit_code = CLI_DIFFERENT;
  cli_diff_views_release(&views);
  return exit_code;
}
