#include "bench/plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MARGIN_LEFT = 68, MARGIN_RIGHT = 14, MARGIN_TOP = 30, MARGIN_BOTTOM = 48, TITLE = 26, LEGEND = 200 };
enum { MOST_TICKS = 8, KEY_HEIGHT = 20 };

cli_plot_style cli_plot_style_of(int i) {
  static const char *const colors[] = {"#0072b2", "#d55e00", "#009e73", "#7b3294",
                                       "#e6a000", "#444444", "#56b4e9", "#c2186a"};
  enum { N_COLORS = sizeof colors / sizeof colors[0] };
  return (cli_plot_style){.color = colors[i % N_COLORS],
                          .shape = (cli_plot_shape)(i / N_COLORS % (int)CLI_PLOT_N_SHAPES)};
}

void cli_plot_include(cli_plot_axis *axis, double value) {
  if (!isfinite(value) || (axis->is_log && value <= 0.0))
    return;
  int is_first = axis->low == 0.0 && axis->high == 0.0;
  if (is_first || value < axis->low)
    axis->low = value;
  if (is_first || value > axis->high)
    axis->high = value;
}

/* With room around what it was given; linear axes begin at 0. */
static cli_plot_axis with_room(const cli_plot_axis *from) {
  cli_plot_axis axis = *from;
  if (axis.is_log) {
    if (!(axis.low > 0.0))
      axis.low = axis.high = 1.0;
    double room = fmax(1.25, pow(axis.high / axis.low, 0.07));
    axis.low /= room;
    axis.high *= room;
    return axis;
  }
  axis.low = fmin(axis.low, 0.0);
  axis.high = axis.high > axis.low ? axis.high + 0.08 * (axis.high - axis.low) : axis.low + 1.0;
  return axis;
}

static void write_escaped(FILE *to, const char *text) {
  for (; *text; text++) {
    if (*text == '<' || *text == '>' || *text == '&' || *text == '"')
      fprintf(to, "&#%d;", *text);
    else
      fputc((unsigned char)*text < ' ' ? ' ' : *text, to);
  }
}

static void put_label(FILE *to, double x, double y, const char *more, const char *text) {
  fprintf(to, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, more);
  write_escaped(to, text);
  fputs("</text>\n", to);
}

static double share_of(const cli_plot_axis *axis, double value) {
  if (axis->is_log)
    return log(value / axis->low) / log(axis->high / axis->low);
  return (value - axis->low) / (axis->high - axis->low);
}

static double plot_across(const cli_plot *plot, double x) {
  return plot->left + (plot->right - plot->left) * share_of(&plot->x, x);
}

static double plot_down(const cli_plot *plot, double y) {
  return plot->bottom + (plot->top - plot->bottom) * share_of(&plot->y, y);
}

static int is_on_axis(const cli_plot_axis *axis, double value) {
  return value >= axis->low && value <= axis->high;
}

/* Ticks of a logarithmic axis: 1, 2, 5 a decade where that is few enough, else whole decades, else every so many. */
static int log_ticks(const cli_plot_axis *axis, double *ticks) {
  static const double within[3] = {1.0, 2.0, 5.0};
  int first = (int)floor(log10(axis->low)), last = (int)ceil(log10(axis->high));
  for (int step = 0; step < 300; step++) {
    int n = 0, n_within = step ? 1 : 3, stride = step ? step : 1;
    for (int decade = first; decade <= last && n <= MOST_TICKS; decade++)
      for (int k = 0; k < n_within && decade % stride == 0 && n <= MOST_TICKS; k++) {
        double value = within[k] * pow(10.0, decade);
        if (is_on_axis(axis, value))
          ticks[n++] = value;
      }
    if (n <= MOST_TICKS)
      return n;
  }
  return 0;
}

static int linear_ticks(const cli_plot_axis *axis, double *ticks) {
  double rough = (axis->high - axis->low) / 5.0, power = pow(10.0, floor(log10(rough)));
  double step = rough > 5.0 * power ? 10.0 * power : rough > 2.0 * power ? 5.0 * power : 2.0 * power;
  int n = 0;
  for (double k = ceil(axis->low / step); n <= MOST_TICKS && k * step <= axis->high; k += 1.0)
    ticks[n++] = k * step + 0.0; /* not -0 */
  return n;
}

static int find_ticks(const cli_plot_axis *axis, double ticks[MOST_TICKS + 1]) {
  return axis->is_log ? log_ticks(axis, ticks) : linear_ticks(axis, ticks);
}

/* "0.05", "5e-4" */
static void name_tick(double value, char *label, size_t room) {
  double size = fabs(value);
  int exponent = size > 0.0 ? (int)floor(log10(size * 1.000001)) : 0;
  if (exponent > -3 && exponent < 6)
    snprintf(label, room, "%g", value);
  else
    snprintf(label, room, "%ge%d", value * pow(10.0, -exponent), exponent);
}

