/* conic layer: samples in, of any number; a layered point cloud out. */
#include <string.h>

#include "cli/command.h"
#include "cli/commands/build_coloring.h"
#include "cli/commands/build_steps.h"
#include "cli/commands/points_input.h"
#include "conic/layers_draw.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/files/disk.h"
#include "core/splats/repairs_log.h"

typedef struct layer_job {
  cli_build base; /* its input is the one that is being read */
  const char *const *inputs;
  int n_inputs;
  conic_layers_options options;
  conic_estimate_options estimate;
  cli_coloring coloring;
  int cloud_size;
  double memory_mib, cutoff;
  cli_length quantum;
  int is_quantum_given, is_appending, is_merging, payload;
  const char *keep;
  char *continued; /* the values of the files that go on, as --keep has them; null: they have none */

  conic_layers_builder *builder;
  conic_layers_statistics statistics;
  int may_read_again, has_begun, is_raw, is_counting;
  int has_points, has_colors; /* of all inputs up to here */
  uint64_t n_points;
} layer_job;

static const char *const payload_words[] = {"plain", "full", NULL};
enum { PLAIN, FULL };

/* Estimating from the whole file takes about so much. */
static const double estimate_bytes_a_point = 250.0;

/* Of several inputs some may have colours; where the first has, what has none is white, as in pictures. */
static conic_status append_colored(layer_job *job, const conic_splats *batch) {
  conic_context *context = job->base.session->context;
  if (!job->has_points)
    job->has_colors = batch->color[0] != NULL;
  job->has_points = 1;
  conic_status status = cli_build_check_reach(&job->base, batch);
  if (status != CONIC_OK)
    return status;
  if (!batch->color[0] == !job->has_colors)
    return conic_layers_builder_append(job->builder, batch);
  if (!job->has_colors)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: has colours, and what comes before it has none: name it first",
                      job->base.input);
  float *white = conic_memory_allocate(context, batch->count, sizeof *white);
  if (!white)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < batch->count; i++)
    white[i] = 1.0f;
  conic_splats colored = *batch;
  for (int channel = 0; channel < 3; channel++)
    colored.color[channel] = white;
  status = conic_layers_builder_append(job->builder, &colored);
  conic_memory_release(context, white);
  return status;
}

/* A batch's arrays are the reader's: colours go with a copy. */
static conic_status append_layer_batch(layer_job *job, const conic_splats *batch) {
  conic_context *context = job->base.session->context;
  conic_splats own;
  struct conic_point_values *values = batch->values;
  if (!job->coloring.options.by)
    return append_colored(job, batch);
  conic_status status = conic_splats_allocate(context, 0, conic_splats_fields(batch), &own);
  if (status != CONIC_OK)
    return status;
  memcpy(own.origin, batch->origin, sizeof own.origin);
  status = conic_splats_append(context, &own, batch);
  if (status == CONIC_OK)
    status = conic_drawing_color(context, &job->coloring.options, &own, NULL, &job->coloring.done);
  own.values = values;
  if (status == CONIC_OK)
    status = append_colored(job, &own);
  own.values = NULL;
  conic_splats_release(context, &own);
  return status;
}

/* Points without normals and axes: where the whole file fits into memory, they are estimated from it, as elsewhere; the
 * others get their normals while the cloud is built. */
static conic_status take_layer_batch(void *cookie, const conic_splats *batch) {
  layer_job *job = cookie;
  int is_raw = !batch->tangent_u[0] && !batch->normal[0];
  job->n_points += batch->count;
  if (job->is_counting)
    return CONIC_OK;
  if (is_raw && !job->has_begun && job->may_read_again) {
    job->is_raw = 1;
    return CONIC_ERROR_CANCELLED;
  }
  job->has_begun = 1;
  return append_layer_batch(job, batch);
}

