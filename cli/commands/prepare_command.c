/* conic prepare: raw points or a mesh in, splats out. */
#include <math.h>
#include <string.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "cli/tell.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/splats/repairs_log.h"

typedef struct prepare_job {
  cli_session *session;
  const char *input, *output;
  conic_estimate_options estimate;
  unsigned long long count, seed;
  int has_count;

  conic_model model;
  size_t n_in;
  conic_repairs repairs;
  double read_seconds, work_seconds, write_seconds;
} prepare_job;

/* Makes normals of a set's axes, so that its sizes can be found anew. */
static void forget_axes(conic_context *context, conic_splats *splats) {
  splats->n_clips = 0; /* lines in units of the old axes */
  for (size_t i = 0; i < splats->count; i++) {
    double u[3], v[3], normal[3], length2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      u[axis] = (double)splats->tangent_u[axis][i];
      v[axis] = (double)splats->tangent_v[axis][i];
    }
    for (int axis = 0; axis < 3; axis++) {
      normal[axis] = u[(axis + 1) % 3] * v[(axis + 2) % 3] - u[(axis + 2) % 3] * v[(axis + 1) % 3];
      length2 += normal[axis] * normal[axis];
    }
    for (int axis = 0; axis < 3; axis++)
      splats->tangent_u[axis][i] = length2 > 0.0 ? (float)(normal[axis] / sqrt(length2)) : 0.0f;
  }
  for (int axis = 0; axis < 3; axis++) {
    conic_memory_release(context, splats->normal[axis]);
    conic_memory_release(context, splats->tangent_v[axis]);
    splats->normal[axis] = splats->tangent_u[axis];
    splats->tangent_u[axis] = splats->tangent_v[axis] = NULL;
  }
}

/* Thins before the sizes are found, so that they fit what is left. Faces and axes of the whole set then only tell
 * the normals. */
static conic_status thin_model(prepare_job *job) {
  conic_context *context = job->session->context;
  conic_model *model = &job->model;
  if (!job->has_count || job->count >= model->points.count)
    return CONIC_OK;
  conic_status status = CONIC_OK;
  if (model->n_triangles || model->points.tangent_u[0]) {
    conic_estimate_options plain = job->estimate;
    plain.feature_angle_deg = 0.0;
    status = conic_model_to_splats(context, &plain, model, NULL);
    if (status != CONIC_OK)
      return status;
    forget_axes(context, &model->points);
    model->n_triangles = 0;
  }
  return conic_splats_thin(context, &model->points, (size_t)job->count, job->seed);
}

static int read_model(prepare_job *job) {
  conic_read_options options;
  conic_read_options_init(&options);
  options.cutoff = job->estimate.cutoff;
  conic_status status = conic_model_read(job->session->context, job->input, &options, &job->model);
  job->n_in = status == CONIC_OK ? job->model.points.count : 0;
  return cli_exit_of(status);
}

static int find_axes(prepare_job *job) {
  conic_status status = thin_model(job);
  if (status == CONIC_OK)
    status = conic_model_to_splats(job->session->context, &job->estimate, &job->model, &job->repairs);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  if (job->repairs.nan + job->repairs.failed >= job->model.points.count)
    return cli_error(CLI_INPUT, "%s: has no point that can be drawn", job->input);
  return CLI_DONE;
}

static int write_splats(prepare_job *job) {
  conic_write_options options;
  conic_write_options_init(&options);
  options.cutoff = job->estimate.cutoff;
  return cli_exit_of(conic_splats_write(job->session->context, job->output, &job->model.points, &options));
}

static int write_statistics(prepare_job *job, double total_seconds) {
  int exit_code = CLI_DONE;
  cli_json_file *file;
  cli_json *json = cli_json_open(job->session, &file, &exit_code);
  if (!json)
    return exit_code;
  cli_json_count(json, "points_in", job->n_in);
  cli_json_count(json, "points_out", job->model.points.count);
  cli_json_count(json, "clipped", job->model.points.n_clips);
  cli_json_object(json, "seconds");
  cli_json_number(json, "read", job->read_seconds);
  cli_json_number(json, "work", job->work_seconds);
  cli_json_number(json, "write", job->write_seconds);
  cli_json_number(json, "total", total_seconds);
  cli_json_close(json);
  cli_json_number(json, "points_per_s", (double)job->n_in / job->work_seconds);
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
  cli_json_skipped(json, &job->repairs);
  return cli_json_finish(file);
}

