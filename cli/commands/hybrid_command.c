/* conic hybrid: a mesh in, clusters of triangles and of surfels out. */
#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "cli/tell.h"
#include "core/base/message.h"
#include "source/mesh_input.h"
#include "source/reach.h"

static const char *const sampling_words[] = {"blue", "box", NULL};

typedef struct hybrid_job {
  cli_session *session;
  const char *input, *output, *texture;
  conic_hybrid_options options;

  conic_hybrid *hybrid;
  conic_hybrid_info info;
  conic_hybrid_report report;
  double read_seconds, work_seconds, write_seconds;
} hybrid_job;

static conic_status build(hybrid_job *job) {
  conic_triangles mesh;
  double start = cli_seconds();
  conic_status status = conic_mesh_read(job->session->context, job->input, job->texture, &mesh);
  double read = cli_seconds();
  job->read_seconds = read - start;
  if (status != CONIC_OK)
    return status;
  status = conic_hybrid_build(job->session->context, &mesh, &job->options, &job->hybrid, &job->report);
  double built = cli_seconds();
  job->work_seconds = built - read;
  if (status == CONIC_OK)
    status = conic_hybrid_describe(job->hybrid, &job->info);
  if (status == CONIC_OK && !conic_is_in_reach(job->info.minimum, job->info.maximum)) {
    cli_error(CLI_INPUT, "%s: a point is farther out than 1e20", job->input);
    status = CONIC_ERROR_INPUT;
  }
  if (status == CONIC_OK)
    status = conic_hybrid_write(job->hybrid, job->output);
  job->write_seconds = cli_seconds() - built;
  return status;
}

static void write_counts(cli_json *json, const hybrid_job *job) {
  const conic_hybrid_report *r = &job->report;
  cli_json_count(json, "triangles_in", r->n_faces);
  cli_json_count(json, "triangles", job->info.n_triangles);
  cli_json_count(json, "surfels", job->info.n_surfels);
  cli_json_count(json, "clusters", job->info.n_clusters);
  cli_json_count(json, "surfel_clusters", job->info.n_surfel_clusters);
  cli_json_count(json, "clusters_phase1", r->n_first);
  cli_json_count(json, "levels", job->info.n_levels);
  cli_json_count(json, "node_levels", job->info.n_node_levels);
  cli_json_count(json, "pieces", r->n_pieces);
  cli_json_count(json, "bytes", job->info.n_bytes);
}

static void write_seconds(cli_json *json, const hybrid_job *job, double total_seconds) {
  cli_json_object(json, "seconds");
  cli_json_number(json, "read", job->read_seconds);
  cli_json_number(json, "cluster", job->report.cluster_seconds);
  cli_json_number(json, "sample", job->report.sample_seconds);
  cli_json_number(json, "simplify", job->report.simplify_seconds);
  cli_json_number(json, "work", job->work_seconds);
  cli_json_number(json, "write", job->write_seconds);
  cli_json_number(json, "total", total_seconds);
  cli_json_close(json);
  cli_json_number(json, "triangles_per_s", (double)job->report.n_faces / job->work_seconds);
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
}

/* What the mesh has that a closed surface has not. */
static void write_oddities(cli_json *json, const conic_hybrid_report *r) {
  cli_json_object(json, "skipped");
  cli_json_count(json, "nan", r->nan);
  cli_json_count(json, "zero", r->zero);
  cli_json_close(json);
  cli_json_object(json, "oddities");
  cli_json_count(json, "welded", r->welded);
  cli_json_count(json, "open_edges", r->open);
  cli_json_count(json, "crowded_edges", r->crowded);
  cli_json_count(json, "twisted_edges", r->twisted);
  cli_json_count(json, "turned", r->turned);
  cli_json_close(json);
}

static int write_statistics(hybrid_job *job, double total_seconds) {
  int exit_code = CLI_DONE;
  cli_json_file *file;
  cli_json *json = cli_json_open(job->session, &file, &exit_code);
  if (!json)
    return exit_code;
  write_counts(json, job);
  write_seconds(json, job, total_seconds);
  write_oddities(json, &job->report);
  return cli_json_finish(file);
}