static void draw_axes(cli_plot *plot) {
  double ticks[MOST_TICKS + 1];
  char label[32];
  FILE *to = plot->to;
  int n = find_ticks(&plot->x, ticks);
  for (int i = 0; i < n; i++) {
    double x = plot_across(plot, ticks[i]);
    fprintf(to, "<path d=\"M%.1f %.1fV%.1f\" stroke=\"#dddddd\"/>\n", x, plot->top, plot->bottom);
    name_tick(ticks[i], label, sizeof label);
    put_label(to, x, plot->bottom + 17.0, "text-anchor=\"middle\"", label);
  }
  n = find_ticks(&plot->y, ticks);
  for (int i = 0; i < n; i++) {
    double y = plot_down(plot, ticks[i]);
    fprintf(to, "<path d=\"M%.1f %.1fH%.1f\" stroke=\"#dddddd\"/>\n", plot->left, y, plot->right);
    name_tick(ticks[i], label, sizeof label);
    put_label(to, plot->left - 6.0, y + 4.0, "text-anchor=\"end\"", label);
  }
  put_label(to, 0.5 * (plot->left + plot->right), plot->bottom + 36.0, "text-anchor=\"middle\"", plot->x.label);
  fprintf(to, "<g transform=\"translate(%.1f %.1f) rotate(-90)\">", plot->left - 54.0,
          0.5 * (plot->top + plot->bottom));
  put_label(to, 0.0, 0.0, "text-anchor=\"middle\"", plot->y.label);
  fputs("</g>\n", to);
}

void cli_plot_begin(cli_plot *plot, FILE *to, const char *title, const cli_plot_grid *grid) {
  int n_rows = (grid->n_panels + grid->n_columns - 1) / grid->n_columns, top = TITLE + MARGIN_TOP;
  int width = grid->n_columns * grid->panel_width + LEGEND, height = TITLE + n_rows * grid->panel_height;
  int legend = top + grid->n_keys * (KEY_HEIGHT + 4);
  height = height > legend ? height : legend;
  *plot = (cli_plot){.to = to, .grid = *grid, .legend_top = top};
  fprintf(to,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" "
          "font-family=\"sans-serif\" font-size=\"12\" fill=\"#222222\">\n<title>",
          width, height, width, height);
  write_escaped(to, title);
  fprintf(to, "</title>\n<rect width=\"%d\" height=\"%d\" rx=\"8\" fill=\"#fbfbfb\"/>\n", width, height);
  put_label(to, MARGIN_LEFT, 19.0, "font-size=\"14\" font-weight=\"bold\"", title);
}

void cli_plot_panel(cli_plot *plot, const char *title, const cli_plot_axis *x, const cli_plot_axis *y) {
  const cli_plot_grid *grid = &plot->grid;
  int column = plot->i_panel % grid->n_columns, row = plot->i_panel / grid->n_columns;
  plot->i_panel++;
  plot->n_words = 0;
  plot->x = with_room(x);
  plot->y = with_room(y);
  plot->left = column * grid->panel_width + MARGIN_LEFT;
  plot->right = (column + 1) * grid->panel_width - MARGIN_RIGHT;
  plot->top = TITLE + row * grid->panel_height + MARGIN_TOP;
  plot->bottom = TITLE + (row + 1) * grid->panel_height - MARGIN_BOTTOM;
  put_label(plot->to, plot->left, plot->top - 10.0, "", title);
  draw_axes(plot);
}

/* The corners of a mark that is no circle, for a radius of 1. */
static void write_corners(FILE *to, cli_plot_shape shape, double x, double y, double radius) {
  static const double squares[][2] = {{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}};
  static const double triangles[][2] = {{0.0, -1.1}, {1.05, 0.8}, {-1.05, 0.8}};
  static const double diamonds[][2] = {{0.0, -1.25}, {1.25, 0.0}, {0.0, 1.25}, {-1.25, 0.0}};
  const double(*corners)[2] = shape == CLI_PLOT_SQUARE ? squares : shape == CLI_PLOT_TRIANGLE ? triangles : diamonds;
  int n = shape == CLI_PLOT_TRIANGLE ? 3 : 4;
  for (int i = 0; i < n; i++)
    fprintf(to, "%s%.1f,%.1f", i ? " " : "", x + radius * corners[i][0], y + radius * corners[i][1]);
}

static void put_mark(FILE *to, const cli_plot_style *style, double x, double y, double radius, const char *tip) {
  if (style->shape == CLI_PLOT_CIRCLE)
    fprintf(to, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"", x, y, radius);
  else {
    fputs("<polygon points=\"", to);
    write_corners(to, style->shape, x, y, radius);
    fputs("\"", to);
  }
  fprintf(to, " fill=\"%s\" fill-opacity=\"0.85\" stroke=\"#ffffff\">", style->color);
  if (tip) {
    fputs("<title>", to);
    write_escaped(to, tip);
    fputs("</title>", to);
  }
  fputs(style->shape == CLI_PLOT_CIRCLE ? "</circle>\n" : "</polygon>\n", to);
}

