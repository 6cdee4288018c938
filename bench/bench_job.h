/* One `conic bench`: what was asked for, the lines that this means, and what they are measured with. */
#pragma once

#include "bench/bench.h"

enum { CLI_BENCH_MOST_SCENES = 64, CLI_BENCH_MOST_THREADS = 8 };

typedef struct cli_bench_job {
  /* What was asked for; texts are null where nothing was. */
  const char *scenes_text, *methods_text, *profiles_text, *isa_text, *threads_text, *simulated_text, *errors_text,
      *old_path;
  const char **files;
  int n_files;
  cli_bench_look look; /* at the files */
  cli_device device;
  int size[2], repeat, n_turns;
  int is_quick, is_curve, is_machine, is_floor, is_kernels;
  const char *command;      /* to simulate whole; null: scenes are drawn */
  const char *publish_path; /* null: nothing is to be compared with other machines */

  /* What it means (bench/bench_plan.c). */
  char scene_names[CLI_BENCH_MOST_SCENES][32];
  const char *scenes[CLI_BENCH_MOST_SCENES]; /* names, or the paths of files */
  int is_file[CLI_BENCH_MOST_SCENES], is_gaussian[CLI_BENCH_MOST_SCENES], n_scenes;
  int chooses[CLI_BENCH_MOST_SCENES]; /* of files */
  double errors[CLI_BENCH_MOST_THREADS];
  int n_errors; /* at least one: 0, all there is */
  int methods[CLI_BENCH_N_METHODS], n_methods;
  int profiles[CONIC_N_GAUSSIAN_PROFILES], n_profiles; /* numbers past the methods' */
  conic_isa isas[CONIC_N_ISAS];
  int n_isas;
  int threads[CLI_BENCH_MOST_THREADS], n_threads;
  int simulated[CLI_BENCH_MOST_THREADS], n_simulated; /* numbers of threads */
  cli_bench_line *lines;
  int n_lines;

  /* What came of it. */
  cli_bench_machine machines[CLI_BENCH_MOST_THREADS];
  int n_machines, n_wrong;
} cli_bench_job;

/* Fills in the lines. Returns the exit code, after a message. The caller frees job->lines. */
int cli_bench_plan(cli_bench_job *job);

/* Runs job->command for each number of threads; the only line has the schedules. Returns the exit code, after a
 * message. */
int cli_bench_whole_run(cli_bench_job *job);

/* Measures every line. Returns the exit code, after a message; 1 where a picture was wrong. */
int cli_bench_run(cli_session *session, cli_bench_job *job);
