/* conic make: samples an analytic scene into splats, batch by batch, so that memory does not grow with their number; or
 * makes a scene of Gaussians, all at once. */

#include "cli/command.h"
#include "cli/commands/build_steps.h"
#include "cli/outputs.h"
#include "core/base/nearest_word.h"
#include "gaussians/scene/made_gaussians.h"

/* Splats in memory at a time. */
#define BATCH ((size_t)1 << 20)

typedef struct make_job {
  cli_build base;
  conic_scene_options scene;
  conic_write_options write;
  unsigned long long count, seed;
  int is_ascii, is_gaussians, sh_degree;
} make_job;

enum { READ, WORK, WRITE };

static const char gaussians_name[] = "gaussians";

/* What samples of surfaces alone have. */
#define NOT_GAUSSIANS "!@gaussians"

/* "plane, sphere, …", for messages. */
static void list_names(char *names, size_t room) {
  size_t used = 0;
  names[0] = '\0';
  for (int i = 0; i < CONIC_N_SCENES && used < room; i++)
    used += (size_t)snprintf(names + used, room - used, "%s, ", conic_scene_name((conic_scene_type)i));
  if (used < room)
    snprintf(names + used, room - used, "%s", gaussians_name);
}

static const char *scene_word(int i, const char **about) {
  *about = i < CONIC_N_SCENES ? conic_scene_summary((conic_scene_type)i)
                              : "3D Gaussians, like a scene trained from photographs";
  return i < CONIC_N_SCENES ? conic_scene_name((conic_scene_type)i) : i == CONIC_N_SCENES ? gaussians_name : NULL;
}

static const cli_words scene_words = {"scenes", NULL, scene_word};

static int find_scene(const char *name, conic_scene_type *type) {
  const char *nearest = conic_nearer_word(name, NULL, gaussians_name);
  char names[256];
  for (int i = 0; i < CONIC_N_SCENES; i++) {
    const char *candidate = conic_scene_name((conic_scene_type)i);
    if (strcmp(name, candidate) == 0) {
      *type = (conic_scene_type)i;
      return CLI_DONE;
    }
    nearest = conic_nearer_word(name, nearest, candidate);
  }
  if (nearest)
    return cli_usage("make: unknown scene %s; did you mean %s?", name, nearest);
  list_names(names, sizeof names);
  return cli_usage("make: unknown scene %s; there are %s", name, names);
}

static int check_gaussians(const make_job *job) {
  conic_gaussian_kind kind;
  if (!job->base.output)
    return cli_usage("make: where to? It needs -o OUT.ply, or another format of Gaussians");
  if (!conic_gaussians_find_kind(job->base.output, &kind))
    return cli_usage("%s: no format of Gaussians has this ending", job->base.output);
  return cli_check_outputs(job->base.session, &job->base.output, 1);
}

static int check_arguments(const char *const *scenes, int n_scenes, make_job *job) {
  char names[256];
  if (n_scenes == 0) {
    list_names(names, sizeof names);
    return cli_usage("make: which scene? There are %s", names);
  }
  if (n_scenes > 1)
    return cli_usage("make: one scene at a time: what is %s?", scenes[1]);
  job->is_gaussians = strcmp(scenes[0], gaussians_name) == 0;
  if (job->is_gaussians)
    return check_gaussians(job);
  int exit_code = find_scene(scenes[0], &job->scene.type);
  if (exit_code == CLI_DONE && !job->base.output)
    exit_code = cli_usage("make: where to? It needs -o OUT.ply");
  return exit_code == CLI_DONE ? cli_build_check(&job->base, NULL, 0, "ply") : exit_code;
}

static int parse_scene(int argc, char **argv, make_job *job) {
  conic_scene_options *scene = &job->scene;
  conic_scene_options_init(scene);
  conic_write_options_init(&job->write);
  job->count = scene->count;
  job->sh_degree = 3;
  const cli_option options[] = {
      {"o", CLI_TEXT, &job->base.output, "OUT.ply", "the file to write; - is standard output"},
      {"n", CLI_COUNT, &job->count, "COUNT", "how many splats: 100000, 10k, 2M, 1e6 [100k]", 1, 4294967294.0},
      {"seed", CLI_COUNT, &job->seed, "S",
       "the number that the jitter, the noise and the terrain's shape are drawn from [0]",
       .acts.with = "jitter|noise|@terrain|@gaussians"},
      {"jitter", CLI_NUMBER, &scene->jitter, "J", "move each splat in its plane by up to J spacings [0]", 0, 1e6,
       .acts.with = NOT_GAUSSIANS},
      {"noise", CLI_NUMBER, &scene->noise, "N",
       "move each along its normal by chance, by N spacings in the mean square [0]", 0, 1e6,
       .acts.with = NOT_GAUSSIANS},
      {"far", CLI_VECTOR, scene->offset, "X,Y,Z",
       "move the scene away from the origin; positions then are doubles [0,0,0]", .acts.with = NOT_GAUSSIANS},
      {"degree", CLI_INT, &job->sh_degree, "D", "of gaussians: the degree of their spherical harmonics, 0 to 4 [3]", 0,
       CONIC_MAX_SH_DEGREE, .acts.with = "@gaussians"},
      {"ascii", CLI_FLAG, &job->is_ascii, NULL, "write text instead of binary", .acts.with = NOT_GAUSSIANS},
  };
  const char *scenes[64];
  int n_scenes;
  if (argc > (int)(sizeof scenes / sizeof *scenes))
    return cli_usage("make: too many arguments");
  int exit_code =
      cli_parse(job->base.session, options, (int)(sizeof options / sizeof *options), argc, argv, scenes, &n_scenes);
  if (exit_code == CLI_DONE)
    exit_code = check_arguments(scenes, n_scenes, job);
  scene->count = (size_t)job->count;
  scene->seed = job->seed;
  job->write.encoding = job->is_ascii ? CONIC_PLY_ASCII : CONIC_PLY_BINARY;
  job->write.circles = 1; /* a normal and a radius describe a circle in 8 bytes less than two axes */
  job->write.cutoff = scene->cutoff;
  return exit_code;
}

