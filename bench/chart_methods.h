/* The chart of methods and kernels, on scenes whose surface is known. */
#pragma once

#include "bench/chart.h"

enum { CLI_MOST_METHOD_POINTS = 256 };

typedef struct cli_method_chart {
  int is_quick;
  int size, repeat; /* of the pictures, and frames that are timed */
  cli_chart_point points[CLI_MOST_METHOD_POINTS];
  int n_points;
} cli_method_chart;

/* Measures into a chart with is_quick set. */
conic_status cli_method_chart_measure(cli_session *session, cli_method_chart *chart);

/* FOLDER/chart-oracle.svg and chart-scene.svg, a panel a scene, and chart.svg, which has the default kernel alone. */
conic_status cli_method_chart_draw(const cli_session *session, const char *folder, const cli_method_chart *chart);

/* FOLDER/chart.csv and the pictures. */
conic_status cli_method_chart_write(const cli_session *session, const char *folder, const cli_method_chart *chart);

/* What is best for its time on each scene, on standard output. */
void cli_method_chart_print(const cli_method_chart *chart);
