/* conic make: samples an analytic scene into splats, batch by batch, so that memory does not grow with their number. */
#include <string.h>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"
#include "cli/outputs.h"
#include "cli/suggest.h"
#include "cli/tell.h"
#include "core/base/message.h"

/* Splats that are in memory at a time. */
#define BATCH ((size_t)1 << 20)

typedef struct make_job {
  conic_scene_options scene;
  conic_write_options write;
  const char *output;
  unsigned long long count, seed;
  int is_ascii;
  double work_seconds, write_seconds, total_seconds;
} make_job;

/* "plane, sphere, …", for messages. */
static void list_names(char *names, size_t room) {
  size_t used = 0;
  names[0] = '\0';
  for (int i = 0; i < CONIC_N_SCENES && used < room; i++)
    used += (size_t)snprintf(names + used, room - used, "%s%s", i ? ", " : "", conic_scene_name((conic_scene_type)i));
}

static void print_scenes(void) {
  puts("\nscenes:");
  for (int i = 0; i < CONIC_N_SCENES; i++)
    printf("  %-10s %s\n", conic_scene_name((conic_scene_type)i), conic_scene_summary((conic_scene_type)i));
}

static int find_scene(const char *name, conic_scene_type *type) {
  const char *nearest = NULL;
  char names[256];
  for (int i = 0; i < CONIC_N_SCENES; i++) {
    const char *candidate = conic_scene_name((conic_scene_type)i);
    if (strcmp(name, candidate) == 0) {
      *type = (conic_scene_type)i;
      return CLI_DONE;
    }
    nearest = cli_nearer_word(name, nearest, candidate);
  }
  if (nearest)
    return cli_usage("make: unknown scene %s; did you mean %s?", name, nearest);
  list_names(names, sizeof names);
  return cli_usage("make: unknown scene %s; there are %s", name, names);
}

static int check_arguments(const cli_session *session, const char *const *scenes, int n_scenes, make_job *job) {
  char names[256];
  if (n_scenes == 0) {
    list_names(names, sizeof names);
    return cli_usage("make: which scene? There are %s", names);
  }
  if (n_scenes > 1)
    return cli_usage("make: one scene at a time: what is %s?", scenes[1]);
  int exit_code = find_scene(scenes[0], &job->scene.type);
  if (exit_code == CLI_DONE && !job->output)
    exit_code = cli_usage("make: where to? It needs -o OUT.ply");
  if (exit_code == CLI_DONE)
    exit_code = cli_check_ending(job->output, "ply");
  return exit_code == CLI_DONE ? cli_check_outputs(session, &job->output, 1) : exit_code;
}

static int parse(cli_session *session, int argc, char **argv, make_job *job) {
  conic_scene_options *scene = &job->scene;
  conic_scene_options_init(scene);
  conic_write_options_init(&job->write);
  job->count = scene->count;
  const cli_option options[] = {
      {.name = "o",
       .type = CLI_TEXT,
       .value = &job->output,
       .argument = "OUT.ply",
       .help = "where to; - is standard output"},
      {.name = "n",
       .type = CLI_COUNT,
       .value = &job->count,
       .argument = "COUNT",
       .minimum = 1,
       .maximum = 4294967294.0,
       .help = "splats: 100000, 10k, 2M, 1e6 [100k]"},
      {.name = "seed",
       .type = CLI_COUNT,
       .value = &job->seed,
       .argument = "S",
       .help = "of the jitter, the noise and the terrain's shape [0]"},
      {.name = "jitter",
       .type = CLI_NUMBER,
       .value = &scene->jitter,
       .argument = "J",
       .maximum = 1e6,
       .help = "move each splat in its plane by up to J spacings [0]"},
      {.name = "noise",
       .type = CLI_NUMBER,
       .value = &scene->noise,
       .argument = "N",
       .maximum = 1e6,
       .help = "move each along its normal by a Gaussian of N spacings [0]"},
      {.name = "far",
       .type = CLI_VECTOR,
       .value = scene->offset,
       .argument = "X,Y,Z",
       .help = "move the scene away; writes doubles [0,0,0]"},
      {.name = "ascii", .type = CLI_FLAG, .value = &job->is_ascii, .help = "write text instead of binary"},
  };
  const char *scenes[64];
  int n_scenes;
  if (argc > (int)(sizeof scenes / sizeof *scenes))
    return cli_usage("make: too many arguments");
  int exit_code = cli_parse(session, options, (int)(sizeof options / sizeof *options), argc, argv, scenes, &n_scenes);
  if (exit_code < 0)
    print_scenes();
  if (exit_code == CLI_DONE)
    exit_code = check_arguments(session, scenes, n_scenes, job);
  scene->count = (size_t)job->count;
  scene->seed = job->seed;
  job->write.encoding = job->is_ascii ? CONIC_PLY_ASCII : CONIC_PLY_BINARY;
  job->write.circles = 1; /* a normal and a radius say all of a circle, in 8 bytes less than two axes */
  job->write.cutoff = scene->cutoff;
  return exit_code;
}

