/* conic hybrid: turns a mesh into clusters of triangles and of surfels. */
#include "cli/commands/build_coloring.h"
#include "cli/points/points_input.h"
#include "core/base/context_struct.h"
#include "source/mesh_input.h"
#include "source/reach.h"

static const char *const sampling_words[] = {"blue", "box", NULL};

typedef struct hybrid_job {
  cli_build base;
  cli_coloring coloring;
  const char *texture;
  int is_smooth, is_crease_given;
  double crease_deg;
  conic_hybrid_options options;
  int memory_mib; /* 0: the mesh is read as a whole */

  conic_hybrid *hybrid;
  conic_hybrid_info info;
  conic_hybrid_report report;
} hybrid_job;

enum { READ, CLUSTER, SAMPLE, SIMPLIFY, WORK, WRITE };

/* Builds from an input that is read whole. */
static conic_status build_whole(hybrid_job *job) {
  conic_context *context = job->base.session->context;
  conic_hybrid_input input;
  const conic_hybrid_reading reading = {job->texture,        &job->coloring.options, job->is_smooth,
                                        job->crease_deg,     job->options.cutoff,    0,
                                        job->base.colors_are};
  double start = cli_seconds();
  conic_status status = conic_hybrid_input_read(context, job->base.input, &reading, &input);
  if (status == CONIC_OK)
    status = cli_build_know(&job->base, CLI_SURFACES | CLI_FACT(VALUED) | (input.is_points ? 0 : CLI_FACT(FACES)) |
                                            (input.has_fractions ? CLI_FACT(FRACTIONS) : 0) |
                                            (context->texture_bytes ? CLI_FACT(TEXTURED) : 0));
  if (status == CONIC_OK)
    status =
        cli_coloring_apply(&job->base, &job->coloring, input.is_points ? input.up : (const double[3]){0.0, 1.0, 0.0},
                           input.is_points ? &input.splats : NULL, input.is_points ? NULL : &input.mesh);
  cli_build_end_stage(&job->base.stages[READ], start);
  if (status == CONIC_OK)
    return conic_hybrid_input_build(context, &input, &job->options, &job->hybrid, &job->report);
  conic_hybrid_input_release(context, &input);
  return status;
}

static conic_status build_within(hybrid_job *job) {
  conic_hybrid_streaming streaming;
  conic_status status = cli_build_know(&job->base, CLI_SOURCE_FACTS & ~(CLI_FACT(TEXTURED) | CLI_FACT(FRACTIONS)));
  conic_hybrid_streaming_init(&streaming);
  streaming.memory_bytes = (uint64_t)job->memory_mib << 20;
  streaming.is_smooth = job->is_smooth;
  streaming.crease_deg = job->crease_deg;
  return status == CONIC_OK ? conic_hybrid_build_file(job->base.session->context, job->base.input, job->base.output,
                                                      &job->options, &streaming, &job->hybrid, &job->report)
                            : status;
}

/* Why the model as built has more primitives than came in; null where it has not. */
static const char *why_more(const hybrid_job *job) {
  const uint64_t n_points = job->report.n_points, n_in = n_points ? n_points : job->report.n_faces;
  if (job->info.n_triangles + job->info.n_surfels <= n_in)
    return NULL;
  return n_points ? "a surface has two triangles for each of its points; --error draws fewer"
                  : "surfels lie closer than vertices do where the mesh bends; --only triangles draws none of them and "
                    "--error fewer of both";
}

static int make_hybrid(void *cookie) {
  hybrid_job *job = cookie;
  cli_stage *stages = job->base.stages;
  double start = cli_seconds();
  unsigned epsg;
  conic_status status = cli_points_find_epsg(job->base.session, job->base.input, 1, &epsg);
  if (status == CONIC_OK)
    status = job->memory_mib ? build_within(job) : build_whole(job);
  start = cli_build_end_stage(&stages[WORK], start + stages[READ].seconds);
  stages[CLUSTER].seconds = job->report.cluster_seconds;
  stages[SAMPLE].seconds = job->report.sample_seconds;
  stages[SIMPLIFY].seconds = job->report.simplify_seconds;
  for (int i = CLUSTER; i <= SIMPLIFY; i++)
    stages[WORK].parts += stages[i].seconds;
  if (status == CONIC_OK)
    status = conic_hybrid_describe(job->hybrid, &job->info);
  if (status == CONIC_OK && !conic_is_in_reach(job->info.minimum, job->info.maximum))
    return cli_error(CLI_INPUT, "%s: a point is farther out than 1e20", job->base.input);
  if (status == CONIC_OK)
    status = conic_hybrid_write(job->hybrid, job->base.output);
  cli_build_end_stage(&stages[WRITE], start);
  if (status == CONIC_OK && why_more(job))
    cli_note(job->base.session, "%s: more primitives as built than came in: %s", job->base.input, why_more(job));
  return cli_exit_of(status);
}

