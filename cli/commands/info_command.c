/* conic info: what a file holds, and whether it is sound. */
#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/commands/hybrid_info.h"
#include "cli/commands/info_parts.h"
#include "cli/commands/layers_info.h"
#include "cli/commands/octree_info.h"
#include "cli/commands/reach.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "core/base/real.h"
#include "core/files/file.h"
#include "core/splats/clip.h"

/* What in a model cannot be drawn as it stands. */
typedef struct defects {
  size_t positions, axes, normals, colors, opacities, clips;
  const char *extent; /* why no camera can be put before it; null where one can */
} defects;

typedef struct info_job {
  const char *path;
  int is_check;
  const char *kind;
  int has_bytes;
  uint64_t bytes;
  /* of models */
  conic_model model;
  size_t n_finite;
  double minimum[3], maximum[3];
  defects found;
  /* of octrees */
  conic_octree *octree;
  conic_octree_info info;
  conic_octree_defects broken;
  /* of hybrid models */
  conic_hybrid *hybrid;
  conic_hybrid_info hybrid_info;
  conic_hybrid_defects hybrid_broken;
  /* of layered point clouds */
  int is_layered;
  conic_layers_info layers;
  conic_layers_defects layer_defects;
  /* of images */
  conic_image image;
  size_t n_wrong_samples;
  int is_sound;
} info_job;

static int parse(cli_session *session, int argc, char **argv, info_job *job) {
  const cli_option options[] = {
      {"check", CLI_FLAG, &job->is_check, NULL, "also look for what cannot be drawn"},
  };
  const char *positional[64] = {NULL};
  int n_positional = 0;
  if (argc > (int)(sizeof positional / sizeof *positional))
    return cli_usage("info: too many arguments");
  int exit_code = cli_parse(session, options, 1, argc, argv, positional, &n_positional);
  if (exit_code != CLI_DONE)
    return exit_code;
  if (n_positional != 1)
    return cli_usage("info: one file is needed; see conic help info");
  job->path = positional[0];
  if (conic_layers_is_url(job->path))
    return cli_usage("info: %s is on a web server; it takes a file", job->path);
  exit_code = cli_check_outputs(session, NULL, 0);
  return exit_code == CLI_DONE ? cli_check_inputs_stay(session, &job->path, 1, NULL, 0) : exit_code;
}

/* Told by content, so that a wrong ending does not mislead. A pipe, which can be read only once, is a model. */
static int is_exr(const char *path) {
  return conic_file_begins_with(path, "\x76\x2f\x31\x01", 4);
}

static void find_size(info_job *job) {
  struct stat found;
  if (strcmp(job->path, "-") == 0 || stat(job->path, &found) != 0 || !S_ISREG(found.st_mode))
    return;
  job->has_bytes = 1;
  job->bytes = (uint64_t)found.st_size;
}

static int is_finite_vector(float *const vector[3], size_t i) {
  return conic_is_finite(vector[0][i]) && conic_is_finite(vector[1][i]) && conic_is_finite(vector[2][i]);
}

static int is_zero_vector(float *const vector[3], size_t i) {
  return vector[0][i] == 0.0f && vector[1][i] == 0.0f && vector[2][i] == 0.0f;
}

static int is_direction(float *const vector[3], size_t i) {
  return is_finite_vector(vector, i) && !is_zero_vector(vector, i);
}

static void check_model(info_job *job) {
  const conic_splats *points = &job->model.points;
  defects *found = &job->found;
  for (size_t i = 0; i < points->count; i++) {
    found->positions += !is_finite_vector(points->position, i);
    if (points->tangent_u[0])
      found->axes += !is_direction(points->tangent_u, i) || !is_direction(points->tangent_v, i);
    if (points->normal[0])
      found->normals += !is_direction(points->normal, i);
    if (points->color[0])
      found->colors += !is_finite_vector(points->color, i);
    if (points->opacity)
      found->opacities += !(conic_is_finite(points->opacity[i]) && points->opacity[i] >= 0.0f);
  }
  for (size_t i = 0; i < points->n_clips; i++)
    for (int k = 0; k < points->clips[i].n_lines; k++)
      found->clips += !conic_clip_is_line(points->clips[i].lines[k]);
  found->extent = cli_why_out_of_reach(points);
  job->is_sound = !found->extent && found->positions + found->axes + found->normals + found->colors == 0 &&
                  found->opacities + found->clips == 0;
}

static void check_image(info_job *job) {
  size_t n_pixels = (size_t)job->image.width * (size_t)job->image.height;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) {
    const conic_plane_description *description = conic_plane_describe((conic_plane)plane);
    const float *samples = job->image.planes[plane];
    if (!samples || description->is_uint)
      continue;
    for (size_t i = 0; i < n_pixels * (size_t)description->n_channels; i++)
      job->n_wrong_samples += !conic_is_finite(samples[i]);
  }
  job->is_sound = job->n_wrong_samples == 0;
}