static void tell(const prepare_job *job, double total_seconds) {
  const cli_stage stages[] = {{"read", job->read_seconds}, {"work", job->work_seconds}, {"write", job->write_seconds}};
  const conic_splats *points = &job->model.points;
  conic_log(job->session->context, CONIC_LOG_INFO, "%s: %zu points in, %zu splats out", job->input, job->n_in,
            points->count);
  if (points->n_clips)
    conic_log(job->session->context, CONIC_LOG_INFO, "%s: %zu splats have clip lines", job->input, points->n_clips);
  conic_repairs_log(job->session->context, job->input, &job->repairs);
  cli_tell_run(job->session, stages, 3, total_seconds);
}

/* Runs one step unless an earlier one has failed, and adds what it takes to *seconds. */
static void run_step(prepare_job *job, int (*step)(prepare_job *), double *seconds, int *exit_code) {
  double begin = cli_seconds();
  if (*exit_code == CLI_DONE)
    *exit_code = step(job);
  *seconds = cli_seconds() - begin;
}

static int run_job(prepare_job *job) {
  double begin = cli_seconds();
  int exit_code = cli_session_open(job->session);
  if (exit_code != CLI_DONE)
    return exit_code;
  run_step(job, read_model, &job->read_seconds, &exit_code);
  run_step(job, find_axes, &job->work_seconds, &exit_code);
  run_step(job, write_splats, &job->write_seconds, &exit_code);
  double total_seconds = cli_seconds() - begin;
  if (exit_code == CLI_DONE)
    tell(job, total_seconds);
  if (exit_code == CLI_DONE)
    exit_code = write_statistics(job, total_seconds);
  conic_model_release(job->session->context, &job->model);
  return exit_code;
}

static int run(cli_session *session, int argc, char **argv) {
  prepare_job job = {.session = session};
  const char *positional[argc];
  int n_positional;
  conic_estimate_options_init(&job.estimate);
  const cli_option options[] = {
      {.name = "o", .type = CLI_TEXT, .value = &job.output, .argument = "OUT.ply", .help = "the file to write"},
      {.name = "k",
       .type = CLI_INT,
       .value = &job.estimate.n_neighbours,
       .argument = "K",
       .help = "neighbours that a point's ellipse comes from, 6 to 64 [20]",
       .minimum = 6,
       .maximum = 64},
      {.name = "features",
       .type = CLI_NUMBER,
       .value = &job.estimate.feature_angle_deg,
       .argument = "ANGLE",
       .help = "creases sharper than ANGLE degrees become sharp, by clip lines [none]",
       .minimum = 0,
       .maximum = 90},
      {.name = "count",
       .type = CLI_COUNT,
       .value = &job.count,
       .argument = "N",
       .help = "keep N of the points, chosen at random, and fit the sizes to them",
       .minimum = 1,
       .maximum = 4294967294.0,
       .is_given = &job.has_count},
      {.name = "seed",
       .type = CLI_COUNT,
       .value = &job.seed,
       .argument = "S",
       .help = "which choice; a smaller count is a part of a larger one [0]"},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &n_positional);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  if (n_positional != 1)
    return cli_usage("prepare: %s; see conic help prepare", n_positional ? "one input at a time" : "no input given");
  if (!job.output)
    return cli_usage("prepare: no output given (-o OUT.ply)");
  job.input = positional[0];
  exit_code = cli_check_ending(job.output, "ply");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, &job.output, 1);
  if (exit_code == CLI_DONE) /* the output may be the input: it is read whole before */
    exit_code = cli_check_inputs_stay(session, &job.input, 1, NULL, 0);
  return exit_code == CLI_DONE ? run_job(&job) : exit_code;
}

const cli_command cli_prepare = {
    .name = "prepare",
    .summary = "turns points or a mesh into splats: normals, sizes, thinning",
    .usage = "conic prepare IN -o OUT.ply [-k K] [--features ANGLE] [--count N --seed S]",
    .run = run,
};
