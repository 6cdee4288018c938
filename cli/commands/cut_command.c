/* conic cut: makes a cloud from a part of a cloud in a file or on a web server. */
#include <strings.h>

#include "cli/command.h"
#include "cli/commands/build_steps.h"
#include "cli/cut_region.h"
#include "cli/points/points_input.h"
#include "core/files/file.h"
#include "core/formats/las_write.h"

/* The stages by their numbers. */
enum { READ, WORK, WRITE };

typedef struct cut_job {
  cli_build base;
  cli_cut_region region;
  conic_layers_region part;
  conic_layers_options building;
  const char *polygons, *keep; /* keep: which values are kept; null: all */
  double memory_mib, cutoff;
  int is_layered, is_las; /* the output is a .lpc, or a .las */

  conic_splats_writer *writer;
  conic_layers_builder *builder;
  conic_las_writer *las; /* without any output, points are only counted */
  unsigned fields;
  uint64_t n_in, n_out;
} cut_job;

static conic_status write_kept(cut_job *job, const conic_splats *kept) {
  if (job->builder)
    return conic_layers_builder_append(job->builder, kept);
  if (job->las)
    return conic_las_writer_append(job->las, kept);
  return job->writer ? conic_splats_writer_append(job->writer, kept) : CONIC_OK;
}

static conic_status take_cut_batch(void *cookie, const conic_splats *batch) {
  cut_job *job = cookie;
  conic_splats kept;
  conic_status status = cli_cut_take(job->base.session->context, &job->region, batch, &kept);
  if (status != CONIC_OK)
    return status;
  job->n_in += batch->count;
  job->n_out += kept.count;
  if (kept.count > 0) {
    job->fields |= conic_splats_fields(&kept);
    status = write_kept(job, &kept);
  }
  conic_splats_release(job->base.session->context, &kept);
  return status;
}

/* The names of the kept values; null: none. */
static const char *kept_names(const cut_job *job) {
  return !job->keep ? "all" : strcmp(job->keep, "none") == 0 ? NULL : job->keep;
}

/* A COPC on disk is also a LAZ, which holds more about its points. */
static int is_in_layers(const cut_job *job) {
  const char *path = job->base.input;
  int wants_more = job->base.where || (job->keep && kept_names(job));
  int is_las = conic_file_has_ending(path, "laz") && wants_more && job->part.error == 0.0;
  return conic_layers_is_url(path) || conic_layers_is_file(path) || (conic_layers_is_hierarchy(path) && !is_las);
}

/* Opens a layered cloud, with the wanted part. */
static conic_status open_cut_layers(const cut_job *job, conic_layers **layers) {
  conic_status status =
      cli_points_open(job->base.session, job->base.input, (uint64_t)(job->memory_mib * 1048576.0), layers);
  if (status == CONIC_OK && job->base.where)
    status = conic_layers_choose(*layers, NULL, job->base.where, NULL);
  return status;
}

static conic_status stream_part(cut_job *job) {
  conic_context *context = job->base.session->context;
  conic_read_options options;
  conic_layers *layers = NULL;
  job->n_in = job->n_out = 0;
  if (is_in_layers(job)) {
    conic_status status = open_cut_layers(job, &layers);
    if (status == CONIC_OK)
      status = conic_layers_read_samples(layers, (float)job->cutoff, &job->part, take_cut_batch, job);
    conic_layers_close(layers);
    return status;
  }
  cli_build_reading(&job->base, &options);
  options.cutoff = (float)job->cutoff;
  options.keep = kept_names(job);
  return conic_model_stream(context, job->base.input, &options, take_cut_batch, job);
}

/* Reads for the first time; *end is when that ended. */
static conic_status read_part(cut_job *job, double *end) {
  double start = cli_seconds();
  conic_status status = stream_part(job);
  *end = cli_build_end_stage(&job->base.stages[READ], start);
  if (status == CONIC_OK && job->n_out == 0)
    return conic_fail(job->base.session->context, CONIC_ERROR_INPUT,
                      "%s: nothing of it lies in the part that is asked for", job->base.input);
  return status;
}

