/* conic diff: how two images differ, in numbers and as a picture. */
#include <math.h>
#include <string.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "core/base/message.h"

typedef struct diff_job {
  cli_session *session;
  const char *paths[2];
  const char *heatmap_path;
  int is_flip_map;
  double max_abs, min_psnr;
  int has_max_abs, has_min_psnr;

  conic_image images[2];
  conic_difference difference;
} diff_job;

/* Whether both images have a plane that max_abs looks at. */
static int has_common_values(const diff_job *job) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (job->difference.planes[i].compared && !conic_plane_describe((conic_plane)i)->is_uint)
      return 1;
  return 0;
}

/* Past a limit, or, where none is given, not identical. A limit cannot be kept by what is not there to be measured. */
static int is_different(const diff_job *job) {
  const conic_difference *difference = &job->difference;
  if (!job->has_max_abs && !job->has_min_psnr)
    return !difference->identical;
  if (!difference->same_size)
    return 1;
  if (job->has_max_abs && (!has_common_values(job) || !(difference->max_abs <= job->max_abs)))
    return 1;
  return job->has_min_psnr && (!difference->has_color || !(difference->psnr >= job->min_psnr));
}

static void write_planes(cli_json *json, const conic_difference *difference) {
  cli_json_object(json, "planes");
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    if (!difference->planes[i].compared)
      continue;
    cli_json_object(json, conic_plane_describe((conic_plane)i)->name);
    cli_json_number(json, "max_abs", difference->planes[i].max_abs);
    cli_json_number(json, "rmse", difference->planes[i].rmse);
    cli_json_number(json, "p999", difference->planes[i].p999);
    cli_json_close(json);
  }
  cli_json_close(json);
}

/* What could not be measured is not a number, which becomes null. */
static int write_statistics(const diff_job *job) {
  const conic_difference *difference = &job->difference;
  int exit_code = CLI_DONE;
  cli_json_file *file;
  cli_json *json = cli_json_open(job->session, &file, &exit_code);
  if (!json)
    return exit_code;
  int has_values = has_common_values(job);
  cli_json_bool(json, "identical", difference->identical);
  cli_json_number(json, "max_abs", has_values ? difference->max_abs : NAN);
  cli_json_number(json, "rmse", has_values ? difference->rmse : NAN);
  cli_json_number(json, "p999", has_values ? difference->p999 : NAN);
  cli_json_number(json, "psnr", difference->has_color ? difference->psnr : NAN);
  cli_json_number(json, "ssim", difference->has_color ? difference->ssim : NAN);
  cli_json_number(json, "flip", difference->has_color ? difference->flip : NAN);
  if (difference->has_color)
    cli_json_count(json, "over_code", difference->over_code);
  else
    cli_json_number(json, "over_code", NAN);
  if (difference->same_size) {
    cli_json_count(json, "differing_pixels", difference->differing_pixels);
    cli_json_count(json, "largest_hole", difference->largest_hole);
  } else {
    cli_json_number(json, "differing_pixels", NAN);
    cli_json_number(json, "largest_hole", NAN);
  }
  if (difference->has_color)
    cli_json_text(json, "color_channels", difference->lacks_alpha ? "RGB" : "RGBA");
  write_planes(json, difference);
  return cli_json_finish(file);
}

static void print_lone_planes(const diff_job *job, int which) {
  unsigned lone = conic_image_planes(&job->images[which]) & ~conic_image_planes(&job->images[1 - which]);
  if (!lone)
    return;
  printf("only in %s:", job->paths[which]);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (lone >> i & 1)
      printf(" %s", conic_plane_describe((conic_plane)i)->name);
  putchar('\n');
}

/* What of a plane was compared. */
static const char *name_of_compared(const conic_difference *difference, int plane) {
  return plane == CONIC_PLANE_RGBA && difference->lacks_alpha ? "rgb" : conic_plane_describe((conic_plane)plane)->name;
}

static void print_result(const diff_job *job) {
  const conic_difference *difference = &job->difference;
  const conic_image *a = &job->images[0], *b = &job->images[1];
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
  if (has_common_values(job))
    printf("%-17s max_abs %-12.6g rmse %-12.6g p99.9 %.6g\n", "all", difference->max_abs, difference->rmse,
           difference->p999);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (difference->planes[i].compared)
      printf("%-17s max_abs %-12.6g rmse %-12.6g p99.9 %.6g\n", name_of_compared(difference, i),
             difference->planes[i].max_abs, difference->planes[i].rmse, difference->planes[i].p999);
  print_lone_planes(job, 0);
  print_lone_planes(job, 1);
}