static int read_octree(cli_session *session, info_job *job) {
  conic_status status = conic_octree_read(session->context, job->path, &job->octree);
  if (status == CONIC_OK)
    status = conic_octree_describe(job->octree, &job->info);
  if (status == CONIC_OK && job->is_check)
    status = conic_octree_check(job->octree, &job->broken);
  const conic_octree_defects *broken = &job->broken;
  job->kind = "cot";
  job->is_sound = broken->ellipses + broken->spheres + broken->cones + broken->errors + broken->splats == 0;
  return cli_exit_of(status);
}

static int read_hybrid(cli_session *session, info_job *job) {
  conic_status status = conic_hybrid_read(session->context, job->path, &job->hybrid);
  if (status == CONIC_OK)
    status = conic_hybrid_describe(job->hybrid, &job->hybrid_info);
  if (status == CONIC_OK && job->is_check)
    status = conic_hybrid_check(job->hybrid, &job->hybrid_broken);
  const conic_hybrid_defects *broken = &job->hybrid_broken;
  job->kind = "chy";
  job->is_sound = broken->values + broken->spheres + broken->cones + broken->levels == 0;
  return cli_exit_of(status);
}

static int read_layers(cli_session *session, info_job *job) {
  conic_status status = conic_layers_describe(session->context, job->path, &job->layers);
  if (status == CONIC_OK && job->is_check)
    status = conic_layers_check(session->context, job->path, &job->layer_defects);
  job->kind = "lpc";
  job->is_layered = 1;
  job->is_sound = cli_layers_are_sound(&job->layer_defects);
  return cli_exit_of(status);
}

static int has_image(const info_job *job) {
  return job->image.width > 0;
}

static int read_file(cli_session *session, info_job *job) {
  int is_image = is_exr(job->path);
  find_size(job);
  if (conic_octree_is_file(job->path))
    return read_octree(session, job);
  if (conic_hybrid_is_file(job->path))
    return read_hybrid(session, job);
  if (conic_layers_is_file(job->path))
    return read_layers(session, job);
  conic_status status = is_image ? conic_image_read(session->context, job->path, &job->image)
                                 : conic_model_read(session->context, job->path, NULL, &job->model);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  job->kind = is_image ? "exr" : conic_model_kind_name(job->model.kind);
  if (!has_image(job))
    job->n_finite = conic_splats_bounds(&job->model.points, job->minimum, job->maximum);
  if (job->is_check && has_image(job))
    check_image(job);
  else if (job->is_check)
    check_model(job);
  return CLI_DONE;
}

typedef struct field_name {
  unsigned field;
  const char *name;
} field_name;

static const field_name field_names[] = {{CONIC_SPLATS_TANGENTS, "axes"},
                                         {CONIC_SPLATS_NORMALS, "normals"},
                                         {CONIC_SPLATS_COLORS, "colors"},
                                         {CONIC_SPLATS_OPACITIES, "opacities"},
                                         {CONIC_SPLATS_CLIPS, "clip lines"}};
enum { N_FIELDS = sizeof field_names / sizeof *field_names };

static void print_model(const info_job *job) {
  const conic_model *model = &job->model;
  unsigned fields = conic_splats_fields(&model->points);
  printf("points     %zu\n", model->points.count);
  if (model->n_triangles)
    printf("triangles  %zu\n", model->n_triangles);
  printf("fields     positions");
  for (int i = 0; i < N_FIELDS; i++)
    if (fields & field_names[i].field)
      printf(", %s", field_names[i].name);
  putchar('\n');
  if (job->n_finite)
    cli_bounds_print(job->minimum, job->maximum);
  if (!job->is_check)
    return;
  const defects *found = &job->found;
  printf("sound      %s\n", job->is_sound ? "yes" : "no");
  if (found->extent)
    printf("  cannot be drawn: %s\n", found->extent);
  const size_t counts[] = {found->positions, found->axes,      found->normals,
                           found->colors,    found->opacities, found->clips};
  static const char *const what[] = {"positions that are not finite",
                                     "axes that are zero or not finite",
                                     "normals that are zero or not finite",
                                     "colours that are not finite",
                                     "opacities that are negative or not finite",
                                     "clip lines that are not finite or have no direction"};
  for (int i = 0; i < 6; i++)
    if (counts[i])
      printf("  %zu %s\n", counts[i], what[i]);
}

static void print_image(const info_job *job) {
  const char *separator = "";
  printf("size       %dx%d\nplanes     ", job->image.width, job->image.height);
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (job->image.planes[plane]) {
      printf("%s%s", separator, conic_plane_describe((conic_plane)plane)->name);
      separator = ", ";
    }
  putchar('\n');
  if (job->is_check)
    printf("sound      %s\n", job->is_sound ? "yes" : "no");
  if (job->n_wrong_samples)
    printf("  %zu samples that are not finite\n", job->n_wrong_samples);
}

