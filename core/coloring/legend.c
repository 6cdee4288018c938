#include "core/coloring/legend.h"

#include "core/base/color.h"
#include "core/coloring/color_ramp.h"
#include "core/coloring/glyphs.h"
#include "core/image/image_common.h"

/* In units of the letters' pixels. */
enum { MARGIN = 5, TITLE = 12, BAR_WIDTH = 10, BAR_HEIGHT = 90, TICK = 3, ROW = 10, SWATCH = 8, MOST_ROWS = 24 };

typedef struct legend_row {
  char text[40];
  float color[3]; /* of a swatch; unused for a bar's tick */
  double at;      /* of a tick: 0 at the bottom to 1 */
} legend_row;

typedef struct legend {
  const conic_coloring *coloring;
  char title[64];
  int has_bar, n_rows;
  legend_row rows[MOST_ROWS];
  int width, height; /* in units */
} legend;

typedef struct canvas {
  conic_image *image;
  int x, y, unit; /* x, y: the legend's corner in the picture; unit: pixels of a unit */
} canvas;

static const float ink[3] = {0.85f, 0.85f, 0.85f}, paper[3] = {0.012f, 0.012f, 0.014f};

/* --- what it says --- */

static legend_row *add_legend_row(legend *l, const char *text) {
  legend_row *row = &l->rows[l->n_rows++];
  snprintf(row->text, sizeof row->text, "%s", text);
  return row;
}

/* The classes that there are, as many as fit. */
static void list_class_rows(legend *l) {
  char number[40];
  for (uint32_t i = 0; i < 256 && l->n_rows < MOST_ROWS; i++) {
    const char *name = conic_class_name(i);
    if (!(l->coloring->classes[i / 32] >> i % 32 & 1u))
      continue;
    snprintf(number, sizeof number, "class %u", (unsigned)i);
    conic_class_color(i, add_legend_row(l, name ? name : number)->color);
  }
}

static void list_axes(legend *l) {
  static const char *const names[] = {"+X", "+Y", "+Z"};
  for (int axis = 0; axis < 3; axis++) {
    legend_row *row = add_legend_row(l, names[axis]);
    for (int channel = 0; channel < 3; channel++)
      row->color[channel] = (float)conic_srgb_decode(channel == axis ? 1.0 : 0.5);
  }
}

/* The least of 1, 2 and 5 times a power of ten that fits no more than five times into the extent. */
static double tick_step(double extent, int *n_decimals) {
  static const double steps[] = {1.0, 2.0, 5.0};
  double power = 1.0;
  *n_decimals = 0;
  for (; power * 5.0 > extent && *n_decimals < 9; power /= 10.0)
    ++*n_decimals;
  for (int i = 0; i < 900; i++) {
    double step = steps[i % 3] * power;
    if (extent <= 5.0 * step)
      return step;
    if (i % 3 == 2) {
      power *= 10.0;
      *n_decimals -= *n_decimals > 0;
    }
  }
  return extent;
}

static void list_ticks(legend *l) {
  const conic_coloring *c = l->coloring;
  double extent = c->maximum - c->minimum;
  int n_decimals;
  char text[40];
  l->has_bar = 1;
  if (!(extent > 0.0)) {
    snprintf(text, sizeof text, "%.6g", c->minimum);
    add_legend_row(l, text)->at = 0.5;
    return;
  }
  double step = tick_step(extent, &n_decimals);
  for (double tick = ceil(c->minimum / step) * step; tick <= c->maximum && l->n_rows < MOST_ROWS; tick += step) {
    double t = (tick - c->minimum) / extent;
    int is_plain = fabs(tick) < 1e7 || (n_decimals > 0 && fabs(tick) < 1e12);
    snprintf(text, sizeof text, is_plain ? "%.*f" : "%.*g",
             is_plain                  ? n_decimals
             : fabs(tick) > 1e7 * step ? 12
                                       : 8,
             fabs(tick) < 1e-3 * step ? 0.0 : tick);
    add_legend_row(l, text)->at = c->is_root ? sqrt(t > 0.0 ? t : 0.0) : t;
  }
}

static int legend_text_width(const char *text) {
  return (int)strlen(text) * CONIC_GLYPH_STEP - 1;
}

/* Finds its size, once its rows are known. */
static void size_legend(legend *l) {
  int indent = l->has_bar ? BAR_WIDTH + TICK + 2 : SWATCH + 3, widest = legend_text_width(l->title);
  for (int i = 0; i < l->n_rows; i++)
    widest =
        indent + legend_text_width(l->rows[i].text) > widest ? indent + legend_text_width(l->rows[i].text) : widest;
  l->width = widest + 2 * MARGIN;
  l->height = 2 * MARGIN + TITLE + (l->has_bar ? BAR_HEIGHT : l->n_rows * ROW - (ROW - SWATCH));
}

/* Of the values whose unit is known; "": none. */
static const char *unit_of(const char *field, const char *length) {
  static const char *const lengths[] = {"height", "x", "y", "z"};
  for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
    if (strcmp(field, lengths[i]) == 0)
      return length;
  return strcmp(field, "gps_time") == 0 ? "s" : strcmp(field, "scan_angle") == 0 ? "deg" : "";
}

static void lay_out_legend(const conic_coloring *coloring, const char *length, legend *l) {
  const char *unit = unit_of(coloring->field, length);
  memset(l, 0, sizeof *l);
  l->coloring = coloring;
  snprintf(l->title, sizeof l->title, *unit ? "%s (%s)" : "%s", coloring->field, unit);
  if (!coloring->ramp)
    list_axes(l);
  else if (strcmp(coloring->ramp, conic_ramp_name(CONIC_RAMP_CLASSES)) == 0)
    list_class_rows(l);
  else
    list_ticks(l);
  size_legend(l);
}

