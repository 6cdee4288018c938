/* Measures the lines of a plan: opens their scenes, keeps the threads and the pictures that they share. */

#include "bench/bench_job.h"
#include "core/base/context_struct.h"

/* What the lines of a run share. */
typedef struct bench_run {
  cli_session *session; /* owns splats and pictures */
  cli_bench_job *job;
  cli_bench_counters counters;
  cli_session workers[CLI_BENCH_MOST_THREADS]; /* one a number of threads */
  int n_workers;
  cli_session planner; /* of --simulate-threads: one thread that plans as for more */
  cli_bench_scene scene;
  cli_session *owner; /* of the scene: what chooses does so with its own threads */
  double error_px;
  int i_scene, i_method, width, height; /* what `scene` and `pictures` are of; -1: nothing yet */
  cli_bench_pictures pictures;
} bench_run;

static int open_worker(const bench_run *r, int threads, cli_session *worker) {
  *worker = *r->session;
  worker->context = NULL;
  worker->threads = threads;
  return cli_session_open(worker);
}

static int open_workers(bench_run *r) {
  cli_bench_job *job = r->job;
  for (int i = 0; i < job->n_threads; i++) {
    int exit_code = open_worker(r, job->threads[i], &r->workers[i]);
    if (exit_code != CLI_DONE)
      return exit_code;
    r->n_workers++;
  }
  return job->n_simulated ? open_worker(r, 1, &r->planner) : CLI_DONE;
}

/* Numbers of threads that turn out the same (a machine of one) are measured once. */
static int is_repeated(const bench_run *r, int i_worker) {
  for (int i = 0; i < i_worker; i++)
    if (conic_context_threads(r->workers[i].context) == conic_context_threads(r->workers[i_worker].context))
      return 1;
  return 0;
}

static void close_pictures(bench_run *r) {
  conic_image_release(r->session->context, &r->pictures.reference);
  conic_image_release(r->session->context, &r->pictures.drawn);
}

/* A curve goes to pictures of gigabytes: it has the timed planes only. */
static conic_status open_pictures(bench_run *r, const cli_bench_line *line) {
  unsigned timed = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_WEIGHT;
  unsigned planes = r->job->is_curve ? timed : CONIC_DRAWN_PLANES;
  close_pictures(r);
  r->pictures.timed_planes = timed;
  conic_context *context = r->session->context;
  conic_status status = conic_image_allocate(context, line->width, line->height, planes, &r->pictures.reference);
  return status == CONIC_OK ? conic_image_allocate(context, line->width, line->height, planes, &r->pictures.drawn)
                            : status;
}

/* The scene, the pictures and the reference that the line needs, where the line before had others. */
static int turn_to(bench_run *r, const cli_bench_line *line, cli_session *worker) {
  cli_session *owner = line->chooses ? worker : r->session;
  int is_new_scene = r->i_scene != line->i_scene || r->owner != owner;
  int is_new_size = r->width != line->width || r->height != line->height;
  if (is_new_scene) {
    cli_bench_scene_release(r->owner, &r->scene);
    r->i_scene = -1;
    r->owner = owner;
    int i = line->i_scene;
    cli_bench_look look = r->job->look;
    look.chooses = line->chooses;
    int exit_code = cli_bench_scene_open(owner, r->job->scenes[i], r->job->is_file[i] ? &look : NULL, &r->scene);
    if (exit_code != CLI_DONE)
      return exit_code;
  }
  conic_status status = is_new_size ? open_pictures(r, line) : CONIC_OK;
  if (status == CONIC_OK &&
      (is_new_scene || is_new_size || r->i_method != line->i_method || r->error_px != line->error_px))
    status = cli_bench_refer(owner, &r->scene, line, &r->pictures.reference);
  r->i_scene = line->i_scene;
  r->i_method = line->i_method;
  r->error_px = line->error_px;
  r->width = line->width;
  r->height = line->height;
  return cli_exit_of(status);
}

static void name_line(const bench_run *r, cli_bench_line *line) {
  char size[32] = "", error[24] = "";
  if (line->width != 1024 || line->height != 1024)
    snprintf(size, sizeof size, "@%dx%d", line->width, line->height);
  if (line->chooses)
    snprintf(error, sizeof error, ":%gpx", line->error_px);
  snprintf(line->scene_name, sizeof line->scene_name, "%s", r->scene.name);
  snprintf(line->name, sizeof line->name, "%.31s%.15s%.15s/%.15s/%.15s/%d", r->scene.name, error, size,
           cli_bench_method_name(line->i_method), line->device ? line->device->name : conic_isa_name(line->isa),
           line->threads);
}

static cli_bench_patience patience_of(const cli_bench_job *job) {
  if (job->n_turns)
    return (cli_bench_patience){job->n_turns, job->n_turns, 0.0, 1};
  if (job->repeat)
    return (cli_bench_patience){job->repeat, job->repeat, 0.0, 1};
  return job->is_quick ? (cli_bench_patience){3, 5, 0.2, 1} : (cli_bench_patience){3, 21, 1.0, 5};
}