static int print_text(const info_job *job) {
  printf("kind       %s\n", job->kind);
  if (job->has_bytes)
    printf("bytes      %" PRIu64, job->bytes);
  uint64_t n_points = job->octree       ? job->info.n_points
                      : job->is_layered ? job->layers.n_samples
                                        : job->model.points.count;
  if (job->has_bytes && n_points)
    printf(" (%.1f a point)", (double)job->bytes / (double)n_points);
  if (job->has_bytes)
    putchar('\n');
  if (job->octree)
    cli_octree_print(&job->info, job->is_check ? &job->broken : NULL);
  else if (job->hybrid)
    cli_hybrid_print(&job->hybrid_info, job->is_check ? &job->hybrid_broken : NULL);
  else if (job->is_layered)
    cli_layers_print(&job->layers, job->is_check ? &job->layer_defects : NULL);
  else if (has_image(job))
    print_image(job);
  else
    print_model(job);
  if (fflush(stdout) != 0 || ferror(stdout))
    return cli_error(CLI_RESOURCE, "-: cannot write: %s", strerror(errno));
  return CLI_DONE;
}

static void report_model(cli_json *json, const info_job *job) {
  const conic_model *model = &job->model;
  unsigned fields = conic_splats_fields(&model->points);
  cli_json_count(json, "points", model->points.count);
  if (model->n_triangles)
    cli_json_count(json, "triangles", model->n_triangles);
  if (job->has_bytes && model->points.count)
    cli_json_number(json, "bytes_per_point", (double)job->bytes / (double)model->points.count);
  cli_json_array(json, "fields");
  for (int i = 0; i < N_FIELDS; i++)
    if (fields & field_names[i].field)
      cli_json_text(json, NULL, field_names[i].name);
  cli_json_close(json);
  if (job->n_finite) {
    cli_bounds_report(json, job->minimum, job->maximum);
  }
  if (!job->is_check)
    return;
  cli_json_object(json, "defects");
  cli_json_count(json, "positions", job->found.positions);
  cli_json_count(json, "axes", job->found.axes);
  cli_json_count(json, "normals", job->found.normals);
  cli_json_count(json, "colors", job->found.colors);
  cli_json_count(json, "opacities", job->found.opacities);
  cli_json_count(json, "clips", job->found.clips);
  if (job->found.extent)
    cli_json_text(json, "extent", job->found.extent);
  cli_json_close(json);
}

static void report_image(cli_json *json, const info_job *job) {
  cli_json_count(json, "width", (uint64_t)job->image.width);
  cli_json_count(json, "height", (uint64_t)job->image.height);
  cli_json_array(json, "planes");
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (job->image.planes[plane])
      cli_json_text(json, NULL, conic_plane_describe((conic_plane)plane)->name);
  cli_json_close(json);
}

static int report(cli_session *session, const info_job *job) {
  cli_json_file *file;
  int exit_code = CLI_DONE;
  cli_json *json = cli_json_open(session, &file, &exit_code);
  if (!json)
    return exit_code;
  cli_json_text(json, "kind", job->kind);
  if (job->has_bytes)
    cli_json_count(json, "bytes", job->bytes);
  if (job->octree)
    cli_octree_report(json, &job->info, job->is_check ? &job->broken : NULL);
  else if (job->hybrid)
    cli_hybrid_report(json, &job->hybrid_info, job->is_check ? &job->hybrid_broken : NULL);
  else if (job->is_layered)
    cli_layers_report(json, &job->layers, job->is_check ? &job->layer_defects : NULL);
  else if (has_image(job))
    report_image(json, job);
  else
    report_model(json, job);
  if (job->is_check)
    cli_json_bool(json, "sound", job->is_sound);
  return cli_json_finish(file);
}

static int run(cli_session *session, int argc, char **argv) {
  info_job job;
  memset(&job, 0, sizeof job);
  job.path = "-"; /* until the arguments name one */
  int exit_code = parse(session, argc, argv, &job);
  if (exit_code == CLI_DONE)
    exit_code = cli_session_open(session);
  if (exit_code == CLI_DONE) {
    int is_text_wanted = !session->json_path || strcmp(session->json_path, "-") != 0;
    exit_code = read_file(session, &job);
    if (exit_code == CLI_DONE && is_text_wanted)
      exit_code = print_text(&job);
    if (exit_code == CLI_DONE)
      exit_code = report(session, &job);
    conic_model_release(session->context, &job.model);
    conic_image_release(session->context, &job.image);
    conic_octree_destroy(job.octree);
    conic_hybrid_destroy(job.hybrid);
  }
  return exit_code < 0 ? CLI_DONE : exit_code;
}

const cli_command cli_info = {"info", "says what a file holds, and whether it is sound",
                              "conic info FILE [--check] [--json -]", run};