static conic_status read_whole_file(layer_job *job, const conic_read_options *options) {
  conic_context *context = job->base.session->context;
  conic_repairs repairs;
  conic_model model;
  conic_status status = cli_points_read(context, job->base.input, options, &model);
  if (status != CONIC_OK)
    return status;
  cli_build_hint_faces(&job->base, &model);
  status = conic_model_to_splats(context, &job->estimate, &model, &repairs);
  if (status == CONIC_OK)
    conic_repairs_log(job->base.session->context, job->base.input, &repairs);
  if (status == CONIC_OK)
    status = append_layer_batch(job, &model.points);
  conic_model_release(context, &model);
  return status;
}

static conic_status read_raw(layer_job *job, const conic_read_options *options) {
  conic_context *context = job->base.session->context;
  job->n_points = 0;
  job->is_counting = 1;
  conic_status status = cli_points_stream(context, job->base.input, options, take_layer_batch, job);
  job->is_counting = job->may_read_again = 0;
  if (status != CONIC_OK)
    return status;
  if ((double)job->n_points * estimate_bytes_a_point <= (double)job->options.memory_bytes)
    return read_whole_file(job, options);
  return cli_points_stream(context, job->base.input, options, take_layer_batch, job);
}

static conic_status read_inputs(layer_job *job) {
  conic_status status = CONIC_OK;
  conic_read_options options;
  conic_read_options_init(&options);
  options.cutoff = job->options.cutoff;
  cli_coloring_read(&job->coloring, &options);
  status = cli_coloring_find_range(job->base.session, &job->coloring, job->inputs, job->n_inputs, &options);
  options.columns = job->base.columns;
  options.where = job->base.where;
  options.keep = job->keep;
  for (int i = 0; i < job->n_inputs && status == CONIC_OK; i++) {
    conic_disk_entry found;
    job->base.input = job->inputs[i];
    job->has_begun = job->is_raw = 0;
    job->may_read_again =
        strcmp(job->base.input, "-") != 0 && conic_disk_look(job->base.input, &found) && found.is_file;
    status = cli_points_stream(job->base.session->context, job->base.input, &options, take_layer_batch, job);
    if (job->is_raw)
      status = read_raw(job, &options);
  }
  return status;
}

static void report_layers(cli_json *json, const void *cookie) {
  const layer_job *job = cookie;
  const conic_layers_statistics *s = &job->statistics;
  const conic_repairs repairs = {.nan = (size_t)s->n_nan, .zero = (size_t)s->n_zero};
  cli_json_count(json, "points_in", s->n_in);
  cli_json_count(json, "points_out", s->n_samples);
  cli_json_count(json, "clouds", s->n_clouds);
  cli_json_count(json, "levels", (uint64_t)s->n_levels);
  cli_json_count(json, "bytes", s->n_bytes);
  cli_json_number(json, "bits_per_sample", 8.0 * (double)s->n_bytes / (double)s->n_samples);
  cli_json_number(json, "spacing", s->spacing);
  cli_json_number(json, "quantum", s->quantum);
  cli_color_report(json, &job->coloring.done);
  cli_build_report_seconds(json, &job->base, "points_per_s", (double)s->n_in / job->base.total_seconds);
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
  cli_json_skipped(json, &repairs);
}

static void tell_layers(const void *cookie) {
  const layer_job *job = cookie;
  const conic_layers_statistics *s = &job->statistics;
  conic_log(job->base.session->context, CONIC_LOG_INFO,
            "%s: %llu points in; %llu samples in %llu clouds and %d levels out, %.1f MiB; a sample every %.4g, in "
            "steps of %.4g",
            job->base.output, (unsigned long long)s->n_in, (unsigned long long)s->n_samples,
            (unsigned long long)s->n_clouds, s->n_levels, (double)s->n_bytes / 1048576.0, s->spacing, s->quantum);
  if (s->n_in > s->n_samples || s->n_zero)
    conic_log(job->base.session->context, CONIC_LOG_INFO,
              "%s: left out %llu points, %llu of them not finite or farther out than 1e15; %llu without a normal or "
              "size got one",
              job->base.output, (unsigned long long)(s->n_in - s->n_samples), (unsigned long long)s->n_nan,
              (unsigned long long)s->n_zero);
}