static void write_counts(cli_json *json, const hybrid_job *job) {
  const conic_hybrid_report *r = &job->report;
  cli_json_count(json, "triangles_in", r->n_faces);
  if (r->n_points) {
    cli_json_counts(json, NULL, {"points_in", r->n_points}, {"splats_kept", r->n_kept});
  }
  cli_json_counts(json, NULL, {"triangles", job->info.n_triangles}, {"surfels", job->info.n_surfels},
                  {"clusters", job->info.n_clusters}, {"surfel_clusters", job->info.n_surfel_clusters},
                  {"clusters_phase1", r->n_first}, {"levels", job->info.n_levels},
                  {"node_levels", job->info.n_node_levels}, {"pieces", r->n_pieces}, {"bytes", job->info.n_bytes});
  if (why_more(job))
    cli_json_text(json, "why_more", why_more(job));
}

/* Writes what keeps the mesh from being a closed surface. */
static void write_oddities(cli_json *json, const conic_hybrid_report *r) {
  cli_json_counts(json, "skipped", {"nan", r->nan}, {"zero", r->zero});
  cli_json_counts(json, "oddities", {"welded", r->welded}, {"open_edges", r->open}, {"crowded_edges", r->crowded},
                  {"twisted_edges", r->twisted}, {"turned", r->turned});
}

static void report_hybrid(cli_json *json, const void *cookie) {
  const hybrid_job *job = cookie;
  write_counts(json, job);
  cli_color_report(json, &job->coloring.done);
  cli_build_report_cost(json, &job->base, "triangles_per_s",
                        (double)job->report.n_faces / job->base.stages[WORK].seconds);
  write_oddities(json, &job->report);
}

static void tell_hybrid(const void *cookie) {
  const hybrid_job *job = cookie;
  conic_context *context = job->base.session->context;
  const conic_hybrid_info *info = &job->info;
  const conic_hybrid_report *r = &job->report;
  if (r->n_points)
    conic_log(context, CONIC_LOG_INFO, "%s: %zu points in, of which %zu stay splats", job->base.input,
              (size_t)r->n_points, (size_t)r->n_kept);
  conic_log(context, CONIC_LOG_INFO,
            "%s: %zu faces in; %zu patches of %zu triangles and %zu of %zu surfels out, with %zu levels, %.1f MiB",
            job->base.input, r->n_faces, info->n_clusters - info->n_surfel_clusters, info->n_triangles,
            info->n_surfel_clusters, info->n_surfels, info->n_levels, (double)info->n_bytes / 1048576.0);
  if (r->nan || r->zero)
    conic_log(context, CONIC_LOG_INFO, "%s: left out %zu faces that are not finite, %zu that are not three places",
              job->base.input, r->nan, r->zero);
  if (r->welded || r->open || r->crowded || r->twisted || r->turned)
    conic_log(context, CONIC_LOG_INFO,
              "%s: taken as it is: %zu vertices at the place of another, %zu edges of one face, %zu of over two, %zu "
              "whose faces disagree, %zu faces turned against their neighbours",
              job->base.input, r->welded, r->open, r->crowded, r->twisted, r->turned);
}

static void release_hybrid(void *cookie) {
  hybrid_job *job = cookie;
  conic_hybrid_destroy(job->hybrid);
}

