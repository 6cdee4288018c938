/* conic mls: point-set surfaces. Makes cleaner, fewer or more points from points. */

#include "cli/command.h"
#include "cli/commands/build_steps.h"
#include "cli/commands/mls_sizes.h"
#include "cli/device_option.h"
#include "cli/points/points_input.h"
#include "core/splats/point_values.h"
#include "core/splats/repairs_log.h"

typedef enum mls_action { MLS_PROJECT, MLS_THIN, MLS_DENSIFY, N_MLS_ACTIONS } mls_action;

static const char *const action_names[N_MLS_ACTIONS + 1] = {"project", "thin", "densify", NULL};
static const char *const type_names[] = {"mls", "apss", NULL};
static const char *const plane_names[] = {"full", "fast", NULL};
static const char *const weight_names[] = {"gauss", "compact", "flat", NULL};
static const char *const keep_names[] = {"contribution", NULL};
static const char *const isa_names[] = {"auto", "scalar", "sse2", "avx2", "avx512", "neon", NULL};

typedef struct mls_job {
  cli_build base;
  mls_action action;
  int type, plane, weight, isa; /* indices of the words above, in the order of the enumerations */
  conic_surface_options options;
  cli_length h, max_error, spacing, hole;
  unsigned long long count;
  int has_count;
  unsigned long long memory_mib;
  int has_memory, is_sharp, keep, keeps;

  conic_model model;
  conic_surface *surface;
  conic_splats result;
  conic_surface_report report;
  conic_repairs repairs;
  size_t n_in, n_out;
  double unit;                 /* the median spacing, if a length is given in it */
  conic_splats_writer *writer; /* of cells */
  double work_end;             /* when the last point was projected */
} mls_job;

enum { READ, ESTIMATE, WORK, WRITE };

/* Without a number of points to keep, one in so many is kept. */
enum { THINNED_TO = 10 };

/* Finds the points' median spacing, if a length is given in spacings. */
static conic_status find_unit(mls_job *job) {
  if (!job->h.is_in_spacings && !job->max_error.is_in_spacings && !job->spacing.is_in_spacings &&
      !job->hole.is_in_spacings)
    return CONIC_OK;
  conic_status status = conic_splats_spacing(job->base.session->context, &job->model.points, &job->unit);
  if (status != CONIC_OK || job->unit > 0.0)
    return status;
  cli_error(CLI_INPUT, "%s: no two points are apart, so that a length in spacings has no meaning", job->base.input);
  return CONIC_ERROR_INPUT;
}

/* Spheres need normals, and normals tell the sides of surfaces: where the file has none, they are estimated. */
static conic_status read_points(mls_job *job) {
  conic_context *context = job->base.session->context;
  double start = cli_seconds();
  conic_read_options options;
  cli_build_reading(&job->base, &options);
  conic_status status = conic_gaussians_read_model(context, job->base.input, &options, &job->model);
  start = cli_build_end_stage(&job->base.stages[READ], start);
  if (status != CONIC_OK)
    return status;
  if (job->action != MLS_DENSIFY) /* densifying needs them: they say where the surface is */
    cli_build_hint_faces(&job->base, &job->model);
  conic_splats *points = &job->model.points;
  job->n_in = points->count;
  status = cli_build_leave_far(&job->base, points);
  if (status == CONIC_OK && !(conic_splats_fields(points) & (CONIC_SPLATS_NORMALS | CONIC_SPLATS_TANGENTS))) {
    conic_estimate_options estimate;
    conic_estimate_options_init(&estimate);
    estimate.finds_dots = job->action == MLS_DENSIFY && !job->model.n_triangles;
    status = conic_model_to_splats(context, &estimate, &job->model, &job->repairs);
  }
  if (status == CONIC_OK)
    status = find_unit(job);
  cli_build_end_stage(&job->base.stages[ESTIMATE], start);
  return status;
}

