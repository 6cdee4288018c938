/* conic info: tells what a file holds, and whether it is sound. */
#include <inttypes.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/scene/views.h"
#include "cli/source_facts.h"
#include "core/files/disk.h"
#include "core/files/file.h"

typedef struct info_job {
  const char *path;
  int is_check;
  int is_read;
  int has_bytes;
  uint64_t bytes;
  int is_cameras, size[2]; /* is_cameras: --cameras, or the file has only cameras; size: of their pictures, by --size */
  conic_facts *facts;      /* null for an image or cameras */
  conic_cameras cameras;
  int image_size[2];
  unsigned image_planes; /* a bit for each conic_plane */
  size_t n_wrong_samples;
} info_job;

typedef struct info_files {
  info_job *jobs;
  int n;
} info_files;

static int parse(cli_session *session, int argc, char **argv, info_job *job, const char **paths, int *n_paths) {
  const cli_option options[] = {
      {"check", CLI_FLAG, &job->is_check, NULL, "also look for what cannot be drawn"},
      {"cameras", CLI_FLAG, &job->is_cameras, NULL, "of a glTF, the cameras in it, as of files of cameras alone"},
      {"size", CLI_SIZE, job->size, "WxH", "of cameras: pixels [the file's]", 1, 65535},
      CLI_OUTSIDE(session),
  };
  int exit_code = cli_parse(session, options, sizeof options / sizeof *options, argc, argv, paths, n_paths);
  if (exit_code != CLI_DONE)
    return exit_code;
  if (*n_paths == 0)
    return cli_usage("info: a file is needed; see conic help info");
  for (int i = 0; i < *n_paths; i++)
    if (conic_layers_is_url(paths[i]))
      return cli_usage("info: %s is on a web server; it takes a file", paths[i]);
  exit_code = cli_check_outputs(session, NULL, 0);
  return exit_code == CLI_DONE ? cli_check_inputs_stay(session, paths, *n_paths, NULL, 0) : exit_code;
}

/* Judges by content, so that a wrong ending does not mislead. A pipe, which can be read only once, counts as a
 * model. */
static int is_exr(const char *path) {
  return conic_file_begins_with(path, "\x76\x2f\x31\x01", 4);
}

static void find_size(info_job *job) {
  conic_disk_entry found;
  if (strcmp(job->path, "-") == 0 || !conic_disk_look(job->path, &found) || !found.is_file)
    return;
  job->has_bytes = 1;
  job->bytes = found.n_bytes;
}

static void check_image(const conic_image *image, info_job *job) {
  size_t n_pixels = (size_t)image->width * (size_t)image->height;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) {
    const conic_plane_description *description = conic_plane_describe((conic_plane)plane);
    const float *samples = image->planes[plane];
    if (!samples || description->is_uint)
      continue;
    for (size_t i = 0; i < n_pixels * (size_t)description->n_channels; i++)
      job->n_wrong_samples += samples[i] - samples[i] != 0.0f;
  }
}

/* Keeps what is told of it, not the picture: there may be many. */
static conic_status read_image(cli_session *session, info_job *job) {
  conic_image image;
  conic_status status = conic_image_read(session->context, job->path, &image);
  if (status != CONIC_OK)
    return status;
  job->image_size[0] = image.width;
  job->image_size[1] = image.height;
  job->image_planes = conic_image_planes(&image);
  if (job->is_check)
    check_image(&image, job);
  conic_image_release(session->context, &image);
  return CONIC_OK;
}

static conic_status read_cameras(cli_session *session, info_job *job) {
  conic_cameras_options options;
  conic_cameras_options_init(&options);
  options.width = job->size[0];
  options.height = job->size[1];
  return conic_cameras_read(session->context, job->path, &options, &job->cameras);
}

static conic_status read_file(cli_session *session, info_job *job) {
  find_size(job);
  job->is_cameras |= conic_cameras_is_file(session->context, job->path);
  if (job->is_cameras)
    return read_cameras(session, job);
  if (job->size[0]) {
    cli_usage("info: --size has no effect: it acts on cameras, not on %s", job->path);
    return CONIC_ERROR_ARGUMENT;
  }
  if (!is_exr(job->path))
    return conic_source_inspect(session->context, job->path, job->is_check, &job->facts);
  return read_image(session, job);
}

