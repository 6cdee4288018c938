/* conic bench: how fast, where the time goes, and that the pictures are right meanwhile. */

#include "bench/bench_job.h"
#include "bench/loops/cross_all.h"
#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/scene/views.h"
#include "cli/shell.h"
#include "core/base/machine.h"

static int parse(cli_session *session, int argc, char **argv, cli_bench_job *job) {
  static const char *const cull_words[] = {"none", "back", NULL};
  job->size[0] = job->size[1] = 1024;
  job->device.name = "cpu";
  const cli_option options[] = {
      {"scenes", CLI_TEXT, &job->scenes_text, "LIST", "scenes, or all; files are IN [all, or the files alone]"},
      {"methods", CLI_TEXT, &job->methods_text, "LIST",
       "conic, ray, affine, point, disc, auto, nearest, or all [conic]"},
      {"profiles", CLI_TEXT, &job->profiles_text, "LIST",
       "of Gaussian scenes: those of conic render, or all [gsplat-1.6,exact]"},
      {"isa", CLI_TEXT, &job->isa_text, "LIST", "auto, scalar, sse2, avx2, avx512, neon, or all [auto]"},
      {"threads", CLI_TEXT, &job->threads_text, "LIST", "numbers of threads; 0: all that there are [1,0]"},
      {"simulate-threads", CLI_TEXT, &job->simulated_text, "LIST",
       "also by a schedule of the tasks that one thread took, what so many would need"},
      {"command", CLI_TEXT, &job->command, "WORDS", "of a whole command of conic, in place of frames",
       .acts.with = "simulate-threads"},
      {"size", CLI_SIZE, job->size, "WxH", "pixels [1024x1024]", 1, 65535},
      {"camera", CLI_TEXT, &job->look.camera_path, "FILE", "camera of the files, as of conic render [framed]",
       .acts.with = "@"},
      {"view", CLI_TEXT, &job->look.view, "VIEW", "of --camera: an index from 0, or a name [the only one]",
       .acts.with = "camera"},
      {"cull", CLI_CHOICE, &job->look.culls_back, "WHAT", "of the files: none, or back [none]", .choices = cull_words,
       .acts.with = "@"},
      {"device", CLI_TEXT, &job->device.name, "NAME",
       "each scene and method on opencl[:P.D][:gather|:lanes] too [cpu]"},
      {"allow-inexact", CLI_FLAG, &job->device.allow_inexact, NULL, "also a device that does not round correctly",
       .acts.with = "device"},
      {"error", CLI_TEXT, &job->errors_text, "LIST",
       "of files that choose what they draw, in pixels; 0: all there is [0 for .chy; the others are read whole]",
       .acts.with = "@"},
      CLI_OUTSIDE(session),
      {"turntable", CLI_INT, &job->n_turns, "N", "N warm frames, all around the scene, and their mean", 1,
       CLI_BENCH_MOST_FRAMES},
      {"repeat", CLI_INT, &job->repeat, "N", "warm frames a line [3 to 21, about a second]", 1, CLI_BENCH_MOST_FRAMES,
       .acts.with = "!turntable"},
      {"quick", CLI_FLAG, &job->is_quick, NULL, "fewer scenes, fewer frames"},
      {"compare", CLI_TEXT, &job->old_path, "OLD.json", "ratios to an earlier run's --json"},
      {"publish", CLI_TEXT, &job->publish_path, "FILE.json",
       "the lines that machines are compared by, with the names of processor, system and compiler"},
      {"curve", CLI_FLAG, &job->is_curve, NULL, "the cost over 10 k to 16 M splats, and over 256² to 8192² pixels"},
      {"machine", CLI_FLAG, &job->is_machine, NULL, "how fast the machine reads, writes, copies and computes"},
      {"kernels", CLI_FLAG, &job->is_kernels, NULL, "each loop alone, by each instruction set, beside plain C"},
      {"floor", CLI_FLAG, &job->is_floor, NULL, "what each stage must take at least, beside what it takes"},
  };
  job->files = calloc((size_t)argc, sizeof *job->files);
  if (!job->files)
    return cli_error(CLI_RESOURCE, "bench: out of memory");
  int exit_code =
      cli_parse(session, options, (int)(sizeof options / sizeof *options), argc, argv, job->files, &job->n_files);
  if (exit_code == CLI_DONE)
    exit_code = cli_device_check(session, &job->device);
  if (exit_code == CLI_DONE && job->look.view && cli_views_are_all(job->look.view))
    exit_code = cli_usage("bench: --view is one of a file of cameras");
  if (exit_code == CLI_DONE && job->is_curve && (job->scenes_text || job->n_files || job->is_floor))
    exit_code = cli_usage("bench: --curve has scenes of its own");
  if (exit_code == CLI_DONE && job->publish_path && (session->json_path || job->is_curve))
    exit_code = cli_usage("bench: --publish writes what --json would, of lines of its own");
  else if (exit_code == CLI_DONE && job->publish_path)
    session->json_path = job->publish_path;
  if (exit_code == CLI_DONE && job->simulated_text && (job->n_turns || job->is_kernels))
    exit_code = cli_usage("bench: --simulate-threads is of frames that are alike, not of --turntable or --kernels");
  if (exit_code == CLI_DONE && job->is_kernels &&
      (job->scenes_text || job->n_files || job->is_curve || job->is_machine || job->is_floor || session->json_path))
    exit_code = cli_usage("bench: --kernels measures and prints nothing else");
  return exit_code == CLI_DONE && !job->is_kernels ? cli_bench_plan(job) : exit_code;
}