static double in_world(const mls_job *job, const cli_length *length) {
  return length->value * (length->is_in_spacings ? job->unit : 1.0);
}

static conic_status thin(mls_job *job) {
  conic_thin_options options;
  conic_thin_options_init(&options);
  options.count = job->has_count ? (size_t)job->count : 0;
  if (!job->has_count && !(job->max_error.value > 0.0))
    options.count = job->n_in / THINNED_TO + 1;
  options.max_error = in_world(job, &job->max_error);
  options.is_measured = 1;
  conic_status status = conic_surface_thin(job->surface, &options, &job->result, &job->report);
  return status == CONIC_OK && !job->is_sharp
             ? cli_mls_size_thinned(job->base.session->context, &job->model, &job->result)
             : status;
}

/* --keep: what each point matters to the surface of those that are written. */
static conic_status keep_contributions(mls_job *job) {
  conic_context *context = job->base.session->context;
  conic_splats *splats = &job->result;
  conic_surface *surface = NULL;
  float *values = conic_memory_allocate(context, splats->count, sizeof *values);
  conic_status status = values ? conic_surface_create(context, splats, &job->options, &surface) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_surface_contributions(surface, values);
  if (status == CONIC_OK)
    status = conic_splats_keep_value(context, splats, keep_names[0], values);
  conic_surface_destroy(surface);
  conic_memory_release(context, values);
  return status;
}

static conic_status densify(mls_job *job) {
  conic_densify_options options;
  conic_densify_options_init(&options);
  options.spacing = in_world(job, &job->spacing);
  options.hole = in_world(job, &job->hole);
  options.max_count = job->has_count ? (size_t)job->count : 0;
  options.n_triangles = job->model.n_triangles;
  options.triangles = (const uint32_t(*)[3])job->model.triangles;
  conic_status status = conic_surface_densify(job->surface, &options, &job->result, &job->report);
  return status == CONIC_OK && !job->is_sharp
             ? cli_mls_size_dense(job->base.session->context, &job->model, &job->result)
             : status;
}

/* Works cell by cell, if all points have one h: then not all of them are needed at once. */
static int is_by_cells(const mls_job *job) {
  return job->action == MLS_PROJECT && job->h.value > 0.0 && job->options.cluster == 0.0 && !job->is_sharp;
}

static conic_status feed_points(void *cookie, conic_batch_receiver *receive, void *to) {
  mls_job *job = cookie;
  conic_read_options options;
  cli_build_reading(&job->base, &options);
  return job->has_memory ? conic_model_stream(job->base.session->context, job->base.input, &options, receive, to)
                         : receive(to, &job->model.points);
}

/* The last point is projected. Nothing is written if none is left. */
static conic_status begin_cells(void *cookie, const conic_surface_report *report, unsigned fields) {
  mls_job *job = cookie;
  conic_write_options options;
  conic_write_options_init(&options);
  job->work_end = cli_seconds();
  conic_status status = cli_points_find_epsg(job->base.session, job->base.input, 0, &options.epsg);
  return report->n_out == 0 || status != CONIC_OK
             ? status
             : conic_splats_writer_open(job->base.session->context, job->base.output, report->n_out, fields, &options,
                                        &job->writer);
}

static conic_status append_cleaned(void *cookie, const conic_splats *batch) {
  return conic_splats_writer_append(((mls_job *)cookie)->writer, batch);
}

static conic_status clean_cells(mls_job *job) {
  conic_clean_options options;
  const conic_points_sink sink = {begin_cells, append_cleaned, job};
  conic_clean_options_init(&options);
  options.surface = job->options;
  options.name = job->base.input;
  options.memory_bytes = (size_t)job->memory_mib << 20;
  options.scratch = strcmp(job->base.output, "-") == 0 ? job->base.input : job->base.output;
  double start = cli_seconds();
  conic_status status =
      conic_surface_clean_cells(job->base.session->context, &options, feed_points, job, &sink, &job->report);
  if (status == CONIC_OK && job->writer)
    status = conic_splats_writer_finish(job->writer);
  else
    conic_splats_writer_abandon(job->writer);
  job->base.stages[WORK].seconds = job->work_end - start;
  job->base.stages[WRITE].seconds = cli_seconds() - job->work_end;
  job->n_in = job->report.n_in;
  job->n_out = job->report.n_out;
  return status;
}

