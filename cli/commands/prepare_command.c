/* conic prepare: makes splats from raw points or a mesh. */

#include "cli/commands/build_coloring.h"
#include "cli/commands/prepare_bake.h"
#include "cli/points/points_input.h"
#include "core/base/vectors.h"
#include "core/splats/repairs_log.h"

typedef struct prepare_job {
  cli_build base;
  conic_estimate_options estimate;
  cli_coloring coloring;
  unsigned long long count, seed;
  int has_count, is_plain;
  cli_bake bake;
  int n_directions;

  conic_model model;
  size_t n_in;
  conic_repairs repairs;
} prepare_job;

enum { READ, WORK, WRITE };

static int parse_ellipse(const char *text, void *value) {
  conic_ellipse_rule *rule = value;
  *rule = strcmp(text, "bounding") == 0 ? CONIC_ELLIPSE_BOUNDING : CONIC_ELLIPSE_VORONOI;
  return *rule == CONIC_ELLIPSE_BOUNDING || strcmp(text, "voronoi") == 0;
}

/* Turns a set's axes into normals, so that sizes can be estimated anew. */
static void forget_axes(conic_context *context, conic_splats *splats) {
  splats->n_clips = 0; /* lines are in units of the old axes */
  for (size_t i = 0; i < splats->count; i++) {
    double u[3], v[3], normal[3];
    conic_vector_at(splats->tangent_u, i, u);
    conic_vector_at(splats->tangent_v, i, v);
    conic_cross(u, v, normal);
    double length = conic_length(normal);
    for (int axis = 0; axis < 3; axis++)
      splats->tangent_u[axis][i] = length > 0.0 ? (float)(normal[axis] / length) : 0.0f;
  }
  for (int axis = 0; axis < 3; axis++) {
    conic_memory_release_these(context, splats->normal[axis], splats->tangent_v[axis]);
    splats->normal[axis] = splats->tangent_u[axis];
    splats->tangent_u[axis] = splats->tangent_v[axis] = NULL;
  }
}

/* Thins before sizes are estimated, so that they fit the remaining points. Faces and axes of the whole set then only
 * give the normals. */
static conic_status thin_model(prepare_job *job) {
  conic_context *context = job->base.session->context;
  conic_model *model = &job->model;
  if (!job->has_count || job->count >= model->points.count)
    return CONIC_OK;
  conic_status status = CONIC_OK;
  if (model->n_triangles || model->points.tangent_u[0]) {
    conic_estimate_options plain = job->estimate;
    plain.feature_angle_deg = 0.0;
    plain.finds_dots = 0;
    plain.stays_at_mesh = 0;
    status = conic_model_to_splats(context, &plain, model, NULL);
    if (status != CONIC_OK)
      return status;
    forget_axes(context, &model->points);
    model->n_triangles = 0;
  }
  return conic_splats_thin(context, &model->points, (size_t)job->count, job->seed);
}

static conic_status read_model(prepare_job *job) {
  conic_read_options options;
  cli_build_reading(&job->base, &options);
  options.cutoff = job->estimate.cutoff;
  cli_coloring_read(&job->coloring, &options);
  conic_status status = cli_points_read(job->base.session, job->base.input, &options, &job->model);
  job->n_in = status == CONIC_OK ? job->model.points.count : 0;
  if (status == CONIC_OK)
    status =
        cli_build_know(&job->base, cli_build_facts(&job->model) |
                                       (job->has_count && job->count < job->n_in ? CLI_FACT(RAW) : 0)); /* sized anew */
  cli_build_hint_faces(&job->base, &job->model);
  if (status == CONIC_OK)
    status = cli_build_leave_far(&job->base, &job->model.points);
  return status;
}

static conic_status find_axes(prepare_job *job) {
  job->estimate.finds_dots = !job->is_plain;
  conic_status status = thin_model(job);
  if (status == CONIC_OK)
    status = conic_model_to_splats(job->base.session->context, &job->estimate, &job->model, &job->repairs);
  if (status == CONIC_OK)
    status = cli_coloring_apply(&job->base, &job->coloring, job->model.up, &job->model.points, NULL);
  if (status != CONIC_OK)
    return status;
  if (job->repairs.nan + job->repairs.failed >= job->model.points.count) {
    cli_error(CLI_INPUT, "%s: has no point that can be drawn", job->base.input);
    return CONIC_ERROR_INPUT;
  }
  return cli_bake_splats(job->base.session->context, job->bake, job->n_directions, job->estimate.cutoff,
                         &job->model.points);
}

static int write_splats(prepare_job *job) {
  return cli_exit_of(
      cli_points_write(job->base.session, job->base.input, job->base.output, job->estimate.cutoff, &job->model.points));
}

static void report_prepared(cli_json *json, const void *cookie) {
  const prepare_job *job = cookie;
  cli_json_counts(json, NULL, {"points_in", job->n_in}, {"points_out", job->model.points.count},
                  {"clipped", job->model.points.n_clips});
  if (job->bake)
    cli_json_count(json, "baked_directions", (uint64_t)job->n_directions);
  cli_json_count(json, "dots", conic_splats_count_dots(&job->model.points));
  cli_color_report(json, &job->coloring.done);
  cli_build_report_cost(json, &job->base, "points_per_s", (double)job->n_in / job->base.stages[WORK].seconds);
  cli_json_skipped(json, &job->repairs);
}