static conic_status write_heatmap(const diff_job *job) {
  conic_context *context = job->session->context;
  conic_image heatmap;
  if (!job->heatmap_path)
    return CONIC_OK;
  if (!job->difference.same_size) {
    conic_log(context, CONIC_LOG_WARNING, "%s: not written: the images differ in size", job->heatmap_path);
    return CONIC_OK;
  }
  if (!job->difference.has_color)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: not written: not both images have colour", job->heatmap_path);
  conic_status status = job->is_flip_map ? conic_image_flip_heatmap(context, &job->images[0], &job->images[1], &heatmap)
                                         : conic_image_heatmap(context, &job->images[0], &job->images[1], &heatmap);
  if (status != CONIC_OK)
    return status;
  status = conic_image_write(context, job->heatmap_path, &heatmap);
  conic_image_release(context, &heatmap);
  return status;
}

static conic_status compare(diff_job *job) {
  conic_context *context = job->session->context;
  conic_status status = CONIC_OK;
  if (job->heatmap_path)
    status = conic_image_check_output(context, job->heatmap_path, 1u << CONIC_PLANE_RGBA);
  for (int i = 0; i < 2 && status == CONIC_OK; i++)
    status = conic_image_read(context, job->paths[i], &job->images[i]);
  if (status == CONIC_OK)
    status = conic_image_compare(context, &job->images[0], &job->images[1], &job->difference);
  if (status == CONIC_OK)
    status = write_heatmap(job);
  return status;
}

static int run_job(diff_job *job) {
  cli_session *session = job->session;
  int exit_code = cli_session_open(session);
  if (exit_code != CLI_DONE)
    return exit_code;
  exit_code = cli_exit_of(compare(job));
  if (exit_code == CLI_DONE)
    exit_code = write_statistics(job);
  if (exit_code == CLI_DONE) {
    if (!session->is_quiet && (!session->json_path || strcmp(session->json_path, "-") != 0))
      print_result(job);
    exit_code = is_different(job) ? CLI_DIFFERENT : CLI_DONE;
  }
  for (int i = 0; i < 2; i++)
    conic_image_release(session->context, &job->images[i]);
  return exit_code;
}

static int run_diff(cli_session *session, int argc, char **argv) {
  static const char *const heatmap_words[] = {"samples", "flip", NULL};
  diff_job job = {.session = session};
  const char *positional[argc];
  int n_positional;
  const cli_option options[] = {
      {"heatmap", CLI_TEXT, &job.heatmap_path, "H.png", "write a picture of where they differ"},
      {"heatmap-of", CLI_CHOICE, &job.is_flip_map, "WHAT",
       "what it paints: samples, their largest difference; flip, what is seen of it [samples]",
       .choices = heatmap_words},
      {"max-abs", CLI_NUMBER, &job.max_abs, "X", "let no sample differ by more [identical]", 0.0, INFINITY,
       .is_given = &job.has_max_abs},
      {"min-psnr", CLI_NUMBER, &job.min_psnr, "DB",
       "let the colour's peak signal-to-noise ratio be no lower [identical]", .is_given = &job.has_min_psnr},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &n_positional);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  if (n_positional != 2)
    return cli_usage("diff: two images are needed, not %d; see conic help diff", n_positional);
  memcpy(job.paths, positional, sizeof job.paths);
  if (strcmp(job.paths[0], "-") == 0 || strcmp(job.paths[1], "-") == 0)
    return cli_usage("diff: an image cannot come from standard input");
  exit_code = cli_check_outputs(session, &job.heatmap_path, 1);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_inputs_stay(session, job.paths, 2, &job.heatmap_path, 1);
  return exit_code == CLI_DONE ? run_job(&job) : exit_code;
}

const cli_command cli_diff = {
    .name = "diff",
    .summary = "compares two images",
    .usage = "conic diff A B [--heatmap H.png] [--heatmap-of samples|flip] [--max-abs X] [--min-psnr DB]",
    .run = run_diff,
};