static conic_status work(mls_job *job) {
  double start = cli_seconds();
  job->options.type = (conic_surface_type)job->type;
  job->options.plane = (conic_surface_plane)job->plane;
  job->options.weight = (conic_surface_weight)job->weight;
  job->options.isa = (conic_isa)job->isa;
  job->options.h = in_world(job, &job->h);
  job->options.is_sharp = (uint64_t)job->is_sharp;
  if (is_by_cells(job))
    return clean_cells(job);
  conic_status status =
      conic_surface_create(job->base.session->context, &job->model.points, &job->options, &job->surface);
  if (status == CONIC_OK)
    status = job->action == MLS_THIN      ? thin(job)
             : job->action == MLS_DENSIFY ? densify(job)
                                          : conic_surface_clean(job->surface, &job->result, &job->report);
  if (status == CONIC_OK && job->keeps)
    status = keep_contributions(job);
  if (status == CONIC_OK && job->is_sharp)
    status = cli_mls_size_sharp(job->base.session->context, &job->result);
  job->n_out = job->result.count;
  cli_build_end_stage(&job->base.stages[WORK], start);
  return status;
}

/* Points without a surface around them are left out. There are always some; many mean that h is too small. */
static void warn(const mls_job *job) {
  const size_t *outcomes = job->report.outcomes;
  size_t n_lost = job->action == MLS_PROJECT ? job->n_in - job->n_out : 0;
  if (n_lost > job->n_in / 10)
    conic_log(
        job->base.session->context, CONIC_LOG_WARNING,
        "%s: %zu of %zu points are left out: %zu too few neighbours, %zu no minimum, %zu ill-conditioned; a larger "
        "--h reaches more",
        job->base.input, n_lost, job->n_in, outcomes[CONIC_SURFACE_TOO_FEW], outcomes[CONIC_SURFACE_NO_MINIMUM],
        outcomes[CONIC_SURFACE_ILL_CONDITIONED]);
  if (job->report.n_merged > job->n_out / 100)
    conic_log(job->base.session->context, CONIC_LOG_WARNING,
              "%s: %llu of %zu points lie between two sheets that were taken for one; a smaller --h keeps them apart",
              job->base.input, (unsigned long long)job->report.n_merged, job->n_out);
}

static void tell_points(const void *cookie) {
  const mls_job *job = cookie;
  conic_context *context = job->base.session->context;
  const conic_surface_report *r = &job->report;
  warn(job);
  conic_log(context, CONIC_LOG_INFO, "%s: %zu points in, %zu out; h %.4g, the median", job->base.input, job->n_in,
            job->n_out, r->h);
  conic_repairs_log(job->base.session->context, job->base.input, &job->repairs);
  if (job->action == MLS_PROJECT)
    conic_log(context, CONIC_LOG_INFO,
              "%s: moved by %.3g (root of the mean square), %.3g at most; left out %zu not finite, %zu with too few "
              "neighbours, %zu without a minimum, %zu ill-conditioned",
              job->base.input, r->moved_rms, r->moved_max, r->outcomes[CONIC_SURFACE_NOT_FINITE],
              r->outcomes[CONIC_SURFACE_TOO_FEW], r->outcomes[CONIC_SURFACE_NO_MINIMUM],
              r->outcomes[CONIC_SURFACE_ILL_CONDITIONED]);
  if (job->action == MLS_DENSIFY && r->n_flat)
    conic_log(context, CONIC_LOG_INFO,
              "%s: no surface was found for %llu of the new points, which lie flat in triangles", job->base.input,
              (unsigned long long)r->n_flat);
  if (job->action == MLS_THIN)
    conic_log(context, CONIC_LOG_INFO, "%s: the thinned surface is within %.3g of it", job->base.input,
              r->there.max > r->back.max ? r->there.max : r->back.max);
}