static void tell_prepared(const void *cookie) {
  const prepare_job *job = cookie;
  const conic_splats *points = &job->model.points;
  conic_log(job->base.session->context, CONIC_LOG_INFO, "%s: %zu points in, %zu splats out", job->base.input, job->n_in,
            points->count);
  if (points->n_clips)
    conic_log(job->base.session->context, CONIC_LOG_INFO, "%s: %zu splats have clip lines", job->base.input,
              points->n_clips);
  conic_repairs_log(job->base.session->context, job->base.input, &job->repairs);
}

static int make_prepared(void *cookie) {
  prepare_job *job = cookie;
  cli_stage *stages = job->base.stages;
  double start = cli_seconds();
  cli_build_share(&job->base);
  conic_status status = read_model(job);
  start = cli_build_end_stage(&stages[READ], start);
  if (status == CONIC_OK)
    status = find_axes(job);
  status = cli_build_part(&job->base, status);
  start = cli_build_end_stage(&stages[WORK], start);
  int exit_code = cli_exit_of(status);
  if (exit_code == CLI_DONE && cli_session_speaks(job->base.session))
    exit_code = write_splats(job);
  cli_build_end_stage(&stages[WRITE], start);
  return exit_code;
}

static void release_prepared(void *cookie) {
  prepare_job *job = cookie;
  conic_model_release(job->base.session->context, &job->model);
}

static int run_prepare(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_prepared, tell_prepared, report_prepared, release_prepared};
  prepare_job job = {.base = {session, .stages = {{"read"}, {"work"}, {"write"}}}};
  conic_estimate_options_init(&job.estimate);
  cli_coloring_init(&job.coloring);
  job.estimate.stays_at_mesh = 1;
  job.n_directions = 256;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.ply", "the file to write"},
      CLI_IN_PLACE(job.base),
      {"k", CLI_INT, &job.estimate.n_neighbours, "K", "how many neighbours a point's ellipse comes from, 6 to 64 [20]",
       6, 64, .acts = {.on = CLI_FACT(RAW), .is_warned = 1}},
      {"ellipse", CLI_PARSED, &job.estimate.ellipse, "RULE",
       "what a point's ellipse goes around: its voronoi cell, or bounding all K neighbours, as Confetti has it "
       "[voronoi]",
       .parse = parse_ellipse, .acts.on = CLI_FACT(RAW)},
      {"features", CLI_NUMBER, &job.estimate.feature_angle_deg, "ANGLE",
       "creases sharper than ANGLE degrees become sharp, by clip lines [none]", 0, 90},
      {"count", CLI_COUNT, &job.count, "N", "keep N of the points, chosen at random, and fit the sizes to them", 1,
       4294967294.0, .is_given = &job.has_count},
      {"seed", CLI_COUNT, &job.seed, "S",
       "which points --count chooses; those of a smaller count are among those of a larger one [0]",
       .acts.with = "count"},
      CLI_READING(session, &job.base),
      CLI_WAITING(session),
      CLI_WHERE(&job.base.where),
      {"plain", CLI_FLAG, &job.is_plain, NULL,
       "every point becomes an ellipse; else those that lie on no surface become round dots", .acts.on = CLI_FACT(RAW)},
      {"bake", CLI_PARSED, &job.bake, "WHAT",
       "ao: how much light from all around reaches each point, as the value ao; color: colours are darkened by it, too",
       .parse = cli_bake_parse},
      {"directions", CLI_INT, &job.n_directions, "N", "of --bake: from so many directions [256]", 1, 65536,
       .acts.with = "bake"},
      CLI_BUILD_COLOR_OPTIONS(&job.coloring, CLI_UP_OF_COLORS),
  };
  int parsed = cli_build_parse(&job.base, options, sizeof options / sizeof *options, argc, argv, "ply");
  return cli_build_run(&job, &steps, parsed == CLI_DONE ? cli_coloring_check(session, &job.coloring) : parsed);
}

const cli_command cli_prepare = {
    .name = "prepare",
    .summary = "turns points or a mesh into splats: normals, sizes, thinning",
    .usage = "conic prepare IN -o OUT.ply [-k K] [--ellipse RULE] [--features ANGLE] [--count N --seed S] [--plain]",
    .run = run_prepare,
    .is_shared = 1,
    .description = "Reads raw points, or the vertices of a mesh, and writes the splats that conic render would make of "
                   "them. Each point gets an ellipse of the size and the direction that its neighbours mean.",
    .examples = {{"keep 100,000 points of a scan", "conic prepare scan.las --count 100k -o small.ply"},
                 {"colour points by their height", "conic prepare scan.las --color-by height -o coloured.ply"},
                 {"darken what light hardly reaches", "conic prepare scan.ply --bake color -o baked.ply"}},
};