/* A batch of a .lpc that goes on: it is as it was, and its colours too. */
static conic_status take_old_samples(void *cookie, const conic_splats *batch) {
  return append_colored(cookie, batch);
}

static conic_status open_layers_input(layer_job *job, const char *path, conic_layers **layers) {
  conic_layers_access access;
  conic_layers_access_init(&access);
  access.memory_bytes = job->options.memory_bytes / 2;
  job->base.input = path;
  return conic_layers_open(job->base.session->context, path, &access, layers);
}

/* The values of a file that goes on become those of all. */
static conic_status take_value_names(layer_job *job, const conic_layers *layers) {
  conic_context *context = job->base.session->context;
  conic_model_field field;
  size_t n = 0, room = 0;
  for (size_t i = 0; conic_layers_value(layers, i, &field); i++)
    room += strlen(field.name) + 2;
  if (room == 0)
    return CONIC_OK;
  job->continued = conic_memory_allocate(context, room, 1);
  if (!job->continued)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; conic_layers_value(layers, i, &field); i++)
    n += (size_t)snprintf(job->continued + n, room - n, "%s%s", i ? "," : "", field.name);
  job->keep = job->continued;
  return CONIC_OK;
}

/* Whether the values of a file are those of the first one, in any order. */
static conic_status check_value_names(const layer_job *job, const conic_layers *layers, const conic_layers *first) {
  const conic_layers *pairs[2][2] = {{first, layers}, {layers, first}};
  for (int k = 0; k < 2; k++) {
    conic_model_field field, other;
    for (size_t i = 0; conic_layers_value(pairs[k][0], i, &field); i++) {
      int is_there = 0;
      for (size_t j = 0; !is_there && conic_layers_value(pairs[k][1], j, &other); j++)
        is_there = strcmp(field.name, other.name) == 0 && strcmp(field.type, other.type) == 0;
      if (!is_there)
        return conic_fail(job->base.session->context, CONIC_ERROR_INPUT,
                          "%s: its samples have other values by name than those of %s: '%s' (%s) is in one alone",
                          job->base.input, job->inputs[0], field.name, field.type);
    }
  }
  return CONIC_OK;
}

/* The .lpc files that go on: the output, or all inputs. The grid is the first one's. */
static conic_status plan_to_continue(layer_job *job, const char *const *paths, int n_paths) {
  conic_layers_options first = job->options;
  conic_layers *opened = NULL; /* the first */
  conic_status status = CONIC_OK;
  for (int i = 0; i < n_paths && status == CONIC_OK; i++) {
    conic_layers *layers;
    status = open_layers_input(job, paths[i], &layers);
    if (status != CONIC_OK)
      break;
    conic_layers_continue(layers, &job->options);
    if (i == 0)
      first = job->options;
    else if (memcmp(first.up, job->options.up, sizeof first.up) != 0) /* what not all say is not known */
      memset(first.up, 0, sizeof first.up);
    first.is_unoriented = job->options.is_unoriented;
    first.keeps_all = job->options.keeps_all;
    status = i == 0 ? take_value_names(job, layers) : check_value_names(job, layers, opened);
    if (i == 0)
      opened = layers;
    else
      conic_layers_close(layers);
  }
  conic_layers_close(opened);
  if (status == CONIC_OK && n_paths)
    job->options = first;
  return status;
}

static conic_status read_layers(layer_job *job, const char *const *paths, int n_paths) {
  conic_status status = CONIC_OK;
  conic_layers_region all;
  conic_layers_region_init(&all);
  all.keep = job->continued;
  for (int i = 0; i < n_paths && status == CONIC_OK; i++) {
    conic_layers *layers;
    status = open_layers_input(job, paths[i], &layers);
    if (status != CONIC_OK)
      break;
    status = conic_layers_read_samples(layers, job->options.cutoff, &all, take_old_samples, job);
    conic_layers_close(layers);
  }
  return status;
}