static int write_points(mls_job *job) {
  double start = cli_seconds();
  if (job->n_out == 0)
    return cli_error(CLI_INPUT, "%s: no point has a surface about it (%zu too few neighbours, %zu no minimum)",
                     job->base.input, job->report.outcomes[CONIC_SURFACE_TOO_FEW],
                     job->report.outcomes[CONIC_SURFACE_NO_MINIMUM]);
  if (is_by_cells(job)) /* the output is written already */
    return CLI_DONE;
  int exit_code =
      cli_exit_of(cli_points_write(job->base.session, job->base.input, job->base.output, 1.5f, &job->result));
  cli_build_end_stage(&job->base.stages[WRITE], start);
  return exit_code;
}

/* --- statistics --- */

static void write_surface(cli_json *json, const mls_job *job) {
  cli_json_texts(json, NULL, {"action", action_names[job->action]}, {"type", type_names[job->type]},
                 {"plane", job->type == CONIC_SURFACE_MLS ? plane_names[job->plane] : NULL},
                 {"weight", weight_names[job->weight]});
  cli_json_figures(json, NULL, {"h", job->report.h}, {"neglect", job->options.neglect});
  if (job->type == CONIC_SURFACE_MLS)
    cli_json_count(json, "degree", (uint64_t)job->options.degree);
}

static void write_projected(cli_json *json, const conic_surface_report *report) {
  static const char *const keys[CONIC_N_SURFACE_OUTCOMES] = {"done", "not_finite", "too_few", "no_minimum",
                                                             "ill_conditioned"};
  cli_json_object(json, "outcomes");
  for (int i = 0; i < CONIC_N_SURFACE_OUTCOMES; i++)
    cli_json_count(json, keys[i], report->outcomes[i]);
  cli_json_close(json);
  cli_json_figures(json, "moved", {"rms", report->moved_rms}, {"max", report->moved_max});
  cli_json_number(json, "mean_neighbours", report->mean_neighbours);
  cli_json_count(json, "merged", report->n_merged);
}

static void write_distance(cli_json *json, const char *key, const conic_surface_distance *distance) {
  cli_json_object(json, key);
  cli_json_figures(json, NULL, {"max", distance->max}, {"rms", distance->rms});
  cli_json_counts(json, NULL, {"measured", distance->n_measured}, {"failed", distance->n_failed});
  cli_json_close(json);
}

static void report_points(cli_json *json, const void *cookie) {
  const mls_job *job = cookie;
  const conic_surface_report *report = &job->report;
  cli_json_counts(json, NULL, {"points_in", job->n_in}, {"points_out", job->n_out});
  write_surface(json, job);
  if (job->action == MLS_PROJECT)
    write_projected(json, report);
  if (job->action == MLS_DENSIFY)
    cli_json_count(json, "flat", report->n_flat);
  if (job->action == MLS_THIN) {
    cli_json_number(json, "error", report->error);
    write_distance(json, "to_thinned", &report->there);
    write_distance(json, "from_thinned", &report->back);
    cli_json_number(json, "hausdorff", report->there.max > report->back.max ? report->there.max : report->back.max);
  }
  cli_json_count(json, "evaluations", report->n_evaluations);
  cli_build_report_cost(json, &job->base, "points_per_s", (double)job->n_in / job->base.stages[WORK].seconds);
  conic_repairs repairs = job->repairs;
  repairs.nan = report->outcomes[CONIC_SURFACE_NOT_FINITE];
  repairs.failed = report->outcomes[CONIC_SURFACE_TOO_FEW] + report->outcomes[CONIC_SURFACE_NO_MINIMUM] +
                   report->outcomes[CONIC_SURFACE_ILL_CONDITIONED];
  cli_json_skipped(json, &repairs);
}