/* A PLY begins with the number of its points, so they are read twice. */
static conic_status cut_to_ply(cut_job *job) {
  conic_write_options options;
  conic_write_options_init(&options);
  options.cutoff = (float)job->cutoff;
  double start;
  conic_status status = read_part(job, &start);
  if (status == CONIC_OK)
    status = cli_points_find_epsg(job->base.session, job->base.input, 0, &options.epsg);
  if (status == CONIC_OK)
    status = conic_splats_writer_open(job->base.session->context, job->base.output, (size_t)job->n_out, job->fields,
                                      &options, &job->writer);
  if (status == CONIC_OK)
    status = stream_part(job);
  if (status == CONIC_OK)
    status = conic_splats_writer_finish(job->writer);
  else
    conic_splats_writer_abandon(job->writer);
  cli_build_end_stage(&job->base.stages[WRITE], start);
  return status;
}

/* Keeps the samples of a .lpc on its grid. */
static conic_status plan_to_layers(cut_job *job) {
  conic_layers *layers;
  job->building.memory_bytes = (uint64_t)(job->memory_mib * 1048576.0);
  job->building.cutoff = (float)job->cutoff;
  unsigned epsg;
  conic_status status = cli_points_find_epsg(job->base.session, job->base.input, 0, &epsg);
  job->building.epsg = epsg;
  if (status != CONIC_OK || !conic_layers_is_file(job->base.input))
    return status;
  status = conic_layers_open(job->base.session->context, job->base.input, NULL, &layers);
  if (status == CONIC_OK)
    conic_layers_continue(layers, &job->building);
  conic_layers_close(layers);
  return status;
}

static conic_status cut_to_layers(cut_job *job) {
  conic_status status = plan_to_layers(job);
  if (status == CONIC_OK)
    status = conic_layers_builder_open(job->base.session->context, job->base.output, &job->building, &job->builder);
  if (status != CONIC_OK)
    return status;
  double start;
  status = read_part(job, &start);
  if (status == CONIC_OK)
    status = conic_layers_builder_finish(job->builder, NULL);
  else
    conic_layers_builder_abandon(job->builder);
  cli_build_end_stage(&job->base.stages[WRITE], start);
  return status;
}

/* The header of a LAS is written again at the end. */
static conic_status cut_to_las(cut_job *job) {
  conic_context *context = job->base.session->context;
  conic_georeference reference;
  conic_status status = cli_points_find_reference(job->base.session, job->base.input, &reference);
  if (status == CONIC_OK) {
    status = conic_las_writer_open(context, job->base.output, job->base.input, &reference, &job->las);
    conic_georeference_release(context, &reference);
  }
  if (status != CONIC_OK)
    return status;
  double start;
  status = read_part(job, &start);
  status = conic_las_writer_end(job->las, status);
  cli_build_end_stage(&job->base.stages[WRITE], start);
  return status;
}

static int make_cut(void *cookie) {
  cut_job *job = cookie;
  conic_status status = CONIC_OK;
  status = cli_build_know(&job->base, cli_build_facts_of_file(&job->base, job->base.input));
  if (status == CONIC_OK && job->polygons)
    status = cli_cut_read_polygons(job->base.session->context, job->polygons, &job->region);
  memcpy(job->part.low, job->region.low, sizeof job->part.low);
  memcpy(job->part.high, job->region.high, sizeof job->part.high);
  job->part.keep = kept_names(job);
  if (status == CONIC_OK)
    status = job->is_layered ? cut_to_layers(job) : job->is_las ? cut_to_las(job) : cut_to_ply(job);
  return cli_exit_of(status);
}

static void tell_cut(const void *cookie) {
  const cut_job *job = cookie;
  conic_log(job->base.session->context, CONIC_LOG_INFO, "%s: %llu points of %llu that were read", job->base.output,
            (unsigned long long)job->n_out, (unsigned long long)job->n_in);
}