/* What points up: as is said, or as in the files that go on, or as surveys have it; else nobody knows. */
static void settle_up(layer_job *job, int n_layers) {
  static const double survey_up[3] = {0.0, 0.0, 1.0};
  if (job->coloring.is_up_given)
    memcpy(job->options.up, job->coloring.options.up, sizeof job->options.up);
  else if (n_layers == 0 && cli_points_are_surveys(job->inputs, job->n_inputs))
    memcpy(job->options.up, survey_up, sizeof job->options.up);
}

static int make_layers(void *cookie) {
  layer_job *job = cookie;
  const char *const *layers = job->is_merging ? job->inputs : &job->base.output;
  int n_layers = job->is_merging ? job->n_inputs : job->is_appending ? 1 : 0;
  conic_status status = plan_to_continue(job, layers, n_layers);
  settle_up(job, n_layers);
  if (status == CONIC_OK)
    status = conic_layers_builder_open(job->base.session->context, job->base.output, &job->options, &job->builder);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  status = read_layers(job, layers, n_layers);
  if (status == CONIC_OK && !job->is_merging)
    status = read_inputs(job);
  if (status == CONIC_OK)
    status = conic_layers_builder_finish(job->builder, &job->statistics);
  else
    conic_layers_builder_abandon(job->builder);
  job->base.stages[0].seconds = job->statistics.read_seconds;
  job->base.stages[1].seconds = job->statistics.work_seconds;
  job->base.stages[2].seconds = job->statistics.write_seconds;
  return cli_exit_of(status);
}

static void release_layers(void *cookie) {
  layer_job *job = cookie;
  if (job->continued)
    conic_memory_release(job->base.session->context, job->continued);
}

static int check_layer_arguments(layer_job *job) {
  if (job->n_inputs == 0)
    return cli_usage("layer: no input given; see conic help layer");
  if (!job->base.output)
    return cli_usage("layer: no output given (-o OUT.lpc)");
  if (!(job->quantum.value > 0.0))
    return cli_usage("layer: --quantum must be above 0");
  if (job->is_appending && (job->is_quantum_given || job->payload == FULL || job->keep))
    return cli_usage("layer: --append adds to a file as it was built: not with --quantum, --payload or --keep");
  if (job->is_appending)
    job->base.session->replaced_path = job->base.output;
  job->options.keeps_all = job->estimate.finds_dots = job->payload == FULL;
  if (job->payload == FULL && !job->is_quantum_given)
    job->quantum = (cli_length){1.0 / 4096.0, 1};
  job->options.cloud_size = (uint32_t)job->cloud_size;
  job->options.memory_bytes = (uint64_t)(job->memory_mib * 1048576.0);
  job->options.quantum = job->quantum.value;
  job->options.quantum_in_spacings = job->quantum.is_in_spacings;
  job->options.cutoff = job->estimate.cutoff = (float)job->cutoff;
  int answer = cli_coloring_check(job->base.session, &job->coloring);
  if (answer != CLI_DONE)
    return answer;
  return cli_build_check(&job->base, job->inputs, job->n_inputs, "lpc");
}