static int make_points(void *cookie) {
  mls_job *job = cookie;
  cli_build_share(&job->base);
  conic_status status = cli_build_know(&job->base, cli_build_facts_of_file(&job->base, job->base.input));
  if (status == CONIC_OK && !job->has_memory)
    status = read_points(job);
  if (status == CONIC_OK)
    status = work(job);
  status = cli_build_part(&job->base, status);
  return status == CONIC_OK && cli_session_speaks(job->base.session) ? write_points(job) : cli_exit_of(status);
}

static void release_points(void *cookie) {
  mls_job *job = cookie;
  conic_splats_release(job->base.session->context, &job->result);
  conic_surface_destroy(job->surface);
  conic_model_release(job->base.session->context, &job->model);
}

/* --- arguments --- */

static int check_job(mls_job *job, const char *const *positional, int n_positional) {
  if (n_positional == 0)
    return cli_usage("mls: what to do? project, thin or densify; see conic help mls");
  for (int i = 0; i < N_MLS_ACTIONS; i++)
    if (strcmp(positional[0], action_names[i]) == 0)
      job->action = (mls_action)i;
  if (job->action == N_MLS_ACTIONS)
    return cli_usage("mls: %s is neither project, thin nor densify", positional[0]);
  const char *name = action_names[job->action];
  if (n_positional != 2)
    return cli_usage("mls %s: %s; see conic help mls", name,
                     n_positional > 2 ? "one input at a time" : "no input given");
  int exit_code = cli_build_take_paths(&job->base, positional[1], "ply");
  if (exit_code != CLI_DONE)
    return exit_code;
  if (job->action == MLS_DENSIFY && !(job->spacing.value > 0.0))
    job->spacing = (cli_length){.value = 0.5, .is_in_spacings = 1};
  if (job->has_memory && (!is_by_cells(job) || job->h.is_in_spacings || strcmp(positional[1], "-") == 0))
    return cli_usage("mls %s: --memory is of project, from a file, with --h in world units and without --cluster and "
                     "--sharp",
                     name);
  if (job->is_sharp && job->options.cluster > 0.0)
    return cli_usage("mls %s: --sharp has no --cluster", name);
  exit_code = cli_build_check(&job->base, &job->base.input, 1, "ply");
  return exit_code == CLI_DONE ? cli_isa_check(job->base.session, (conic_isa)job->isa) : exit_code;
}

