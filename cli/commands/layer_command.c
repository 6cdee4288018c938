/* conic layer: samples in, of any number; a layered point cloud out. */
#include <string.h>
#include <sys/stat.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "cli/tell.h"
#include "conic/layers.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/splats/repairs_log.h"

typedef struct layer_job {
  cli_session *session;
  const char *const *inputs;
  int n_inputs;
  const char *output;
  conic_layers_options options;
  conic_estimate_options estimate;
  int cloud_size;
  double memory_mib, cutoff;
  cli_length quantum;

  conic_layers_builder *builder;
  conic_layers_statistics statistics;
  const char *input; /* that is being read */
  int may_read_again, has_begun, is_raw, is_counting;
  int has_points, has_colors; /* of all inputs up to here */
  uint64_t n_points;
  conic_repairs repairs;
} layer_job;

/* Estimating from the whole file takes about so much. */
static const double estimate_bytes_a_point = 250.0;

/* Of several inputs some may have colours; where the first has, what has none is white, as in pictures. */
static conic_status append(layer_job *job, const conic_splats *batch) {
  conic_context *context = job->session->context;
  if (!job->has_points)
    job->has_colors = batch->color[0] != NULL;
  job->has_points = 1;
  if (!batch->color[0] == !job->has_colors)
    return conic_layers_builder_append(job->builder, batch);
  if (!job->has_colors)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: has colours, and what comes before it has none: name it first",
                      job->input);
  float *white = conic_memory_allocate(context, batch->count, sizeof *white);
  if (!white)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < batch->count; i++)
    white[i] = 1.0f;
  conic_splats colored = *batch;
  for (int channel = 0; channel < 3; channel++)
    colored.color[channel] = white;
  conic_status status = conic_layers_builder_append(job->builder, &colored);
  conic_memory_release(context, white);
  return status;
}

/* Points without normals and axes: where the whole file fits into memory, they are estimated from it, as elsewhere; the
 * others get their normals while the cloud is built. */
static conic_status take_batch(void *cookie, const conic_splats *batch) {
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
  return append(job, batch);
}

static conic_status read_whole(layer_job *job, const conic_read_options *options) {
  conic_context *context = job->session->context;
  conic_repairs repairs;
  conic_model model;
  conic_status status = conic_model_read(context, job->input, options, &model);
  if (status != CONIC_OK)
    return status;
  status = conic_model_to_splats(context, &job->estimate, &model, &repairs);
  if (status == CONIC_OK)
    conic_repairs_log(job->session->context, job->input, &repairs);
  if (status == CONIC_OK)
    status = append(job, &model.points);
  conic_model_release(context, &model);
  return status;
}

static conic_status read_raw(layer_job *job, const conic_read_options *options) {
  conic_context *context = job->session->context;
  job->n_points = 0;
  job->is_counting = 1;
  conic_status status = conic_model_stream(context, job->input, options, take_batch, job);
  job->is_counting = job->may_read_again = 0;
  if (status != CONIC_OK)
    return status;
  if ((double)job->n_points * estimate_bytes_a_point <= (double)job->options.memory_bytes)
    return read_whole(job, options);
  return conic_model_stream(context, job->input, options, take_batch, job);
}

static conic_status read_inputs(layer_job *job) {
  conic_status status = CONIC_OK;
  conic_read_options options;
  conic_read_options_init(&options);
  options.cutoff = job->options.cutoff;
  for (int i = 0; i < job->n_inputs && status == CONIC_OK; i++) {
    struct stat found;
    job->input = job->inputs[i];
    job->has_begun = job->is_raw = 0;
    job->may_read_again = strcmp(job->input, "-") != 0 && stat(job->input, &found) == 0 && S_ISREG(found.st_mode);
    status = conic_model_stream(job->session->context, job->input, &options, take_batch, job);
    if (job->is_raw)
      status = read_raw(job, &options);
  }
  return status;
}

static int write_statistics(layer_job *job, double total_seconds) {
  int exit_code = CLI_DONE;
  const conic_layers_statistics *s = &job->statistics;
  cli_json_file *file;
  cli_json *json = cli_json_open(job->session, &file, &exit_code);
  if (!json)
    return exit_code;
  cli_json_count(json, "points_in", s->n_in);
  cli_json_count(json, "points_out", s->n_samples);
  cli_json_count(json, "clouds", s->n_clouds);
  cli_json_count(json, "levels", (uint64_t)s->n_levels);
  cli_json_count(json, "bytes", s->n_bytes);
  cli_json_number(json, "bits_per_sample", 8.0 * (double)s->n_bytes / (double)s->n_samples);
  cli_json_number(json, "spacing", s->spacing);
  cli_json_number(json, "quantum", s->quantum);
  cli_json_object(json, "seconds");
  cli_json_number(json, "read", s->read_seconds);
  cli_json_number(json, "work", s->work_seconds);
  cli_json_number(json, "write", s->write_seconds);
  cli_json_number(json, "total", total_seconds);
  cli_json_close(json);
  cli_json_number(json, "points_per_s", (double)s->n_in / total_seconds);
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
  job->repairs.nan = (size_t)s->n_nan;
  job->repairs.zero = (size_t)s->n_zero;
  cli_json_skipped(json, &job->repairs);
  return cli_json_finish(file);
}

