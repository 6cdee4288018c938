/* conic diff: how two images, or two folders of them, differ, in numbers and as a picture. */

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/commands/diff_job.h"
#include "cli/commands/diff_shots.h"
#include "cli/outputs.h"

static void write_planes(cli_json *json, const conic_difference *difference) {
  cli_json_object(json, "planes");
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    if (!difference->planes[i].compared)
      continue;
    cli_json_figures(json, conic_plane_describe((conic_plane)i)->name, {"max_abs", difference->planes[i].max_abs},
                     {"rmse", difference->planes[i].rmse}, {"p999", difference->planes[i].p999});
  }
  cli_json_close(json);
}

static int write_statistics(const cli_diff_job *job, const conic_difference *difference, const cli_diff_shots *shots) {
  cli_json *json;
  int exit_code = cli_json_open(job->session, &json);
  if (!json)
    return exit_code;
  cli_diff_report(json, difference);
  write_planes(json, difference);
  conic_status status = cli_diff_shots_report(json, job->session, shots);
  if (status != CONIC_OK)
    exit_code = cli_exit_of(status);
  int finished = cli_json_finish(json);
  return exit_code == CLI_DONE ? finished : exit_code;
}

static void print_lone_planes(const cli_diff_job *job, const conic_image images[2], int which) {
  unsigned lone = conic_image_planes(&images[which]) & ~conic_image_planes(&images[1 - which]);
  if (!lone)
    return;
  printf("only in %s:", job->paths[which]);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (lone >> i & 1)
      printf(" %s", conic_plane_describe((conic_plane)i)->name);
  putchar('\n');
}

/* Which channels of a plane were compared. */
static const char *name_of_compared(const conic_difference *difference, int plane) {
  return plane == CONIC_PLANE_RGBA && difference->lacks_alpha ? "rgb" : conic_plane_describe((conic_plane)plane)->name;
}

static void print_result(const cli_diff_job *job, const conic_image images[2], const conic_difference *difference) {
  const conic_image *a = &images[0], *b = &images[1];
  if (!difference->same_size) {
    printf("different sizes: %dx%d and %dx%d\n", a->width, a->height, b->width, b->height);
    return;
  }
  if (difference->identical) {
    puts("identical");
    return;
  }
  printf("differing pixels  %zu of %zu\n", difference->differing_pixels, (size_t)a->width * (size_t)a->height);
  printf("largest hole      %zu\n", difference->largest_hole);
  if (difference->has_color)
    printf("over a code       %zu\npsnr              %.2f dB\nssim              %.6f\nflip              %.6f\n",
           difference->over_code, difference->psnr, difference->ssim, difference->flip);
  if (cli_diff_has_values(difference))
    printf("%-17s max_abs %-12.6g rmse %-12.6g p99.9 %.6g\n", "all", difference->max_abs, difference->rmse,
           difference->p999);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (difference->planes[i].compared)
      printf("%-17s max_abs %-12.6g rmse %-12.6g p99.9 %.6g\n", name_of_compared(difference, i),
             difference->planes[i].max_abs, difference->planes[i].rmse, difference->planes[i].p999);
  print_lone_planes(job, images, 0);
  print_lone_planes(job, images, 1);
}

static int diff_files(const cli_diff_job *job) {
  const cli_session *session = job->session;
  conic_image images[2] = {{.width = 0}, {.width = 0}};
  conic_difference difference;
  cli_diff_shots shots = {{NULL, NULL}};
  int exit_code = cli_exit_of(cli_diff_measure(job, job->paths, job->heatmap_path, 0, images, &difference));
  if (exit_code == CLI_DONE)
    exit_code = cli_exit_of(cli_diff_shots_read(session, job->paths, &shots));
  if (exit_code == CLI_DONE)
    exit_code = write_statistics(job, &difference, &shots);
  if (exit_code == CLI_DONE) {
    if (cli_json_leaves_text(session)) {
      print_result(job, images, &difference);
      cli_diff_shots_print(session, &shots);
    }
    exit_code = cli_diff_is_past(&job->limits, &difference) ? CLI_DIFFERENT : CLI_DONE;
  }
  for (int i = 0; i < 2; i++)
    conic_image_release(session->context, &images[i]);
  cli_diff_shots_release(session, &shots);
  return exit_code;
}

static int run_job(cli_diff_job *job, int is_folders) {
  int exit_code = cli_session_open(job->session);
  if (exit_code == CLI_DONE && job->heatmap_path)
    exit_code = cli_exit_of(conic_image_check_output(job->session->context, job->heatmap_path, 1u << CONIC_PLANE_RGBA));
  if (exit_code != CLI_DONE)
    return exit_code;
  return is_folders ? cli_diff_folders(job) : diff_files(job);
}