static const cli_bench_machine *machine_of(const cli_bench_job *job, const cli_bench_line *line) {
  for (int i = 0; i < job->n_machines; i++)
    if (job->machines[i].threads == line->threads)
      return &job->machines[i];
  return NULL;
}

/* Lines whose frames are so far apart that the median is not sure, or take half as long again as their threads' share
 * of the processor's time. */
static void warn_of_noise(const cli_session *session, const cli_bench_job *job) {
  int n_wide = 0, n_waiting = 0;
  for (int i = 0; i < job->n_lines; i++) {
    const cli_bench_line *line = &job->lines[i];
    const double frame = line->statistics.ms.frame;
    n_wide += !line->n_turns && line->interval > CLI_BENCH_SURE;
    n_waiting += !line->device && frame > 1.5 * line->cpu_ms / (double)line->threads + 1.0;
  }
  if (n_wide || n_waiting)
    cli_warn(session,
             "bench: noise: of %d lines, %d have medians not known to 2 %%, and %d wait for the processor: leave "
             "the machine alone, or --repeat more",
             job->n_lines, n_wide, n_waiting);
}

static void print(const cli_session *session, const cli_bench_job *job) {
  warn_of_noise(session, job);
  if (!cli_json_leaves_text(session))
    return;
  if (job->is_curve)
    cli_bench_print_curve(job->lines, job->n_lines);
  if (job->n_machines && job->n_lines)
    puts("");
  for (int i = 0; i < job->n_machines; i++)
    cli_bench_print_machine(&job->machines[i]);
  for (int i = 0; i < job->n_lines && job->is_floor; i++)
    cli_bench_print_floor(&job->lines[i], machine_of(job, &job->lines[i]));
  for (int i = 0; i < job->n_lines; i++)
    cli_bench_print_schedules(&job->lines[i]);
  if (job->old_path)
    cli_bench_print_comparison(job->old_path, job->lines, job->n_lines);
}

static void report_host(cli_json *json) {
  char processor[128], system[128];
  cli_shell_name_host(processor, sizeof processor, system, sizeof system);
  cli_json_object(json, "host");
  cli_json_text(json, "processor", processor);
  cli_json_count(json, "processors", (uint64_t)conic_machine_threads());
  cli_json_text(json, "system", system);
#if defined(__clang__)
  cli_json_text(json, "compiler", "clang " __clang_version__);
#else
  cli_json_text(json, "compiler", "gcc " __VERSION__);
#endif
  cli_json_close(json);
}