static void print_image(const info_job *job) {
  const char *separator = "";
  printf("size       %dx%d\nplanes     ", job->image_size[0], job->image_size[1]);
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (job->image_planes >> plane & 1u) {
      printf("%s%s", separator, conic_plane_describe((conic_plane)plane)->name);
      separator = ", ";
    }
  putchar('\n');
  if (job->is_check)
    printf("sound      %s\n", job->n_wrong_samples ? "no" : "yes");
  if (job->n_wrong_samples)
    printf("  %zu samples that are not finite\n", job->n_wrong_samples);
}

/* Of either key, the first count that is not 0; else 0. */
static uint64_t count_of(const info_job *job, const char *key, const char *other) {
  const conic_fact *fact;
  for (size_t i = 0; job->facts && (fact = conic_facts_at(job->facts, i)); i++)
    if (fact->type == CONIC_FACT_COUNT && fact->count && (strcmp(fact->key, key) == 0 || strcmp(fact->key, other) == 0))
      return fact->count;
  return 0;
}

/* The file's size over its points; 0 where either is unknown. */
static double bytes_per_point(const info_job *job) {
  const uint64_t n = count_of(job, "points", "gaussians");
  return n && job->has_bytes ? (double)job->bytes / (double)n : 0.0;
}

static void print_cameras(const info_job *job) {
  const conic_cameras *cameras = &job->cameras;
  printf("format     %s\nviews      %zu\n", conic_camera_file_name((conic_camera_file)cameras->kind), cameras->count);
  for (size_t i = 0; i < cameras->count; i++) {
    const conic_camera *c = &cameras->cameras[i];
    printf("  %-4zu %s%s%dx%d  focal %.6g %.6g  centre %.6g %.6g", i, cameras->names[i], *cameras->names[i] ? "  " : "",
           c->width, c->height, c->fx, c->fy, c->cx, c->cy);
    if (c->kind != CONIC_CAMERA_PERSPECTIVE || c->lens != CONIC_LENS_NONE)
      printf("  %s, lens %s", conic_camera_kind_name((conic_camera_kind)c->kind), conic_lens_name((conic_lens)c->lens));
    putchar('\n');
  }
  if (job->is_check)
    puts("sound      yes");
}

static void report_cameras(cli_json *json, const conic_cameras *cameras) {
  cli_json_text(json, "format", conic_camera_file_name((conic_camera_file)cameras->kind));
  cli_json_array(json, "views");
  for (size_t i = 0; i < cameras->count; i++) {
    cli_json_object(json, NULL);
    cli_json_count(json, "index", i);
    if (*cameras->names[i])
      cli_json_text(json, "name", cameras->names[i]);
    cli_json_object(json, "camera");
    cli_camera_write(json, &cameras->cameras[i]);
    cli_json_close(json);
    cli_json_close(json);
  }
  cli_json_close(json);
}

static const char *kind_of(const info_job *job) {
  return job->is_cameras ? "cameras" : job->facts ? conic_facts_at(job->facts, 0)->text : "exr";
}

static int is_sound(const info_job *job) {
  return job->facts ? cli_facts_are_sound(job->facts) : job->n_wrong_samples == 0;
}

/* A line of a table. */
static void print_row(const info_job *job) {
  printf("%-8s %14" PRIu64 " %12" PRIu64 " %12" PRIu64 "  %s%s\n", kind_of(job), job->bytes,
         count_of(job, "points", "gaussians"), count_of(job, "triangles", "faces"),
         !job->is_check  ? ""
         : is_sound(job) ? "sound  "
                         : "not sound  ",
         job->path);
}

static void print_whole(const info_job *job) {
  double share = bytes_per_point(job);
  printf("kind       %s\n", kind_of(job));
  if (job->has_bytes)
    printf("bytes      %" PRIu64, job->bytes);
  if (share > 0.0)
    printf(" (%.1f a point)", share);
  if (job->has_bytes)
    putchar('\n');
  if (job->facts)
    cli_facts_print(job->facts);
  else if (job->is_cameras)
    print_cameras(job);
  else
    print_image(job);
}