static void tell(const hybrid_job *job, double total_seconds) {
  conic_context *context = job->session->context;
  const conic_hybrid_info *info = &job->info;
  const conic_hybrid_report *r = &job->report;
  const cli_stage stages[] = {
      {"read", job->read_seconds},       {"cluster", r->cluster_seconds},        {"sample", r->sample_seconds},
      {"simplify", r->simplify_seconds}, {"all of the work", job->work_seconds}, {"write", job->write_seconds}};
  conic_log(context, CONIC_LOG_INFO,
            "%s: %zu faces in; %zu patches of %zu triangles and %zu of %zu surfels out, with %zu levels, %.1f MiB",
            job->input, r->n_faces, info->n_clusters - info->n_surfel_clusters, info->n_triangles,
            info->n_surfel_clusters, info->n_surfels, info->n_levels, (double)info->n_bytes / 1048576.0);
  if (r->nan || r->zero)
    conic_log(context, CONIC_LOG_INFO, "%s: left out %zu faces that are not finite, %zu that are not three places",
              job->input, r->nan, r->zero);
  if (r->welded || r->open || r->crowded || r->twisted || r->turned)
    conic_log(context, CONIC_LOG_INFO,
              "%s: taken as it is: %zu vertices at the place of another, %zu edges of one face, %zu of over two, %zu "
              "whose faces disagree, %zu faces turned against their neighbours",
              job->input, r->welded, r->open, r->crowded, r->twisted, r->turned);
  cli_tell_run(job->session, stages, 6, total_seconds);
}

static int run_job(hybrid_job *job) {
  double start = cli_seconds();
  int exit_code = cli_session_open(job->session);
  if (exit_code != CLI_DONE)
    return exit_code;
  conic_status status = build(job);
  double total_seconds = cli_seconds() - start;
  if (status == CONIC_OK)
    tell(job, total_seconds);
  exit_code = status == CONIC_OK ? write_statistics(job, total_seconds) : cli_exit_of(status);
  conic_hybrid_destroy(job->hybrid);
  return exit_code;
}

static int run(cli_session *session, int argc, char **argv) {
  hybrid_job job = {.session = session};
  const char *positional[argc];
  int n_positional, sampling = 0;
  conic_hybrid_options_init(&job.options);
  double cutoff = (double)job.options.cutoff;
  const cli_option options[] = {
      {.name = "o", .type = CLI_TEXT, .value = &job.output, .argument = "OUT.chy", .help = "the file to write"},
      {"phase1", CLI_NUMBER, &job.options.phase1, "COST",
       "what is flat together is joined up to this cost; more: larger clusters [0.12]", -1e6, 1e6},
      {"phase2", CLI_NUMBER, &job.options.phase2, "COST",
       "what is small then is gathered to patches of surfels up to this cost; -2: none, 1e6: all [0.4]", -1e6, 1e6},
      {"largest", CLI_NUMBER, &job.options.most_area, "SHARE",
       "of the mesh's area, the most that a cluster of the first phase has; 0: that of 2000 faces, 0.02 at most [0]", 0,
       1e6},
      {"density", CLI_NUMBER, &job.options.density, "N", "surfels along a patch's mean edge [2]", 0.01, 1024},
      {"most-error", CLI_NUMBER, &job.options.most_error, "E",
       "a patch stays triangles where its surfels would be farther from it, in distances between them; 0: none [0.5]",
       0, 1e6},
      {"sampling", CLI_CHOICE, &sampling, "HOW",
       "blue (blue noise, ellipses) or box (three grids, circles: for comparison) [blue]", .choices = sampling_words},
      {"texture", CLI_TEXT, &job.texture, "FILE", "the picture on the mesh [its materials']"},
      {"cutoff", CLI_NUMBER, &cutoff, "F", "standard deviations at which a surfel ends; that of the pictures [1.5]",
       0.25, 5},
      {"single", CLI_FLAG, &job.options.has_single_levels, NULL,
       "without the simpler levels that --error chooses from"},
  };
  int exit_code =
      cli_parse(session, options, sizeof options / sizeof options[0], argc, argv, positional, &n_positional);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  if (n_positional != 1)
    return cli_usage("hybrid: %s; see conic help hybrid", n_positional ? "one input at a time" : "no input given");
  if (!job.output)
    return cli_usage("hybrid: no output given (-o OUT.chy)");
  job.input = positional[0];
  job.options.cutoff = (float)cutoff;
  job.options.sampling = (conic_sampling)sampling;
  exit_code = cli_check_ending(job.output, "chy");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, &job.output, 1);
  if (exit_code == CLI_DONE)
    exit_code = cli_check_inputs_stay(session, &job.input, 1, &job.output, 1);
  return exit_code == CLI_DONE ? run_job(&job) : exit_code;
}

const cli_command cli_hybrid = {
    .name = "hybrid",
    .summary = "makes of a mesh patches of triangles where it is flat, and of surfels where it is not",
    .usage = "conic hybrid MESH -o OUT.chy [--phase1 COST] [--phase2 COST] [--texture FILE]",
    .run = run,
};