static int run_layer(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_layers, tell_layers, report_layers, release_layers};
  layer_job job = {.base = {session, .stages = {{"read"}, {"work"}, {"write"}}},
                   .cloud_size = 2048,
                   .memory_mib = 1024.0,
                   .cutoff = 1.5,
                   .quantum = {0.5, 1}};
  const char *positional[argc];
  conic_estimate_options_init(&job.estimate);
  conic_layers_options_init(&job.options);
  cli_coloring_init(&job.coloring);
  job.coloring.keeps_up = 1;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.lpc", "the file to write"},
      {"cloud-size", CLI_INT, &job.cloud_size, "M", "about how many samples a cloud has, 64 to 32768 [2048]", 64,
       32768},
      {"memory", CLI_NUMBER, &job.memory_mib, "MIB",
       "what building may take in memory; what does not fit goes to files beside the output [1024]", 16, 1e9},
      {"quantum", CLI_PARSED, &job.quantum, "Q",
       "the steps that positions are rounded to: a length, also in spacings (2x) [0.5x; x/4096 with --payload "
       "full]",
       .parse = cli_parse_length, .is_given = &job.is_quantum_given},
      {"cutoff", CLI_NUMBER, &job.cutoff, "F", "the --cutoff of the pictures to come [1.5]", 0.25, 5},
      {"k", CLI_INT, &job.estimate.n_neighbours, "K",
       "neighbours that raw points' normals are estimated from, 6 to 64 [20]", 6, 64},
      {"payload", CLI_CHOICE, &job.payload, "WHAT",
       "what of a splat is kept: plain, its place, size, direction and colour; or full, also ellipses, opacities, dots "
       "and clip lines, and all of it finely [plain]",
       .choices = payload_words},
      {"keep", CLI_TEXT, &job.keep, "NAMES",
       "which values of the points are kept, for --color-by and --where: intensity,gps_time or all [none]"},
      {"append", CLI_FLAG, &job.is_appending, NULL,
       "add to the OUT.lpc that there is; its samples stay where they are"},
      CLI_WHERE(&job.base.where),
      CLI_COLUMNS(&job.base.columns),
      CLI_BUILD_COLOR_OPTIONS(&job.coloring),
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &job.n_inputs);
  job.inputs = positional;
  return cli_build_run(&job, &steps, exit_code == CLI_DONE ? check_layer_arguments(&job) : exit_code);
}

const cli_command cli_layer = {
    .name = "layer",
    .summary = "builds a layered point cloud: samples of any number, for pictures in bounded memory",
    .usage = "conic layer IN… -o OUT.lpc [--cloud-size M] [--memory MIB] [--quantum Q] [--payload full] [--keep NAMES] "
             "[--append]",
    .run = run_layer,
    .description =
        "Writes the samples in small clouds, coarse ones first. conic render reads only those that a picture "
        "shows, from a file or from a web server.",
    .examples = {{"join scans that do not fit into memory", "conic layer scans/*.ply -o all.lpc --memory 4096"},
                 {"keep all that a survey says of its points", "conic layer survey.las -o survey.lpc --keep all"}},
};

static int check_merge_arguments(layer_job *job) {
  if (job->n_inputs < 2)
    return cli_usage("merge: two inputs or more are needed; see conic help merge");
  if (!job->base.output)
    return cli_usage("merge: no output given (-o OUT.lpc)");
  job->options.memory_bytes = (uint64_t)(job->memory_mib * 1048576.0);
  return cli_build_check(&job->base, job->inputs, job->n_inputs, "lpc");
}

static int run_merge(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_layers, tell_layers, report_layers, release_layers};
  layer_job job = {.base = {session, .stages = {{"read"}, {"work"}, {"write"}}}, .memory_mib = 1024.0, .is_merging = 1};
  const char *positional[argc];
  conic_layers_options_init(&job.options);
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.lpc", "the file to write"},
      {"memory", CLI_NUMBER, &job.memory_mib, "MIB",
       "what building may take in memory; what does not fit goes to files beside the output [1024]", 16, 1e9},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &job.n_inputs);
  job.inputs = positional;
  return cli_build_run(&job, &steps, exit_code == CLI_DONE ? check_merge_arguments(&job) : exit_code);
}

const cli_command cli_merge = {
    .name = "merge",
    .summary = "joins layered point clouds",
    .usage = "conic merge A.lpc B.lpc… -o OUT.lpc [--memory MIB]",
    .run = run_merge,
    .description =
        "Builds one file of the samples of all, in the order given. Those of the first stay exactly where they "
        "are; those of the others move by half a step of its grid at most.",
    .examples = {{"join two surveys", "conic merge west.lpc east.lpc -o all.lpc"}},
};