static int run_mls(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_points, tell_points, report_points, release_points};
  mls_job job = {.base = {session, .stages = {{"read"}, {"estimate"}, {"work"}, {"write"}}}, .action = N_MLS_ACTIONS};
  const char *positional[argc];
  int n_positional;
  conic_surface_options_init(&job.options);
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.ply", "the file to write"},
      CLI_IN_PLACE(job.base),
      {"type", CLI_CHOICE, &job.type, "T",
       "how the surface is fitted: mls, by polynomials over planes; apss, by algebraic spheres [mls]",
       .choices = type_names},
      {"plane", CLI_CHOICE, &job.plane, "P",
       "of --type mls, where the plane lies: full, where it makes this a projection; fast, through the point itself "
       "[full]",
       .choices = plane_names, .acts.with = "type=mls"},
      {"degree", CLI_INT, &job.options.degree, "D", "of --type mls, the degree of the polynomials, 1 to 4 [3]", 1,
       CONIC_SURFACE_MAX_DEGREE, .acts.with = "type=mls"},
      {"weight", CLI_CHOICE, &job.weight, "W",
       "how a sample's weight falls with its distance: gauss, compact or flat [gauss]", .choices = weight_names},
      {"h", CLI_PARSED, &job.h, "H",
       "what is smaller is smoothed away: a length, also in spacings (2x) [of each point its own, by -k]",
       .parse = cli_parse_length, .dashes = "--"},
      {"k", CLI_INT, &job.options.n_local, "K",
       "where each point has an h of its own: neighbours beyond the K-th weigh nothing, 6 to 64 [32]", 6, 64,
       .acts.with = "!h"},
      {"neglect", CLI_NUMBER, &job.options.neglect, "C",
       "samples farther away than C times h weigh nothing, 1 to 6 [2]", 1, 6},
      {"cluster", CLI_NUMBER, &job.options.cluster, "T",
       "project: cells smaller than T times their distance count as one sample, 0 to 1 [0]", 0, 1,
       .acts.with = "@project"},
      {"sharp", CLI_FLAG, &job.is_sharp, NULL, "keep creases sharp, and clip the splats that are written at them"},
      {"count", CLI_COUNT, &job.count, "N", "thin: points to keep [a tenth]; densify: points to stop at", 1,
       4294967294.0, .is_given = &job.has_count, .acts.with = "@thin|@densify"},
      {"max-error", CLI_PARSED, &job.max_error, "E", "thin: keep the surface within E of what it was",
       .parse = cli_parse_length, .acts.with = "@thin"},
      {"keep", CLI_CHOICE, &job.keep, "WHAT",
       "thin: contribution, how far each point that is left lies from the surface of the others, as a value",
       .choices = keep_names, .is_given = &job.keeps, .acts.with = "@thin"},
      {"spacing", CLI_PARSED, &job.spacing, "S", "densify: no circle of a greater radius stays empty [0.5x]",
       .parse = cli_parse_length, .acts.with = "@densify"},
      {"hole", CLI_PARSED, &job.hole, "R",
       "densify: circles of a greater radius are holes and stay; faces are none [1.25 h]", .parse = cli_parse_length,
       .acts.with = "@densify"},
      {"memory", CLI_COUNT, &job.memory_mib, "MIB",
       "project: work cell by cell in so much memory, the rest beside the output", 1, 1e9, .is_given = &job.has_memory,
       .acts = {.with = "@project", .is_work = 1}},
      {"isa", CLI_CHOICE, &job.isa, "ISA", "auto, scalar, sse2, avx2, avx512, neon; changes no bit [auto]",
       .choices = isa_names, .acts.is_work = 1},
      CLI_READING(session, &job.base),
  };
  int exit_code =
      cli_build_arguments(&job.base, options, sizeof options / sizeof *options, argc, argv, positional, &n_positional);
  session->isa = (conic_isa)job.isa;
  return cli_build_run(&job, &steps, exit_code == CLI_DONE ? check_job(&job, positional, n_positional) : exit_code);
}

static const char *action_word(int i, const char **about) {
  static const char *const texts[] = {"moves each point onto the surface", "leaves out points", "adds points"};
  *about = i < N_MLS_ACTIONS ? texts[i] : NULL;
  return action_names[i];
}

static const cli_words mls_words = {"what is done", NULL, action_word};

const cli_command cli_mls = {
    .name = "mls",
    .summary = "point-set surfaces: smooths, thins or densifies points",
    .usage = "conic mls project|thin|densify IN -o OUT.ply [--type mls|apss] [--h H] [--degree D]\n"
             "          [--count N] [--max-error E] [--spacing S] [--hole R] [--sharp]",
    .run = run_mls,
    .is_shared = 1,
    .description = "Fits a surface to the points and moves them onto it (project), leaves out those that it needs not "
                   "(thin), or adds points where it has too few (densify). Lengths are in the units of the file or, "
                   "with an x behind them (2x), multiples of the typical distance between neighbouring points.",
    .words = &mls_words,
    .examples = {{"remove noise", "conic mls project scan.ply -o clean.ply"},
                 {"keep as few points as stay within 1 mm of the surface, in a file in metres",
                  "conic mls thin scan.ply --max-error 0.001 -o thin.ply"}},
};