static void report_image(cli_json *json, const info_job *job) {
  cli_json_counts(json, NULL, {"width", (uint64_t)job->image_size[0]}, {"height", (uint64_t)job->image_size[1]});
  cli_json_array(json, "planes");
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (job->image_planes >> plane & 1u)
      cli_json_text(json, NULL, conic_plane_describe((conic_plane)plane)->name);
  cli_json_close(json);
}

static void report_file(cli_json *json, const info_job *job) {
  cli_json_text(json, "kind", kind_of(job));
  if (job->has_bytes)
    cli_json_count(json, "bytes", job->bytes);
  if (bytes_per_point(job) > 0.0)
    cli_json_number(json, "bytes_per_point", bytes_per_point(job));
  if (job->facts)
    cli_facts_report(json, job->facts, 1);
  else if (job->is_cameras)
    report_cameras(json, &job->cameras);
  else
    report_image(json, job);
  if (job->is_check)
    cli_json_bool(json, "sound", is_sound(job));
}

/* One file, or those of several that could be read. */
static void report(cli_json *json, const void *cookie) {
  const info_files *files = cookie;
  if (files->n == 1) {
    report_file(json, &files->jobs[0]);
    return;
  }
  cli_json_array(json, "files");
  for (int i = 0; i < files->n; i++)
    if (files->jobs[i].is_read) {
      cli_json_object(json, NULL);
      cli_json_text(json, "file", files->jobs[i].path);
      report_file(json, &files->jobs[i]);
      cli_json_close(json);
    }
  cli_json_close(json);
}

/* Of several files, what cannot be read is told, and the others go on. */
static int tell_files(cli_session *session, info_files *files) {
  const int is_text_wanted = !session->json_path || strcmp(session->json_path, "-") != 0;
  int worst = CLI_DONE;
  if (is_text_wanted && files->n > 1)
    printf("%-8s %14s %12s %12s  %s\n", "kind", "bytes", "points", "triangles", "file");
  for (int i = 0; i < files->n; i++) {
    info_job *job = &files->jobs[i];
    const int exit_code = cli_exit_of(read_file(session, job));
    job->is_read = exit_code == CLI_DONE;
    worst = exit_code > worst ? exit_code : worst;
    if (job->is_read && is_text_wanted)
      (files->n > 1 ? print_row : print_whole)(job);
  }
  if (is_text_wanted && (fflush(stdout) != 0 || ferror(stdout)))
    return cli_error(CLI_RESOURCE, "-: cannot write: %s", strerror(errno));
  const int written = worst == CLI_DONE || files->n > 1 ? cli_json_write(session, report, files) : CLI_DONE;
  return written > worst ? written : worst;
}

static int run(cli_session *session, int argc, char **argv) {
  info_job wanted;
  const char *paths[argc + 1];
  info_files files = {NULL, 0};
  memset(&wanted, 0, sizeof wanted);
  int exit_code = parse(session, argc, argv, &wanted, paths, &files.n);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  files.jobs = calloc((size_t)files.n, sizeof *files.jobs);
  if (!files.jobs)
    return cli_error(CLI_RESOURCE, "info: out of memory");
  for (int i = 0; i < files.n; i++) {
    files.jobs[i] = wanted;
    files.jobs[i].path = paths[i];
  }
  exit_code = cli_session_open(session);
  if (exit_code == CLI_DONE)
    exit_code = tell_files(session, &files);
  for (int i = 0; i < files.n; i++) {
    conic_facts_destroy(files.jobs[i].facts);
    if (session->context)
      conic_cameras_release(session->context, &files.jobs[i].cameras);
  }
  free(files.jobs);
  return exit_code;
}

const cli_command cli_info = {
    .name = "info",
    .summary = "says what a file holds, and whether it is sound",
    .usage = "conic info FILE… [--check] [--cameras] [--json -]",
    .run = run,
    .description =
        "Reads whatever conic reads: points, meshes, Gaussian scenes, pictures in EXR, files of cameras. With "
        "--check it also says whether all of it can be drawn. Of several files it prints a table.",
    .examples = {{"look for what cannot be drawn", "conic info scan.ply --check"}},
};