static int run_hybrid(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_hybrid, tell_hybrid, report_hybrid, release_hybrid};
  hybrid_job job = {
      .crease_deg = 30.0,
      .base = {
          session,
          .stages = {{"read"}, {"cluster"}, {"sample"}, {"simplify"}, {"rest of the work", .key = "work"}, {"write"}}}};
  int sampling = 0;
  conic_hybrid_options_init(&job.options);
  cli_coloring_init(&job.coloring);
  double cutoff = (double)job.options.cutoff;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job.base.output, "OUT.chy", "the file to write"},
      {"phase1", CLI_NUMBER, &job.options.phase1, "COST",
       "pieces that are flat together are joined up to this cost; more makes larger clusters [0.12]", -1e6, 1e6},
      {"phase2", CLI_NUMBER, &job.options.phase2, "COST",
       "what then is still small is gathered into patches of surfels up to this cost; -2: nothing, 1e6: all [0.4]",
       -1e6, 1e6},
      {"largest", CLI_NUMBER, &job.options.most_area, "SHARE",
       "how much of the mesh's area a cluster of the first phase may have; 0: that of 2000 faces, 0.02 at most [0]", 0,
       1e6},
      {"density", CLI_NUMBER, &job.options.density, "N", "how many surfels lie along a mean edge of a patch [2]", 0.01,
       1024},
      {"most-error", CLI_NUMBER, &job.options.most_error, "E",
       "a patch stays triangles where its surfels would be farther from it, in distances between them; 0: none [0.5]",
       0, 1e6},
      {"sampling", CLI_CHOICE, &sampling, "HOW",
       "blue (blue noise, ellipses) or box (three grids, circles: for comparison) [blue]", .choices = sampling_words},
      {"texture", CLI_TEXT, &job.texture, "FILE", "the picture on the mesh's surface [as its materials say]"},
      CLI_TEXTURE_BOUND(session),
      CLI_COLORS(&job.base.colors_are),
      CLI_OUTSIDE(session),
      {"smooth", CLI_FLAG, &job.is_smooth, NULL,
       "triangles look smooth everywhere: each vertex gets the mean normal of its faces", .acts.on = CLI_FACT(FACES)},
      {"crease", CLI_NUMBER, &job.crease_deg, "DEG",
       "triangles without normals look smooth over edges up to this angle, in degrees; 0: every face is flat [30]", 0,
       90, .is_given = &job.is_crease_given, .acts.on = CLI_FACT(FACES)},
      {"cutoff", CLI_NUMBER, &cutoff, "F", "the --cutoff of the pictures to come [1.5]", 0.25, 5},
      {"memory", CLI_INT, &job.memory_mib, "MiB",
       "of a PLY that is larger than memory, what building may take; in cells, so that the file is another one "
       "[the mesh is read whole]",
       1, 1 << 20},
      {"single", CLI_FLAG, &job.options.has_single_levels, NULL,
       "without the simpler levels that --error chooses from"},
      CLI_BUILD_COLOR_OPTIONS(&job.coloring, CLI_UP_OF_COLORS),
  };
  int exit_code = cli_build_parse(&job.base, options, sizeof options / sizeof *options, argc, argv, "chy");
  job.options.cutoff = (float)cutoff;
  job.options.sampling = (conic_sampling)sampling;
  if (exit_code == CLI_DONE && job.is_smooth && job.is_crease_given)
    exit_code = cli_usage("hybrid: --smooth rounds all edges, --crease those up to an angle; give one of both");
  if (exit_code == CLI_DONE)
    exit_code = cli_color_check_texture(session, &job.coloring.options, job.texture);
  if (exit_code == CLI_DONE && job.memory_mib && (job.texture || job.coloring.options.by))
    exit_code = cli_usage("hybrid: with --memory colours are the vertices' own, not by --texture or --color-by");
  if (exit_code == CLI_DONE)
    exit_code = cli_coloring_check(session, &job.coloring);
  return cli_build_run(&job, &steps, exit_code);
}

const cli_command cli_hybrid = {
    .name = "hybrid",
    .summary = "makes of a mesh, or of points, patches of triangles where it is flat, and of surfels where it is not",
    .usage = "conic hybrid MESH|POINTS -o OUT.chy [--phase1 COST] [--phase2 COST] [--texture FILE]",
    .run = run_hybrid,
    .description = "Cuts a mesh into patches. Where many small triangles bend, splats (here called surfels) draw them "
                   "faster than triangles do; where the mesh is flat, its triangles stay. Points without faces become "
                   "triangles where they lie as a surface does; leaves, borders and all else stay splats.",
    .examples = {{"build and draw", "conic hybrid statue.obj -o statue.chy\n"
                                    "conic render statue.chy -o statue.png"},
                 {"from a scan", "conic hybrid scan.ply -o scan.chy\n"
                                 "conic render scan.chy -o scan.png --error 1"}},
};
