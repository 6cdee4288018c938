/* conic csg: joins two closed surfaces of splats, intersects them, or takes one from the other. */
#include "cli/command.h"
#include "cli/commands/build_steps.h"
#include "cli/points/points_input.h"
#include "core/splats/repairs_log.h"

static const char *const operation_names[] = {"union", "intersection", "difference", NULL};

typedef struct csg_job {
  cli_build base;
  const char *inputs[2];
  int is_wanted[3]; /* by conic_csg_operation */
  conic_csg_operation operation;
  conic_estimate_options estimate;
  double cutoff;

  conic_model models[2];
  conic_repairs repairs[2];
  conic_splats result;
  conic_csg_report report;
} csg_job;

enum { READ, ESTIMATE, WORK, WRITE };

static conic_status read_solids(csg_job *job) {
  conic_read_options options;
  cli_build_reading(&job->base, &options);
  options.cutoff = job->estimate.cutoff;
  conic_status status = CONIC_OK;
  for (int i = 0; i < 2 && status == CONIC_OK; i++) {
    job->base.input = job->inputs[i];
    status = cli_points_read(job->base.session, job->inputs[i], &options, &job->models[i]);
    if (status == CONIC_OK)
      status = cli_build_leave_far(&job->base, &job->models[i].points);
  }
  return status == CONIC_OK
             ? cli_build_know(&job->base, cli_build_facts(&job->models[0]) | cli_build_facts(&job->models[1]) |
                                              (conic_layers_is_url(job->inputs[0]) ? CLI_FACT(URL) : 0))
             : status;
}

static int make_solid(void *cookie) {
  csg_job *job = cookie;
  conic_context *context = job->base.session->context;
  cli_stage *stages = job->base.stages;
  double start = cli_seconds();
  conic_status status = read_solids(job);
  start = cli_build_end_stage(&stages[READ], start);
  for (int i = 0; i < 2 && status == CONIC_OK; i++)
    status = conic_model_to_splats(context, &job->estimate, &job->models[i], &job->repairs[i]);
  start = cli_build_end_stage(&stages[ESTIMATE], start);
  if (status == CONIC_OK)
    status = conic_splats_csg(context, &job->models[0].points, &job->models[1].points, job->operation,
                              job->estimate.cutoff, &job->result, &job->report);
  start = cli_build_end_stage(&stages[WORK], start);
  if (status == CONIC_OK && job->result.count == 0) {
    cli_error(CLI_INPUT, "%s, %s: nothing is left of the %s", job->inputs[0], job->inputs[1],
              operation_names[job->operation]);
    status = CONIC_ERROR_INPUT;
  }
  if (status == CONIC_OK)
    status = cli_points_write(job->base.session, job->inputs[0], job->base.output, job->estimate.cutoff, &job->result);
  cli_build_end_stage(&stages[WRITE], start);
  return cli_exit_of(status);
}

static void report_solid(cli_json *json, const void *cookie) {
  const csg_job *job = cookie;
  const conic_csg_report *report = &job->report;
  size_t n_in = job->models[0].points.count + job->models[1].points.count;
  cli_json_text(json, "operation", operation_names[job->operation]);
  cli_json_counts(json, NULL, {"points_in", n_in}, {"points_out", job->result.count}, {"of_first", report->n_kept[0]},
                  {"of_second", report->n_kept[1]}, {"clipped", report->n_clipped}, {"unclipped", report->n_unclipped});
  cli_build_report_cost(json, &job->base, "points_per_s", (double)n_in / job->base.stages[WORK].seconds);
}

static void tell_solid(const void *cookie) {
  const csg_job *job = cookie;
  const conic_csg_report *report = &job->report;
  conic_log(job->base.session->context, CONIC_LOG_INFO,
            "%zu splats of %s and %zu of %s; %zu are clipped where the surfaces meet", report->n_kept[0],
            job->inputs[0], report->n_kept[1], job->inputs[1], report->n_clipped);
  for (int i = 0; i < 2; i++)
    conic_repairs_log(job->base.session->context, job->inputs[i], &job->repairs[i]);
  if (report->n_unclipped)
    conic_log(job->base.session->context, CONIC_LOG_WARNING,
              "%zu splats at the seam are not clipped there: they have clip lines of their own", report->n_unclipped);
}

static void release_solids(void *cookie) {
  csg_job *job = cookie;
  conic_context *context = job->base.session->context;
  for (int i = 0; i < 2; i++)
    conic_model_release(context, &job->models[i]);
  conic_splats_release(context, &job->result);
}

static int check_job(csg_job *job, const char *const *positional, int n_positional) {
  int n_wanted = 0;
  for (int i = 0; i < 3; i++)
    if (job->is_wanted[i]) {
      job->operation = (conic_csg_operation)i;
      n_wanted++;
    }
  if (n_positional != 2)
    return cli_usage("csg: two inputs are joined, and not %d; see conic help csg", n_positional);
  if (n_wanted != 1)
    return cli_usage("csg: give one of --union, --intersection and --difference");
  for (int i = 0; i < 2; i++)
    job->inputs[i] = positional[i];
  job->estimate.cutoff = (float)job->cutoff;
  int exit_code = cli_build_take_paths(&job->base, positional[0], "ply");
  return exit_code == CLI_DONE ? cli_build_check(&job->base, job->inputs, 2, "ply") : exit_code;
}

static int run_csg(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_solid, tell_solid, report_solid, release_solids};
  csg_job job = {.base = {session, .stages = {{"read"}, {"estimate"}, {"work"}, {"write"}}}};
  const char *positional[argc];
  int n_positional;
  conic_estimate_options_init(&job.estimate);
  job.cutoff = (double)job.estimate.cutoff;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.ply", "the file to write"},
      {"union", CLI_FLAG, &job.is_wanted[CONIC_CSG_UNION], NULL, "what is in either"},
      {"intersection", CLI_FLAG, &job.is_wanted[CONIC_CSG_INTERSECTION], NULL, "what is in both"},
      {"difference", CLI_FLAG, &job.is_wanted[CONIC_CSG_DIFFERENCE], NULL, "what is in A and not in B"},
      {"k", CLI_INT, &job.estimate.n_neighbours, "K",
       "neighbours that a raw point's size is estimated from, 6 to 64 [20]", 6, 64,
       .acts = {.on = CLI_FACT(RAW), .is_warned = 1}},
      {"cutoff", CLI_NUMBER, &job.cutoff, "F", "the --cutoff of the pictures to come [1.5]", 0.25, 5},
      CLI_READING(session, &job.base),
      CLI_WAITING(session),
  };
  int exit_code =
      cli_build_arguments(&job.base, options, sizeof options / sizeof *options, argc, argv, positional, &n_positional);
  return cli_build_run(&job, &steps, exit_code == CLI_DONE ? check_job(&job, positional, n_positional) : exit_code);
}

const cli_command cli_csg = {
    .name = "csg",
    .summary = "joins two solids of points, intersects them, or takes one from the other",
    .usage = "conic csg A B -o OUT.ply --union|--intersection|--difference",
    .run = run_csg,
    .description =
        "A and B are closed surfaces of splats, points or meshes, whose normals point outwards. Splats of each stay "
        "where they are needed, and get clip lines where the surfaces meet, so that the seam is sharp.",
    .examples = {{"drill a hole", "conic csg block.ply drill.ply --difference -o drilled.ply"}},
};