static void report_bench(cli_json *json, const void *cookie) {
  const cli_bench_job *job = cookie;
  cli_json_text(json, "version", conic_version());
  report_host(json);
  if (job->n_machines)
    cli_bench_report_machine(json, job->machines, job->n_machines);
  if (job->command) {
    cli_json_text(json, "command", job->command);
    cli_bench_report_schedules(json, job->lines);
  }
  cli_json_object(json, "lines");
  for (int i = 0; i < job->n_lines && !job->command; i++)
    cli_bench_report_line(json, &job->lines[i]);
  cli_json_close(json);
  if (job->is_floor) {
    cli_json_object(json, "floor_ms");
    for (int i = 0; i < job->n_lines; i++)
      cli_bench_report_floor(json, &job->lines[i], machine_of(job, &job->lines[i]));
    cli_json_close(json);
    cli_json_object(json, "floor_share");
    for (int i = 0; i < job->n_lines; i++)
      cli_bench_report_shares(json, &job->lines[i], machine_of(job, &job->lines[i]));
    cli_json_close(json);
  }
  cli_json_counts(json, NULL, {"wrong_pictures", (uint64_t)job->n_wrong}, {"peak_rss_bytes", cli_peak_rss_bytes()});
}

/* That the device is there is known before the minutes are spent, too. */
static conic_status find_device(cli_session *session, cli_bench_job *job) {
  conic_renderer *renderer;
  conic_status status = cli_device_open(session, &job->device, &renderer);
  if (status == CONIC_OK)
    conic_renderer_destroy(renderer);
  return status;
}

static int measure_plan(cli_session *session, cli_bench_job *job) {
  if (job->old_path) { /* that it can be read is known before the minutes are spent */
    conic_status status = cli_bench_read_old(session, job->old_path, NULL, 0);
    if (status != CONIC_OK)
      return cli_exit_of(status);
  }
  int exit_code = cli_exit_of(find_device(session, job));
  if (exit_code == CLI_DONE)
    exit_code = cli_bench_run(session, job);
  if (exit_code == CLI_DONE && job->old_path)
    exit_code = cli_exit_of(cli_bench_read_old(session, job->old_path, job->lines, job->n_lines));
  if (exit_code != CLI_DONE)
    return exit_code;
  print(session, job);
  exit_code = cli_json_write(session, report_bench, job);
  return exit_code == CLI_DONE && job->n_wrong ? CLI_DIFFERENT : exit_code;
}

static int simulate_whole(cli_session *session, cli_bench_job *job) {
  int exit_code = cli_bench_whole_run(job);
  if (exit_code == CLI_DONE)
    exit_code = cli_session_open(session);
  if (exit_code == CLI_DONE && cli_json_leaves_text(session))
    cli_bench_print_schedules(job->lines);
  return exit_code == CLI_DONE ? cli_json_write(session, report_bench, job) : exit_code;
}

static int run_bench(cli_session *session, int argc, char **argv) {
  cli_bench_job *job = calloc(1, sizeof *job);
  if (!job)
    return cli_error(CLI_RESOURCE, "bench: out of memory");
  int exit_code = parse(session, argc, argv, job);
  session->draws_many_frames = 1;
  if (exit_code == CLI_DONE)
    exit_code = cli_check_outputs(session, NULL, 0);
  if (exit_code == CLI_DONE && job->is_kernels)
    exit_code = cli_cross_all(CONIC_CROSS_SEED, job->is_quick ? 1 : 7) ? CLI_DIFFERENT : CLI_DONE;
  else if (exit_code == CLI_DONE && job->command)
    exit_code = simulate_whole(session, job);
  else if (exit_code == CLI_DONE)
    exit_code = cli_session_open(session);
  if (exit_code == CLI_DONE && !job->is_kernels && !job->command)
    exit_code = measure_plan(session, job);
  for (int i = 0; i < job->n_lines; i++)
    free(job->lines[i].schedules);
  free(job->lines);
  free(job->files);
  free(job);
  return exit_code < 0 ? CLI_DONE : exit_code;
}

static const cli_words bench_words = {"scenes, each also with a number of splats (sphere-4M)", "scenes",
                                      cli_bench_scene_at};

const cli_command cli_bench = {
    .name = "bench",
    .summary = "measures stages, methods and instruction sets",
    .usage = "conic bench [IN…] [options]",
    .run = run_bench,
    .description = "Draws scenes that it makes, and files, again and again, and prints a table of medians: "
                   "milliseconds of each stage, splats a second, memory. Run it on a machine that does nothing else.",
    .words = &bench_words,
    .examples = {{"measure a scene of four million splats by three methods",
                  "conic bench --scenes sphere-4M --methods conic,ray,affine"},
                 {"compare with an earlier run", "conic bench --quick --compare before.json"}},
};
