/* What the parts of `conic bench` share: scenes, the lines that are measured, the machine beneath.
 * docs/reference/performance.md has the definitions. */
#pragma once

#include "cli/device_option.h"
#include "cli/json_write.h"

/* --- scenes (bench/bench_scene.c) --- */

/* How files are looked at; what is made has a way of its own. */
typedef struct cli_bench_look {
  const char *camera_path; /* null: framed; its size is not taken */
  const char *view;        /* of it; null: the only one */
  int culls_back;
  int chooses; /* what is drawn is chosen by each frame: cli_bench_file_chooses */
} cli_bench_look;

typedef struct cli_bench_scene {
  char name[32]; /* "sphere-1M" */
  conic_source *source;
  const conic_splats *splats; /* the source's; null where each frame chooses its own */
  int is_framed, has_camera;  /* a file's camera; neither: the built-in one */
  conic_camera camera;        /* of has_camera */
  int cull_back;
  int is_gaussian; /* there are these in place of the source */
  conic_gaussians gaussians;
  conic_gaussian_planes composited;
} cli_bench_scene;

/* Whether frames of the file choose what they draw: hybrids always, hierarchies where errors are asked for. */
int cli_bench_file_chooses(const char *path, int has_errors);

/* Makes the scene of a name, or, where there is a look at it, reads the file of that name. Released by
 * cli_bench_scene_release, also after a failure. Returns the exit code, after a message. */
int cli_bench_scene_open(cli_session *session, const char *name, const cli_bench_look *look, cli_bench_scene *scene);
void cli_bench_scene_release(cli_session *session, cli_bench_scene *scene);
/* Whether a scene of that name can be made: CLI_DONE, or CLI_USAGE after a message; and whether it is of Gaussians. */
int cli_bench_scene_check(const char *name, int *is_gaussian);
/* What can be asked for, for the help: the i-th name, and what it is; null past the last. */
const char *cli_bench_scene_at(int i, const char **about);
/* A view of a file of cameras, whatever the size of its pictures; null: its only one. */
conic_status cli_bench_camera_read(cli_session *session, const char *path, const char *view, conic_camera *camera);
/* Turns a camera about the scene's centre and what points up, by so many turns. */
void cli_bench_scene_turn(const cli_bench_scene *scene, double turns, conic_camera *camera);
/* The camera that it is seen by, brought to the size. */
conic_status cli_bench_scene_camera(const cli_bench_scene *scene, int width, int height, conic_camera *camera);

/* --- methods --- */

/* conic, ray, affine, point, disc, auto; and nearest: conic's single pass, where the nearest splat wins. */
typedef struct cli_bench_method {
  const char *name;
  conic_method method;
  int passes;
} cli_bench_method;

enum { CLI_BENCH_N_METHODS = 7 };
extern const cli_bench_method cli_bench_methods[CLI_BENCH_N_METHODS];

/* After the methods come the profiles of Gaussian scenes. */
static inline const char *cli_bench_method_name(int i_method) {
  return i_method < CLI_BENCH_N_METHODS
             ? cli_bench_methods[i_method].name
             : conic_gaussian_profile_name((conic_gaussian_profile)(i_method - CLI_BENCH_N_METHODS));
}

/* --- what a stage must at least do (bench/bench_work.c) --- */

enum { CLI_BENCH_N_STAGES = 5 };
extern const char *const cli_bench_stages[CLI_BENCH_N_STAGES]; /* "setup", "bin" … */

typedef struct cli_bench_work {
  double read_bytes, written_bytes; /* to and from memory, if caches held everything that is used twice in a row */
  double operations;                /* + − × ÷ √ and comparisons of single numbers */
  double moved_bytes;               /* from the cache to places in memory that lie in another order */
  double divisions;                 /* of these, ÷ and √, which take longer */
  double gathered;                  /* numbers that are taken by an index */
} cli_bench_work;

void cli_bench_work_of(const conic_render_statistics *statistics, const conic_splats *splats, const conic_image *image,
                       int passes, cli_bench_work work[CLI_BENCH_N_STAGES]);

double cli_bench_stage_ms(const conic_render_milliseconds *ms, int i_stage);

/* --- counters (bench/bench_counters.c) --- */

/* What this process and the threads that it will start spend outside the kernel; -1 where the machine does not count,
 * or keeps it to itself. */
typedef struct cli_bench_counters {
  int cycles, instructions;
} cli_bench_counters;

cli_bench_counters cli_bench_counters_open(void);
/* What one of them has counted; NaN where there is none. */
double cli_bench_counter_read(int counter);
void cli_bench_counters_close(const cli_bench_counters *counters);

/* --- more threads than there are (bench/bench_trace.c, bench_schedule.c) --- */

/* A part of a frame that threads share. Those of the same name are one in a schedule. */
typedef struct cli_bench_region {
  const char *name;
  size_t n_tasks;
} cli_bench_region;