/* --- drawing it --- */

/* Fills a rectangle, in pixels of the picture. */
static void fill_rectangle(const conic_image *image, const int x[2], const int y[2], const float color[3],
                           float alpha) {
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  for (int row = y[0] > 0 ? y[0] : 0; row < y[1] && row < image->height; row++)
    for (int column = x[0] > 0 ? x[0] : 0; column < x[1] && column < image->width; column++) {
      float *pixel = rgba + 4 * ((size_t)row * (size_t)image->width + (size_t)column);
      for (int channel = 0; channel < 3; channel++)
        pixel[channel] = color[channel] * alpha + pixel[channel] * (1.0f - alpha);
      pixel[3] = alpha + pixel[3] * (1.0f - alpha);
    }
}

static void draw_box(const canvas *to, int x, int y, int width, int height, const float color[3], float alpha) {
  const int columns[2] = {to->x + x * to->unit, to->x + (x + width) * to->unit};
  const int rows[2] = {to->y + y * to->unit, to->y + (y + height) * to->unit};
  fill_rectangle(to->image, columns, rows, color, alpha);
}

static void draw_text(const canvas *to, int x, int y, const char *text) {
  for (; *text; text++, x += CONIC_GLYPH_STEP) {
    const uint8_t *rows = conic_glyph(*text);
    for (int row = 0; row < CONIC_GLYPH_HEIGHT; row++)
      for (int column = 0; column < CONIC_GLYPH_WIDTH; column++)
        if (rows[row] >> (CONIC_GLYPH_WIDTH - 1 - column) & 1)
          draw_box(to, x + column, y + row, 1, 1, ink, 1.0f);
  }
}

/* Each pixel row has its own colour. */
static void draw_ramp_bar(const canvas *to, const conic_coloring *coloring) {
  int n = BAR_HEIGHT * to->unit, top = to->y + (MARGIN + TITLE) * to->unit;
  const int columns[2] = {to->x + MARGIN * to->unit, to->x + (MARGIN + BAR_WIDTH) * to->unit};
  for (int i = 0; i < n; i++) {
    const int rows[2] = {top + n - 1 - i, top + n - i};
    float color[3];
    double t = ((double)i + 0.5) / (double)n;
    conic_coloring_color(
        coloring, coloring->minimum + (coloring->maximum - coloring->minimum) * (coloring->is_root ? t * t : t), color);
    fill_rectangle(to->image, columns, rows, color, 1.0f);
  }
}

static void draw_legend_into(const legend *l, const canvas *to, float alpha) {
  int first = MARGIN + TITLE;
  draw_box(to, 0, 0, l->width, l->height, paper, alpha);
  draw_text(to, MARGIN, MARGIN, l->title);
  if (l->has_bar)
    draw_ramp_bar(to, l->coloring);
  for (int i = 0; i < l->n_rows; i++) {
    const legend_row *row = &l->rows[i];
    int y = first + ROW * i;
    if (l->has_bar) {
      int middle = first + BAR_HEIGHT - 1 - (int)(row->at * (double)(BAR_HEIGHT - 1) + 0.5);
      draw_box(to, MARGIN + BAR_WIDTH, middle, TICK - 1, 1, ink, 1.0f);
      draw_text(to, MARGIN + BAR_WIDTH + TICK + 2, middle - CONIC_GLYPH_HEIGHT / 2, row->text);
    } else {
      draw_box(to, MARGIN, y, SWATCH, SWATCH, row->color, 1.0f);
      draw_text(to, MARGIN + SWATCH + 3, y, row->text);
    }
  }
}

void conic_legend_draw(const conic_coloring *coloring, const char *length, conic_image *image) {
  legend l;
  int shorter = image->width < image->height ? image->width : image->height;
  canvas to = {.image = image, .unit = shorter > 800 ? shorter / 400 : 1};
  if (!image->planes[CONIC_PLANE_RGBA])
    return;
  lay_out_legend(coloring, length, &l);
  to.x = image->width - (l.width + MARGIN) * to.unit;
  to.y = image->height - (l.height + MARGIN) * to.unit;
  draw_legend_into(&l, &to, 0.8f);
}

static conic_status draw_legend_alone(conic_context *context, const legend *l, conic_image *image) {
  enum { UNIT = 2 };
  conic_status status = conic_image_allocate(context, l->width * UNIT, l->height * UNIT, 1u << CONIC_PLANE_RGBA, image);
  if (status == CONIC_OK)
    draw_legend_into(l, &(canvas){.image = image, .unit = UNIT}, 1.0f);
  return status;
}

conic_status conic_legend_make(conic_context *context, const conic_coloring *coloring, const char *length,
                               conic_image *image) {
  legend l;
  lay_out_legend(coloring, length, &l);
  return draw_legend_alone(context, &l, image);
}

conic_status conic_legend_make_list(conic_context *context, const char *title, const char *const *names,
                                    const float (*colors)[3], int n, conic_image *image) {
  legend l = {0};
  snprintf(l.title, sizeof l.title, "%s", title);
  for (int i = 0; i < n && i < MOST_ROWS; i++)
    memcpy(add_legend_row(&l, names[i])->color, colors[i], sizeof colors[i]);
  size_legend(&l);
  return draw_legend_alone(context, &l, image);
}
