/* The chart of scenes of the user's own: error over time, primitives and bytes, along the options of conic render that
 * trade one for the other. */
#pragma once

#include "bench/chart_ways.h"

/* What a point is the best for. */
typedef enum cli_chart_cost {
  CLI_COST_TIME, /* milliseconds a frame */
  CLI_COST_PRIMITIVES,
  CLI_COST_BYTES /* of memory, of what is drawn */
} cli_chart_cost;

enum { CLI_N_CHART_COSTS = 3 };

/* A scene drawn in one way. */
typedef struct cli_axis_point {
  cli_chart_way way;
  int is_of_work;  /* it changes the time, and no picture; or it is another program's */
  double ms;       /* the fastest frame, with the choice of what to draw */
  double spread;   /* from that to the fastest quarter's end, a share of it: what is nearer is not told apart */
  double floor_ms; /* what the frame must take at least on this machine, as conic bench --floor has it; 0: not known */
  double lod_ms;   /* of the frame: the choice */
  uint64_t splats, triangles, bytes; /* that the renderer was given; bytes are 0 of what streams */
  double stated_px;                  /* the error that the choice states; 0: nothing was chosen */
  uint64_t hash;                     /* of the picture's colours */
  cli_chart_error error;             /* against the first scene in full detail, over the pixels that it touches */
  size_t holes;                      /* pixels that it fills and nothing is drawn in */
  int is_best[CLI_N_CHART_COSTS];    /* no other is as cheap and nearer */
} cli_axis_point;

typedef struct cli_axis_chart {
  /* What is asked for. */
  cli_chart_asked asked;
  int truth_samples;   /* along an edge of a pixel; with 1, errors are against the first scene as it is drawn */
  double most_seconds; /* --time: a frame in that time; 0: not asked for */

  /* What came of it; `points` is the caller's to free. */
  int size[2]; /* of the pictures */
  cli_axis_point *points;
  int n_points;
} cli_axis_chart;

/* Measures every point. Returns the exit code, after a message. */
int cli_axis_chart_measure(cli_session *session, cli_axis_chart *chart);

double cli_axis_cost(const cli_axis_point *point, cli_chart_cost cost);

/* FOLDER/scene.csv and scene.svg. */
conic_status cli_axis_chart_write(const cli_session *session, const char *folder, const cli_axis_chart *chart);

/* The command that draws a point. */
void cli_axis_command(const cli_axis_chart *chart, const cli_axis_point *point, char *to, size_t room);

/* --time: the nearest point that is drawn in it; null: there is none, or nobody asked. */
const cli_axis_point *cli_axis_in_time(const cli_axis_chart *chart);

/* How many points an axis has. */
int cli_axis_count_of(const cli_axis_chart *chart, const char *axis);

/* What is best for its time, on standard output. */
void cli_axis_chart_print(const cli_axis_chart *chart);