static conic_status measure_by(bench_run *r, cli_session *worker, const cli_bench_counters *counters,
                               cli_bench_line *line) {
  cli_bench_patience patience = patience_of(r->job);
  conic_status status = cli_bench_measure(worker, &r->scene, &patience, counters, &r->pictures, line);
  if (status == CONIC_OK && line->i_wrong_plane >= 0) {
    r->job->n_wrong++;
    cli_error(CLI_DIFFERENT, "%s: plane %s is not what plain C draws", line->name,
              conic_plane_describe((conic_plane)line->i_wrong_plane)->name);
  }
  return status;
}

static int measure_line(bench_run *r, cli_bench_line *line, cli_session *worker) {
  int exit_code = turn_to(r, line, worker);
  if (exit_code != CLI_DONE)
    return exit_code;
  line->threads = conic_context_threads(worker->context);
  name_line(r, line);
  return cli_exit_of(measure_by(r, worker, &r->counters, line));
}

/* The line's frames by one thread, shared out as for `threads`, and the schedule of their tasks. */
static conic_status simulate_threads(bench_run *r, const cli_bench_line *line, int threads,
                                     cli_bench_schedule *schedule) {
  cli_bench_trace trace = {.n_rows = 0};
  cli_bench_line planned = *line;
  double start_ms[CONIC_MAX_THREADS];
  planned.trace = &trace;
  planned.schedules = NULL;
  conic_parallel_plan(r->planner.context, threads, cli_bench_trace_watch, &trace);
  conic_status status = cli_bench_starts_measure(threads, start_ms);
  if (status == CONIC_OK)
    status = measure_by(r, &r->planner, NULL, &planned);
  conic_parallel_plan(r->planner.context, 1, NULL, NULL);
  if (status == CONIC_OK)
    status = cli_bench_trace_settle(&trace);
  if (status == CONIC_OK)
    cli_bench_schedule_make(&trace, threads, start_ms, schedule);
  cli_bench_trace_release(&trace);
  return status;
}

static int simulate_line(bench_run *r, cli_bench_line *line) {
  const cli_bench_job *job = r->job;
  line->schedules = calloc((size_t)job->n_simulated, sizeof *line->schedules);
  if (!line->schedules)
    return cli_error(CLI_RESOURCE, "bench: out of memory");
  int exit_code = turn_to(r, line, &r->planner);
  for (int i = 0; i < job->n_simulated && exit_code == CLI_DONE; i++) {
    exit_code = cli_exit_of(simulate_threads(r, line, job->simulated[i], &line->schedules[i]));
    line->n_schedules++;
  }
  return exit_code;
}

/* Which of the workers has the line's threads. */
static int worker_of(const bench_run *r, const cli_bench_line *line) {
  int i = 0;
  while (r->job->threads[i] != line->threads)
    i++;
  return i;
}

static int measure_lines(bench_run *r, int prints) {
  cli_bench_job *job = r->job;
  int n_measured = 0, exit_code = CLI_DONE;
  for (int i = 0; i < job->n_lines && exit_code == CLI_DONE; i++) {
    cli_bench_line *line = &job->lines[n_measured];
    *line = job->lines[i];
    int i_worker = worker_of(r, line);
    if (!line->device && is_repeated(r, i_worker))
      continue;
    exit_code = measure_line(r, line, &r->workers[i_worker]);
    if (prints && exit_code == CLI_DONE && n_measured == 0)
      cli_bench_print_head();
    if (prints && exit_code == CLI_DONE)
      cli_bench_print_line(line);
    if (job->n_simulated && i_worker == 0 && !line->device && exit_code == CLI_DONE)
      exit_code = simulate_line(r, line);
    n_measured++;
  }
  job->n_lines = n_measured;
  return exit_code;
}

static int measure_machines(bench_run *r) {
  for (int i = 0; i < r->n_workers; i++) {
    if (is_repeated(r, i))
      continue;
    conic_status status = cli_bench_machine_measure(&r->workers[i], &r->job->machines[r->job->n_machines]);
    if (status != CONIC_OK)
      return cli_exit_of(status);
    r->job->n_machines++;
  }
  return CLI_DONE;
}

int cli_bench_run(cli_session *session, cli_bench_job *job) {
  int prints = cli_json_leaves_text(session);
  bench_run *r = calloc(1, sizeof *r);
  if (!r)
    return cli_error(CLI_RESOURCE, "bench: out of memory");
  r->session = session;
  r->job = job;
  r->i_scene = r->i_method = -1;
  r->owner = session;
  r->counters = cli_bench_counters_open();
  int exit_code = open_workers(r);
  if (exit_code == CLI_DONE && (job->is_machine || job->is_floor))
    exit_code = measure_machines(r);
  if (exit_code == CLI_DONE)
    exit_code = measure_lines(r, prints);
  close_pictures(r);
  cli_bench_scene_release(r->owner, &r->scene);
  for (int i = 0; i < r->n_workers; i++)
    cli_session_close(&r->workers[i]);
  if (r->planner.context)
    cli_session_close(&r->planner);
  cli_bench_counters_close(&r->counters);
  free(r);
  return exit_code;
}
