/* The chart of scenes of the user's own: error over time along the options that trade one for the other. */
#ifndef CONIC_CHART_AXES_H
#define CONIC_CHART_AXES_H

#include "bench/chart.h"
#include "cli/device_option.h"

enum { CLI_N_CHART_AXES = 10, CLI_MOST_CHART_SCENES = 8, CLI_MOST_BESIDE = 24 };

/* "method", "kernel", "prefilter", "samples", "passes", "error", "budget", "as", "isa", "device"; and past them
 * "beside", where values are other programs. */
const char *cli_chart_axis_name(int i_axis);

/* Another program's picture of the first scene, and the time that it took. */
typedef struct cli_chart_beside {
  char name[24];
  double ms;
  const char *path;
} cli_chart_beside;

typedef struct cli_charts_beside {
  cli_chart_beside pictures[CLI_MOST_BESIDE];
  int n;
} cli_charts_beside;

/* Appends what "NAME=MS:PICTURE" says to a cli_charts_beside; 0 where it is not understood. */
int cli_chart_parse_beside(const char *text, void *beside);

/* A scene drawn with one option at one value, all others as they are by default. */
typedef struct cli_axis_point {
  int i_scene, i_axis;
  char value[24];
  double ms; /* a frame, with the choice of what to draw */
  conic_render_statistics statistics;
  cli_chart_error error; /* against the first scene in full detail, over the pixels that it covers */
  size_t holes;          /* pixels that it fills and nothing is drawn in */
  int is_front;          /* no other is faster and nearer */
} cli_axis_point;

typedef struct cli_axis_chart {
  /* What is asked for. */
  const char *const *paths;
  int n_paths;
  const char *over;               /* axes with commas between, each perhaps with =VALUE:VALUE…; null: what fits */
  const char *camera_path, *view; /* without a camera it is framed as by conic render */
  cli_charts_beside beside;
  conic_shading shading;
  int size[2], is_quick;
  int truth_samples; /* along an edge of a pixel; with 1, errors are against the first scene as it is drawn */

  /* What came of it; `points` is the caller's to free. */
  cli_axis_point *points;
  int n_points;
} cli_axis_chart;

/* Measures every point. Returns the exit code, after a message. */
int cli_axis_chart_measure(cli_session *session, cli_axis_chart *chart);

/* FOLDER/scene.csv and scene.svg. */
conic_status cli_axis_chart_write(const cli_session *session, const char *folder, const cli_axis_chart *chart);

/* What is best for its time, on standard output. */
void cli_axis_chart_print(const cli_axis_chart *chart);

#endif