static conic_status append_batch(make_job *job, conic_scene *scene, size_t first, conic_splats *batch,
                                 conic_splats_writer *writer) {
  size_t rest = job->scene.count - first;
  double start = cli_seconds();
  conic_status status = conic_scene_sample(scene, first, rest < BATCH ? rest : BATCH, batch);
  double sampled = cli_seconds();
  job->work_seconds += sampled - start;
  if (status == CONIC_OK)
    status = conic_splats_writer_append(writer, batch);
  job->write_seconds += cli_seconds() - sampled;
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
  job->write_seconds += cli_seconds() - start;
  return status;
}

static conic_status make(cli_session *session, make_job *job) {
  const unsigned fields = conic_scene_fields(job->scene.type);
  size_t count = job->scene.count;
  conic_scene *scene = NULL;
  conic_splats_writer *writer;
  conic_splats batch;
  memset(&batch, 0, sizeof batch);
  double start = cli_seconds();
  conic_status status = conic_scene_create(session->context, &job->scene, &scene);
  job->work_seconds = cli_seconds() - start;
  if (status == CONIC_OK)
    status = conic_splats_allocate(session->context, count < BATCH ? count : BATCH, fields, &batch);
  if (status == CONIC_OK)
    status = conic_splats_writer_open(session->context, job->output, count, fields, &job->write, &writer);
  if (status == CONIC_OK)
    status = append_all(job, scene, &batch, writer);
  conic_splats_release(session->context, &batch);
  conic_scene_destroy(scene);
  return status;
}

static void report_seconds(cli_json *json, const make_job *job) {
  cli_json_object(json, "seconds");
  cli_json_number(json, "read", 0.0);
  cli_json_number(json, "work", job->work_seconds);
  cli_json_number(json, "write", job->write_seconds);
  cli_json_number(json, "total", job->total_seconds);
  cli_json_close(json);
}

/* Nothing is ever skipped: what is made is sound. The keys are those of every command that builds. */
static void report_skipped(cli_json *json) {
  const char *const reasons[] = {"nan", "zero", "duplicate", "isolated", "failed", "clip"};
  cli_json_object(json, "skipped");
  for (int i = 0; i < 6; i++)
    cli_json_count(json, reasons[i], 0);
  cli_json_close(json);
}

static int report(cli_session *session, const make_job *job) {
  cli_json_file *file;
  int exit_code = CLI_DONE;
  cli_json *json = cli_json_open(session, &file, &exit_code);
  if (!json)
    return exit_code;
  cli_json_text(json, "scene", conic_scene_name(job->scene.type));
  cli_json_count(json, "points_in", job->scene.count);
  cli_json_count(json, "points_out", job->scene.count);
  report_seconds(json, job);
  cli_json_number(json, "points_per_s", (double)job->scene.count / job->work_seconds);
  cli_json_count(json, "threads", (uint64_t)conic_context_threads(session->context));
  cli_json_count(json, "peak_rss_bytes", cli_peak_rss_bytes());
  report_skipped(json);
  return cli_json_finish(file);
}

static int run(cli_session *session, int argc, char **argv) {
  make_job job;
  memset(&job, 0, sizeof job);
  double start = cli_seconds();
  int exit_code = parse(session, argc, argv, &job);
  if (exit_code != CLI_DONE)
    return exit_code < 0 ? CLI_DONE : exit_code;
  exit_code = cli_session_open(session);
  if (exit_code != CLI_DONE)
    return exit_code;
  conic_status status = make(session, &job);
  job.total_seconds = cli_seconds() - start;
  if (status != CONIC_OK)
    return cli_exit_of(status);
  const cli_stage stages[] = {{"sample", job.work_seconds}, {"write", job.write_seconds}};
  conic_log(session->context, CONIC_LOG_INFO, "%s: %zu splats", job.output, job.scene.count);
  cli_tell_run(session, stages, 2, job.total_seconds);
  return report(session, &job);
}

const cli_command cli_make = {"make", "samples an analytic scene into splats",
                              "conic make SCENE -o OUT.ply [-n COUNT] [options]", run};