static int check_diff(const cli_diff_job *job, int is_folders) {
  const char *const outputs[] = {job->heatmap_path, job->csv_path};
  for (int i = 0; i < 2; i++) {
    if (strcmp(job->paths[i], "-") == 0)
      return cli_usage("diff: an image cannot come from standard input");
    if (cli_diff_is_many(job->paths[i]) != is_folders)
      return cli_error(CLI_INPUT, "%s: this is a directory or a pattern, and %s is neither",
                       job->paths[is_folders ? 1 - i : i], job->paths[is_folders ? i : 1 - i]);
  }
  if (!is_folders && (job->csv_path || job->match || job->is_subset))
    return cli_usage("diff: --csv, --match and --subset are for two folders");
  if (is_folders && job->heatmap_path && strcmp(job->heatmap_path, "-") == 0)
    return cli_usage("diff: heat maps of many views cannot go to standard output");
  int exit_code = cli_check_outputs(job->session, outputs, 2);
  return exit_code == CLI_DONE ? cli_check_inputs_stay(job->session, job->paths, 2, outputs, 2) : exit_code;
}

static int run_diff(cli_session *session, int argc, char **argv) {
  static const char *const heatmap_words[] = {"samples", "flip", NULL};
  static const char *const display_words[] = {"auto", "none", "a", "b", "both", NULL};
  static const char *const match_words[] = {"auto", "name", "number", "order", NULL};
  cli_diff_job job = {.session = session};
  cli_diff_limits *limits = &job.limits;
  const char *positional[argc];
  int n_positional;
  const cli_option options[] = {
      {"heatmap", CLI_TEXT, &job.heatmap_path, "H.png",
       "write a picture of where they differ; of folders H.NAME.png for each view"},
      {"heatmap-of", CLI_CHOICE, &job.is_flip_map, "WHAT",
       "what it paints: samples, their largest difference; flip, what is seen of it [samples]",
       .choices = heatmap_words, .acts.with = "heatmap"},
      {"max-abs", CLI_NUMBER, &limits->max_abs, "X", "let no sample differ by more [identical]", 0.0, INFINITY,
       .is_given = &limits->has_max_abs},
      {"min-psnr", CLI_NUMBER, &limits->min_psnr, "DB",
       "let the colour's peak signal-to-noise ratio be no lower [identical]", .is_given = &limits->has_min_psnr},
      {"min-ssim", CLI_NUMBER, &limits->min_ssim, "X", "let the structural similarity be no lower [identical]", -1.0,
       1.0, .is_given = &limits->has_min_ssim},
      {"max-flip", CLI_NUMBER, &limits->max_flip, "X", "let the mean FLIP be no higher [identical]", 0.0, 1.0,
       .is_given = &limits->has_max_flip},
      {"display", CLI_CHOICE, &job.display, "WHICH",
       "whose colours are display values: none, a, b or both [auto: as an EXR says, of itself and of a .pfm, .hdr or "
       "NumPy file beside it]",
       .choices = display_words},
      {"reduce", CLI_FLAG, &job.reduces, NULL, "bring the larger picture to the size of the other one"},
      {"match", CLI_CHOICE, &job.match, "HOW",
       "how pictures of two folders find each other: by name, number or order [auto]", .choices = match_words},
      {"subset", CLI_FLAG, &job.is_subset, NULL, "of folders: B need not have all the pictures of A"},
      {"csv", CLI_TEXT, &job.csv_path, "FILE", "of folders: write the table into a file"},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &n_positional);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  if (n_positional != 2)
    return cli_usage("diff: two images or folders are needed, not %d; see conic help diff", n_positional);
  memcpy(job.paths, positional, sizeof job.paths);
  int is_folders = cli_diff_is_many(job.paths[0]);
  exit_code = check_diff(&job, is_folders);
  return exit_code == CLI_DONE ? run_job(&job, is_folders) : exit_code;
}

const cli_command cli_diff = {
    .name = "diff",
    .summary = "compares two images, or two folders of them",
    .usage = "conic diff A B [--heatmap H.png] [--max-abs X] [--min-psnr DB] [--display WHICH] [--reduce] …",
    .run = run_diff,
    .description = "Measures how two pictures of the same size differ: the largest difference, PSNR, SSIM and FLIP. It "
                   "ends with 1 where a limit is passed or, without limits, where they are not identical.",
    .examples = {{"let two pictures differ by a little", "conic diff a.exr b.exr --max-abs 0.001"},
                 {"compare the views of two renderers", "conic diff theirs ours --min-psnr 40 --csv table.csv"}},
};