/* How long each task of frames took that one thread drew, while all was shared out as for more, and what lay between
 * the regions. Frames that differ in their regions from the last one are forgotten. */
typedef struct cli_bench_trace {
  double now;    /* when the part began that is measured */
  int is_whole;  /* of a command: by the processor's time, as it runs but a few times, whoever else is there */
  int is_broken; /* there was no memory */
  cli_bench_region *regions, *last_regions;
  size_t n_regions, n_last_regions, regions_room, last_regions_room;
  double *seconds, *kept; /* of each region what was before it and its tasks, and what was after all: a row */
  size_t n_seconds, seconds_room, n_a_row, n_rows, kept_room;
} cli_bench_trace;

void cli_bench_trace_begin(cli_bench_trace *trace);
void cli_bench_trace_end(cli_bench_trace *trace);
/* A conic_region_watch, whose cookie is the trace. */
void cli_bench_trace_watch(void *cookie, const char *name, size_t n_tasks, size_t n_done);
/* Medians over the frames, the first left out where there are more, in n_a_row places at the beginning of `kept`. */
conic_status cli_bench_trace_settle(cli_bench_trace *trace);
void cli_bench_trace_release(cli_bench_trace *trace);

enum { CLI_BENCH_MOST_REGIONS = 64 };

/* Where a schedule loses time against its work shared out evenly. */
typedef enum cli_bench_loss {
  CLI_BENCH_LOSS_SERIAL,  /* what one thread does alone */
  CLI_BENCH_LOSS_STARTS,  /* until the threads have begun */
  CLI_BENCH_LOSS_LONGEST, /* one task is longer than its share */
  CLI_BENCH_LOSS_UNEVEN,  /* threads wait at the end of a region: too few tasks */
  CLI_BENCH_N_LOSSES
} cli_bench_loss;

typedef struct cli_bench_scheduled {
  char name[32];
  size_t n_tasks, n_regions;
  double serial_ms;               /* what one thread does before them */
  double work_ms, ms, longest_ms; /* all tasks one after the other; by the threads; the longest task */
  double lost_ms[CLI_BENCH_N_LOSSES];
} cli_bench_scheduled;

typedef struct cli_bench_schedule {
  int threads;
  double start_ms;                    /* until the last thread has begun a region */
  double work_ms, serial_ms, ms;      /* by one thread; of that, outside of regions; by all */
  double lost_ms[CLI_BENCH_N_LOSSES]; /* of the whole frame */
  int n_regions;
  cli_bench_scheduled regions[CLI_BENCH_MOST_REGIONS]; /* the last is of all others, where there are more */
} cli_bench_schedule;

/* When so many threads of this machine begin a region's work, after its call; rising. */
conic_status cli_bench_starts_measure(int threads, double *start_ms);

/* How a context of so many threads would do a settled trace: tasks in order, each by the first thread that is free. */
void cli_bench_schedule_make(const cli_bench_trace *trace, int threads, const double *start_ms,
                             cli_bench_schedule *schedule);
/* What loses the most, and the region, null where it is none. */
cli_bench_loss cli_bench_schedule_limit(const cli_bench_schedule *schedule, const char **region);

/* --- one line (bench/bench_frame.c) --- */

enum { CLI_BENCH_MOST_FRAMES = 1000 };

typedef struct cli_bench_line {
  /* What is measured. */
  char name[96]; /* "sphere-1M/conic/avx512/2": what --compare finds it by */
  char scene_name[32];
  int i_scene, i_method; /* of a Gaussian scene the profile's number past the methods' */
  conic_isa isa;
  cli_device *device; /* null: this machine's processor */
  int threads, width, height;
  int chooses;     /* the frame chooses what it draws … */
  double error_px; /* … within this error; 0: all there is, a hybrid as built */
  int n_turns;     /* a warm frame from each of so many directions about the scene; 0: all from one */

  /* What came of it. */
  conic_render_statistics statistics; /* ms are medians over the warm frames; of a turntable means */
  int n_frames;                       /* warm ones */
  double first_ms, quartile_ms[2];    /* of the first frame; of the warm ones */
  double interval;                    /* the part of the median by which it may be off, with 95 %; 1: nobody knows */
  double cpu_ms;                      /* of the processor, a frame, over all threads */
  double cycles, instructions;        /* likewise; NaN where nobody counts */
  cli_bench_work work[CLI_BENCH_N_STAGES];
  uint64_t hash[CONIC_N_PLANES];         /* 0 where the plane was not drawn */
  int i_wrong_plane;                     /* the first that differs from the scalar reference; -1: none */
  double old_ms[CLI_BENCH_N_STAGES + 1]; /* of --compare: stages and frame; NaN where it has no such line */
  double old_quartile_ms[2];             /* likewise; NaN where they are not told */
  cli_bench_trace *trace;                /* null: nobody asks */
  cli_bench_schedule *schedules;         /* of --simulate-threads; freed by who frees the lines */
  int n_schedules;
} cli_bench_line;