static void report_cut(cli_json *json, const void *cookie) {
  const cut_job *job = cookie;
  const conic_repairs none = {0};
  cli_json_counts(json, NULL, {"points_in", job->n_in}, {"points_out", job->n_out});
  cli_build_report_cost(json, &job->base, "points_per_s", (double)job->n_in / job->base.stages[READ].seconds);
  cli_json_skipped(json, &none);
}

static void release_cut(void *cookie) {
  cut_job *job = cookie;
  cli_cut_region_release(job->base.session->context, &job->region);
}

static int check_cut(cut_job *job, const char *const *inputs, int n_inputs) {
  if (n_inputs != 1)
    return cli_usage("cut: %s; see conic help cut", n_inputs ? "one input at a time" : "no input given");
  job->base.input = inputs[0];
  if (!job->base.output)
    return cli_usage("cut: no output given (-o OUT.ply, OUT.lpc or OUT.las)");
  job->is_layered = conic_file_has_ending(job->base.output, "lpc");
  job->is_las = conic_file_has_ending(job->base.output, "las");
  if (strcmp(job->base.input, "-") == 0)
    return cli_usage("cut: standard input cannot be read twice; give a file");
  if (job->part.error > 0.0 && !is_in_layers(job))
    return cli_usage("cut: --error is of clouds in levels: .lpc, COPC, EPT and Potree");
  const char *own = conic_file_ending(job->base.output);
  int is_written = job->is_layered || job->is_las || strcasecmp(own, "ply") == 0;
  return cli_build_check(&job->base, inputs, 1, is_written ? own : "ply, .lpc or .las");
}

static int run_cut(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_cut, tell_cut, report_cut, release_cut};
  cut_job job = {.base = {session, .stages = {{"read"}, {"work"}, {"write"}}}, .memory_mib = 512.0, .cutoff = 1.5};
  const char *positional[argc];
  int n_positional;
  cli_cut_region_init(&job.region);
  conic_layers_region_init(&job.part);
  conic_layers_options_init(&job.building);
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT", "the file to write: .ply, .lpc or .las"},
      {"box", CLI_PARSED, &job.region, "X0,Y0,Z0,X1,Y1,Z1",
       "what lies in a box, or on its sides; X0,Y0,X1,Y1 for all heights", .parse = cli_cut_parse_box},
      {"polygon", CLI_TEXT, &job.polygons, "FILE",
       "what lies in polygons, seen from above: lines of x and y, an empty line between two polygons"},
      CLI_WHERE(&job.base.where),
      {"keep", CLI_TEXT, &job.keep, "NAMES",
       "which values of the points are written: intensity,gps_time, all or none [all; of COPC, EPT and Potree none]"},
      {"error", CLI_NUMBER, &job.part.error, "E",
       "of clouds in levels: no finer than this, in the unit of the points [0: all points]", 0, 1e15},
      {"memory", CLI_NUMBER, &job.memory_mib, "MIB", "what reading, and building a .lpc, may take in memory [512]", 16,
       1e9, .acts.is_work = 1},
      {"cutoff", CLI_NUMBER, &job.cutoff, "F", "the --cutoff of the pictures to come [1.5]", 0.25, 5,
       .acts.with = "o=.lpc"},
      CLI_READING(session, &job.base),
      CLI_WAITING(session),
  };
  int exit_code =
      cli_build_arguments(&job.base, options, sizeof options / sizeof *options, argc, argv, positional, &n_positional);
  if (exit_code == CLI_DONE)
    exit_code = check_cut(&job, positional, n_positional);
  return cli_build_run(&job, &steps, exit_code);
}

const cli_command cli_cut = {
    .name = "cut",
    .summary = "takes a part out of a cloud, from a file or a web server",
    .usage = "conic cut CLOUD -o OUT [--box X0,Y0,Z0,X1,Y1,Z1] [--polygon FILE] [--where CONDITION] [--error E]",
    .run = run_cut,
    .description = "Of clouds in levels (.lpc, COPC, EPT, Potree) no more is read than meets the box. A .ply is read "
                   "twice, since it says first how many points it has.",
    .examples = {{"the ground of a square kilometre, from a web server",
                  "conic cut https://example.org/country.copc.laz --box 635000,848000,636000,849000 -o part.ply"}},
};
