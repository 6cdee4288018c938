/* The arguments of `conic chart`. */
#pragma once

#include "bench/chart_ways.h"
#include "cli/scene/render_job.h"

/* The chart's own options. */
typedef struct cli_chart_options {
  const char *folder, *over;
  char *mesh; /* in the arguments */
  int is_quick, truth_samples, most_pixels;
  double most_seconds;
  cli_charts_beside beside;
} cli_chart_options;

/* Reads the arguments into a scene, which begins as cli_scene_defaults has it, and into `own`, which may be null.
 * Returns as cli_scene_parse does. */
int cli_chart_parse(cli_session *session, int argc, char **argv, cli_render_job *scene, cli_chart_options *own);