static conic_status append_batch(make_job *job, conic_scene *scene, size_t first, conic_splats *batch,
                                 conic_splats_writer *writer) {
  size_t rest = job->scene.count - first;
  double start = cli_seconds();
  conic_status status = conic_scene_sample(scene, first, rest < BATCH ? rest : BATCH, batch);
  double sampled = cli_seconds();
  job->base.stages[WORK].seconds += sampled - start;
  if (status == CONIC_OK)
    status = conic_splats_writer_append(writer, batch);
  job->base.stages[WRITE].seconds += cli_seconds() - sampled;
  return status;
}

static conic_status append_all(make_job *job, conic_scene *scene, conic_splats *batch, conic_splats_writer *writer) {
  conic_status status = CONIC_OK;
  for (size_t first = 0; first < job->scene.count && status == CONIC_OK; first += BATCH)
    status = append_batch(job, scene, first, batch, writer);
  if (status != CONIC_OK) {
    conic_splats_writer_abandon(writer);
    return status;
  }
  double start = cli_seconds();
  status = conic_splats_writer_finish(writer);
  job->base.stages[WRITE].seconds += cli_seconds() - start;
  return status;
}

static conic_status make_gaussians(make_job *job) {
  conic_context *context = job->base.session->context;
  conic_gaussians gaussians = {0};
  conic_gaussians_write_options options;
  conic_gaussians_write_options_init(&options);
  double start = cli_seconds();
  conic_status status = conic_gaussians_make(context, job->scene.count, job->sh_degree, job->seed, &gaussians);
  start = cli_build_end_stage(&job->base.stages[WORK], start);
  conic_gaussians_find_kind(job->base.output, &options.kind);
  if (status == CONIC_OK) /* files have the frame of their kind */
    status = conic_gaussians_turn(context, &gaussians, conic_gaussian_kind_frame(options.kind));
  if (status == CONIC_OK)
    status = conic_gaussians_write(context, job->base.output, &gaussians, &options);
  cli_build_end_stage(&job->base.stages[WRITE], start);
  conic_gaussians_release(context, &gaussians);
  return status;
}

static int make_scene(void *cookie) {
  make_job *job = cookie;
  if (job->is_gaussians)
    return cli_exit_of(make_gaussians(job));
  conic_context *context = job->base.session->context;
  const unsigned fields = conic_scene_fields(job->scene.type);
  size_t count = job->scene.count;
  conic_scene *scene = NULL;
  conic_splats_writer *writer;
  conic_splats batch;
  memset(&batch, 0, sizeof batch);
  double start = cli_seconds();
  conic_status status = conic_scene_create(context, &job->scene, &scene);
  job->base.stages[WORK].seconds = cli_seconds() - start;
  if (status == CONIC_OK)
    status = conic_splats_allocate(context, count < BATCH ? count : BATCH, fields, &batch);
  if (status == CONIC_OK)
    status = conic_splats_writer_open(context, job->base.output, count, fields, &job->write, &writer);
  if (status == CONIC_OK)
    status = append_all(job, scene, &batch, writer);
  conic_splats_release(context, &batch);
  conic_scene_destroy(scene);
  return cli_exit_of(status);
}

static void report_scene(cli_json *json, const void *cookie) {
  const make_job *job = cookie;
  const conic_repairs none = {0}; /* what is made is sound, but the keys are those of every command that builds */
  cli_json_text(json, "scene", job->is_gaussians ? gaussians_name : conic_scene_name(job->scene.type));
  cli_json_counts(json, NULL, {"points_in", job->scene.count}, {"points_out", job->scene.count});
  cli_build_report_cost(json, &job->base, "points_per_s", (double)job->scene.count / job->base.stages[WORK].seconds);
  cli_json_count(json, "threads", (uint64_t)conic_context_threads(job->base.session->context));
  cli_json_skipped(json, &none);
}

static void tell_scene(const void *cookie) {
  const make_job *job = cookie;
  conic_log(job->base.session->context, CONIC_LOG_INFO, job->is_gaussians ? "%s: %zu Gaussians" : "%s: %zu splats",
            job->base.output, job->scene.count);
}

static int run_make(cli_session *session, int argc, char **argv) {
  static const cli_build_steps steps = {make_scene, tell_scene, report_scene, NULL};
  make_job job = {.base = {session, .stages = {{"read", -1.0}, {"sample", .key = "work"}, {"write"}}}};
  return cli_build_run(&job, &steps, parse_scene(argc, argv, &job));
}

const cli_command cli_make = {
    .name = "make",
    .summary = "samples an analytic scene into splats, or makes one of Gaussians",
    .usage = "conic make SCENE -o OUT.ply [-n COUNT] [options]",
    .run = run_make,
    .description = "Samples a scene that is known by its formula. The same options always give the same file, byte for "
                   "byte. Splats are written as they come, so that there can be any number of them.",
    .words = &scene_words,
    .examples = {{"make a scan of a knot, which can be looked at from all sides", "conic make knot -o scan.ply"},
                 {"make noise as a scanner does", "conic make sphere -n 1M --noise 0.5 -o noisy.ply"}},
};