/* The pictures of one scene and method. */
typedef struct cli_bench_pictures {
  conic_image reference, drawn;
  unsigned timed_planes; /* of those that both have */
} cli_bench_pictures;

/* The first plane that both images have and that differs in a bit; -1 where none does. */
int cli_bench_difference(const conic_image *a, const conic_image *b);

/* Median of n ≥ 1 values, and the quartiles on both sides where `quartiles` is not null; sorts them. */
double cli_bench_median(double *values, size_t n, double quartiles[2]);

/* Draws the reference of the line's scene, method and size by plain C. */
conic_status cli_bench_refer(cli_session *session, cli_bench_scene *scene, const cli_bench_line *line,
                             conic_image *reference);

/* Measures the line with the worker's threads: one first frame, then warm ones until there are `most`, or at least
 * `least` and the seconds are over; and on to so many times both, until the median is known to CLI_BENCH_SURE. Null
 * `counters`: nobody counts. */
typedef struct cli_bench_patience {
  int least, most;
  double seconds;
  int times;
} cli_bench_patience;
#define CLI_BENCH_SURE 0.02

conic_status cli_bench_measure(cli_session *worker, cli_bench_scene *scene, const cli_bench_patience *patience,
                               const cli_bench_counters *counters, cli_bench_pictures *pictures, cli_bench_line *line);

/* --- Gaussians (bench/bench_gaussians.c) --- */

int cli_bench_is_gaussian_file(const char *path);

/* As conic render frames the file. */
conic_status cli_bench_gaussians_frame(conic_context *context, const char *path, int width, int height,
                                       conic_camera *camera);

/* What cli_bench_scene_open does for them, and its end. */
conic_status cli_bench_gaussians_read(cli_session *session, const char *path, const cli_bench_look *look,
                                      cli_bench_scene *scene);
conic_status cli_bench_gaussians_make(cli_session *session, size_t count, cli_bench_scene *scene);
void cli_bench_gaussians_release(cli_session *session, cli_bench_scene *scene);

/* Draws a frame of the line, Z, count and id if the image has them, in which pairs of a Gaussian and a pixel are
 * fragments. The second, which is no part of the frame, puts its colours into the image, clears what no Gaussians have,
 * and counts covered pixels. */
conic_status cli_bench_gaussians_draw(conic_context *context, cli_bench_scene *scene, const conic_camera *camera,
                                      const cli_bench_line *line, const conic_image *image,
                                      conic_render_statistics *statistics);
void cli_bench_gaussians_show(const cli_bench_scene *scene, conic_image *image, conic_render_statistics *statistics);

/* The line's work, by its statistics. */
void cli_bench_gaussians_work(const cli_bench_scene *scene, cli_bench_line *line);

/* --- the machine (bench/bench_machine.c) --- */

typedef struct cli_bench_machine {
  int threads;
  double read_bytes_per_s, write_bytes_per_s, copy_bytes_per_s; /* past all caches; a copy counts its bytes once */
  double moved_bytes_per_s; /* lines of 64 bytes, to 256 places by turns, as records go to their tiles */
  double operations_per_s;  /* multiplications and additions, apart, in the widest vectors */
  double divisions_per_s;   /* divisions and roots, half of each, likewise */
  double gathered_per_s;    /* numbers of four bytes that vectors take by their indices from 128 KiB */
} cli_bench_machine;

conic_status cli_bench_machine_measure(cli_session *worker, cli_bench_machine *machine);

/* --- reports (bench/bench_report.c, bench_floor.c, bench_compare.c) --- */

void cli_bench_print_head(void);
void cli_bench_print_line(const cli_bench_line *line);
void cli_bench_report_line(cli_json *json, const cli_bench_line *line);

void cli_bench_print_machine(const cli_bench_machine *machine);
void cli_bench_report_machine(cli_json *json, const cli_bench_machine *machines, int n_machines);

/* What each stage must take at least, beside what it takes: the longer of memory's time and the vectors'. */
double cli_bench_floor_ms(const cli_bench_work *work, const cli_bench_machine *machine);
void cli_bench_print_floor(const cli_bench_line *line, const cli_bench_machine *machine);
void cli_bench_report_floor(cli_json *json, const cli_bench_line *line, const cli_bench_machine *machine);
void cli_bench_report_shares(cli_json *json, const cli_bench_line *line, const cli_bench_machine *machine);

/* Nothing where the line has none. */
void cli_bench_print_schedules(const cli_bench_line *line);
void cli_bench_report_schedules(cli_json *json, const cli_bench_line *line);

/* The cost of a line's frame over what it is made of. */
void cli_bench_print_curve(const cli_bench_line *lines, int n_lines);

/* Reads the times of an earlier run into the lines of the same names. Errors: INPUT, MEMORY. */
conic_status cli_bench_read_old(cli_session *session, const char *path, cli_bench_line *lines, int n_lines);
void cli_bench_print_comparison(const char *path, const cli_bench_line *lines, int n_lines);