void cli_plot_mark(cli_plot *plot, const cli_plot_style *style, double x, double y, double radius, const char *tip) {
  if (is_on_axis(&plot->x, x) && is_on_axis(&plot->y, y))
    put_mark(plot->to, style, plot_across(plot, x), plot_down(plot, y), radius, tip);
}

static void end_stroke(FILE *to, const cli_plot_style *style) {
  fprintf(to, "\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"%s/>\n", style->color,
          style->is_dashed ? " stroke-dasharray=\"5 4\"" : "");
}

/* A line through points that lie inside the axes. */
static void plot_line(cli_plot *plot, const cli_plot_style *style, int n, const double *x, const double *y) {
  int n_drawn = 0;
  for (int i = 0; i < n; i++)
    if (is_on_axis(&plot->x, x[i]) && is_on_axis(&plot->y, y[i])) {
      fputs(n_drawn ? "L" : "<path d=\"M", plot->to);
      fprintf(plot->to, "%.1f %.1f", plot_across(plot, x[i]), plot_down(plot, y[i]));
      n_drawn++;
    }
  if (n_drawn)
    end_stroke(plot->to, style);
}

static int by_place(const void *a, const void *b) {
  const double *first = a, *second = b;
  return (first[0] > second[0]) - (first[0] < second[0]);
}

void cli_plot_front(cli_plot *plot, const cli_plot_style *style, int n, double (*points)[2]) {
  double x[2 * n + 1], y[2 * n + 1];
  int n_corners = 0;
  qsort(points, (size_t)n, sizeof *points, by_place);
  for (int i = 0; i < n; i++) {
    if (i) {
      x[n_corners] = points[i][0];
      y[n_corners++] = points[i - 1][1];
    }
    x[n_corners] = points[i][0];
    y[n_corners++] = points[i][1];
  }
  plot_line(plot, style, n_corners, x, y);
}

static int is_free(const cli_plot *plot, const double box[4]) {
  if (box[0] < plot->left || box[2] > plot->right || box[1] < plot->top || box[3] > plot->bottom)
    return 0;
  for (int i = 0; i < plot->n_words; i++) {
    const double *other = plot->words[i];
    if (box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])
      return 0;
  }
  return 1;
}

void cli_plot_words(cli_plot *plot, const char *color, double x, double y, const char *words) {
  static const double places[][2] = {{7, -3}, {7, 11}, {-1, -3}, {-1, 11}, {0, -9}, {0, 17}, {9, 4}, {-3, 4}};
  enum { N_PLACES = sizeof places / sizeof places[0] };
  const double width = 5.6 * (double)strlen(words), height = 10.0; /* of letters of 10 px */
  if (!is_on_axis(&plot->x, x) || !is_on_axis(&plot->y, y))
    return;
  for (int i = 0; i < N_PLACES && plot->n_words < CLI_PLOT_MOST_WORDS; i++) {
    double left = plot_across(plot, x) + places[i][0], base = plot_down(plot, y) + places[i][1];
    left -= places[i][0] < 0.0 ? 6.0 + width : places[i][0] == 0.0 ? 0.5 * width : 0.0;
    const double box[4] = {left, base - height, left + width, base};
    if (!is_free(plot, box))
      continue;
    char more[64];
    memcpy(plot->words[plot->n_words++], box, sizeof box);
    snprintf(more, sizeof more, "font-size=\"10\" fill=\"%.16s\"", color);
    put_label(plot->to, left, base, more, words);
    return;
  }
}

void cli_plot_key(cli_plot *plot, const cli_plot_style *style, const char *name) {
  double x = plot->grid.n_columns * plot->grid.panel_width + 16, y = plot->legend_top;
  if (!style) {
    plot->legend_top += plot->n_keys ? KEY_HEIGHT + 8 : KEY_HEIGHT;
    put_label(plot->to, x - 8.0, y + (plot->n_keys ? 12.0 : 4.0), "font-weight=\"bold\"", name);
    plot->n_keys++;
    return;
  }
  if (style->is_line) {
    fprintf(plot->to, "<path d=\"M%.1f %.1fh18", x - 9.0, y);
    end_stroke(plot->to, style);
  } else
    put_mark(plot->to, style, x, y, 6.0, NULL);
  put_label(plot->to, x + 14.0, y + 4.0, "", name);
  plot->legend_top += KEY_HEIGHT;
  plot->n_keys++;
}

void cli_plot_end(cli_plot *plot) {
  fputs("</svg>\n", plot->to);
}