static void tell(const layer_job *job, double total_seconds) {
  const conic_layers_statistics *s = &job->statistics;
  const cli_stage stages[] = {{"read", s->read_seconds}, {"work", s->work_seconds}, {"write", s->write_seconds}};
  conic_log(job->session->context, CONIC_LOG_INFO,
            "%s: %llu points in; %llu samples in %llu clouds and %d levels out, %.1f MiB; a sample every %.4g, in "
            "steps of %.4g",
            job->output, (unsigned long long)s->n_in, (unsigned long long)s->n_samples, (unsigned long long)s->n_clouds,
            s->n_levels, (double)s->n_bytes / 1048576.0, s->spacing, s->quantum);
  if (s->n_in > s->n_samples || s->n_zero)
    conic_log(job->session->context, CONIC_LOG_INFO,
              "%s: left out %llu points, %llu of them not finite or farther out than 1e15; %llu without a normal or "
              "size got one",
              job->output, (unsigned long long)(s->n_in - s->n_samples), (unsigned long long)s->n_nan,
              (unsigned long long)s->n_zero);
  cli_tell_run(job->session, stages, 3, total_seconds);
}

static int run_job(layer_job *job) {
  double start = cli_seconds();
  int exit_code = cli_session_open(job->session);
  if (exit_code != CLI_DONE)
    return exit_code;
  conic_status status = conic_layers_builder_open(job->session->context, job->output, &job->options, &job->builder);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  status = read_inputs(job);
  if (status == CONIC_OK)
    status = conic_layers_builder_finish(job->builder, &job->statistics);
  else
    conic_layers_builder_abandon(job->builder);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  double total_seconds = cli_seconds() - start;
  tell(job, total_seconds);
  return write_statistics(job, total_seconds);
}

static int check_arguments(layer_job *job) {
  if (job->n_inputs == 0)
    return cli_usage("layer: no input given; see conic help layer");
  if (!job->output)
    return cli_usage("layer: no output given (-o OUT.lpc)");
  if (!(job->quantum.value > 0.0))
    return cli_usage("layer: --quantum must be above 0");
  job->options.cloud_size = (uint32_t)job->cloud_size;
  job->options.memory_bytes = (uint64_t)(job->memory_mib * 1048576.0);
  job->options.quantum = job->quantum.value;
  job->options.quantum_in_spacings = job->quantum.is_in_spacings;
  job->options.cutoff = job->estimate.cutoff = (float)job->cutoff;
  int exit_code = cli_check_ending(job->output, "lpc");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(job->session, &job->output, 1);
  return exit_code == CLI_DONE ? cli_check_inputs_stay(job->session, job->inputs, job->n_inputs, &job->output, 1)
                               : exit_code;
}

static int run(cli_session *session, int argc, char **argv) {
  layer_job job = {.session = session, .cloud_size = 2048, .memory_mib = 1024.0, .cutoff = 1.5, .quantum = {0.5, 1}};
  const char *positional[argc];
  conic_estimate_options_init(&job.estimate);
  conic_layers_options_init(&job.options);
  const cli_option options[] = {
      {.name = "o", .type = CLI_TEXT, .value = &job.output, .argument = "OUT.lpc", .help = "the file to write"},
      {.name = "cloud-size",
       .type = CLI_INT,
       .value = &job.cloud_size,
       .argument = "M",
       .help = "samples that a cloud has about, 64 to 32768 [2048]",
       .minimum = 64,
       .maximum = 32768},
      {.name = "memory",
       .type = CLI_NUMBER,
       .value = &job.memory_mib,
       .argument = "MIB",
       .help = "what building may take; what does not fit goes to files beside the output [1024]",
       .minimum = 64,
       .maximum = 1e9},
      {.name = "quantum",
       .type = CLI_PARSED,
       .value = &job.quantum,
       .parse = cli_parse_length,
       .argument = "Q",
       .help = "steps that positions are rounded to, world units or, with x, sampling distances [0.5x]"},
      {.name = "cutoff",
       .type = CLI_NUMBER,
       .value = &job.cutoff,
       .argument = "F",
       .help = "standard deviations at which a splat ends; that of the pictures [1.5]",
       .minimum = 0.25,
       .maximum = 5},
      {.name = "k",
       .type = CLI_INT,
       .value = &job.estimate.n_neighbours,
       .argument = "K",
       .help = "neighbours that raw points' normals are estimated from, 6 to 64 [20]",
       .minimum = 6,
       .maximum = 64},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &job.n_inputs);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  job.inputs = positional;
  exit_code = check_arguments(&job);
  return exit_code == CLI_DONE ? run_job(&job) : exit_code;
}

const cli_command cli_layer = {
    .name = "layer",
    .summary = "builds a layered point cloud: samples of any number, for pictures in bounded memory",
    .usage = "conic layer IN… -o OUT.lpc [--cloud-size M] [--memory MIB] [--quantum Q]",
    .run = run,
};
