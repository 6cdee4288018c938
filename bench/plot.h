/* Charts as SVG pictures: panels in a grid, each with axes of its own, and one legend beside them. Whatever is drawn
 * outside a panel's axes is left out. */
#pragma once

#include <stdio.h>

/* What an axis spans. Begin with low = high = 0 and give it values by cli_plot_include; panels widen it a little. */
typedef struct cli_plot_axis {
  const char *label;
  int is_log; /* values of 0 and below are none */
  double low, high;
} cli_plot_axis;

typedef enum cli_plot_shape {
  CLI_PLOT_CIRCLE,
  CLI_PLOT_SQUARE,
  CLI_PLOT_TRIANGLE,
  CLI_PLOT_DIAMOND,
  CLI_PLOT_N_SHAPES
} cli_plot_shape;

/* Of marks, lines and boxes. */
typedef struct cli_plot_style {
  const char *color; /* "#rrggbb" */
  cli_plot_shape shape;
  int is_line; /* the legend shows a line in place of the mark */
  int is_dashed;
} cli_plot_style;

/* The grid has n_panels, n_columns a row, each so many pixels wide and high with its labels; the legend n_keys lines.
 */
typedef struct cli_plot_grid {
  int n_columns, n_panels, panel_width, panel_height, n_keys;
} cli_plot_grid;

enum { CLI_PLOT_MOST_WORDS = 256 };

/* A picture while it is written. The stream is the caller's. */
typedef struct cli_plot {
  FILE *to;
  cli_plot_grid grid;
  int i_panel, n_keys, legend_top;
  cli_plot_axis x, y; /* of the panel that is drawn now */
  double left, right, top, bottom;
  double words[CLI_PLOT_MOST_WORDS][4]; /* of this panel, where there are some: left, top, right, bottom */
  int n_words;
} cli_plot;

/* A style for the i-th of many series: eight colours, then the next shape. */
cli_plot_style cli_plot_style_of(int i);

void cli_plot_include(cli_plot_axis *axis, double value);

void cli_plot_begin(cli_plot *plot, FILE *to, const char *title, const cli_plot_grid *grid);

/* The next panel. An axis that was given no value spans 0 to 1. */
void cli_plot_panel(cli_plot *plot, const char *title, const cli_plot_axis *x, const cli_plot_axis *y);

/* A mark of a radius in pixels; `tip` is shown where the pointer rests on it, and may be null. */
void cli_plot_mark(cli_plot *plot, const cli_plot_style *style, double x, double y, double radius, const char *tip);

/* A line through points in any order, from the left to the right, with a corner for each step down. Sorts them. */
void cli_plot_front(cli_plot *plot, const cli_plot_style *style, int n, double (*points)[2]);

/* Small words beside a place, where they cover no others; none where there is no room. */
void cli_plot_words(cli_plot *plot, const char *color, double x, double y, const char *words);

/* The next line of the legend; a null style makes a gap before it, for a group's name. */
void cli_plot_key(cli_plot *plot, const cli_plot_style *style, const char *name);

void cli_plot_end(cli_plot *plot);
