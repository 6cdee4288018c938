#include "cli/sheet/strokes.h"

#include "cli/sheet/stroke_font.h"

/* Of the letters' grid: how high capitals are, what is between two letters, a blank, and how wide all digits are, so
 * that numbers stand below each other. */
enum { CAPITAL = 12, GAP = 3, BLANK = 5, DIGIT = 8, PIECES = 6 };

static void add_stroke(cli_strokes *s, cli_stroke stroke) {
  if (s->status == CONIC_OK)
    s->status = conic_memory_append(s->context, &s->list, &s->n, &s->room, &stroke, sizeof stroke);
}

void cli_strokes_line(cli_strokes *s, double x0, double y0, double x1, double y1, double width, float grey) {
  add_stroke(s, (cli_stroke){{x0, y0}, {x1, y1}, width, grey, 0});
}

void cli_strokes_block(cli_strokes *s, double x, double y, double width, double height, float grey) {
  add_stroke(s, (cli_stroke){{x, y + 0.5 * height}, {x + width, y + 0.5 * height}, height, grey, 1});
}

void cli_strokes_release(cli_strokes *s) {
  conic_memory_release(s->context, s->list);
  memset(s, 0, sizeof *s);
}

/* --- letters --- */

/* The next code of UTF-8; what is none counts byte by byte. */
static unsigned take_letter(const char **text) {
  const unsigned char *at = (const unsigned char *)*text;
  int more = at[0] >= 0xe0 && at[0] < 0xf0 ? 2 : at[0] >= 0xc2 && at[0] < 0xe0 ? 1 : 0;
  unsigned code = more == 2 ? at[0] & 0x0fu : more == 1 ? at[0] & 0x1fu : at[0];
  for (int i = 1; i <= more; i++) {
    if ((at[i] & 0xc0) != 0x80) {
      more = 0;
      code = at[0];
      break;
    }
    code = code << 6 | (at[i] & 0x3fu);
  }
  *text += more + 1;
  return code;
}

static const char *strokes_of(unsigned code) {
  const char *strokes = cli_glyph_strokes(code);
  return strokes ? strokes : code == ' ' ? "" : "AEAQHQHEAE";
}

/* How far right a letter reaches. */
static int letter_width(unsigned code) {
  int width = 0;
  if (code == ' ')
    return BLANK - GAP;
  if (code >= '0' && code <= '9')
    return DIGIT;
  for (const char *at = strokes_of(code); *at; at += *at == ' ' || *at == '~' ? 1 : 2)
    if (*at != ' ' && *at != '~' && *at - 'A' > width)
      width = *at - 'A';
  return width;
}

double cli_text_length(const char *text, double height) {
  int sum = *text ? -GAP : 0;
  unsigned mark;
  while (*text)
    sum += letter_width(cli_glyph_part(take_letter(&text), &mark)) + GAP;
  return sum * height / CAPITAL;
}

/* Where letters go: the place of their grid's origin on the sheet, and its step to the right. */
typedef struct pen {
  cli_strokes *strokes;
  const cli_lettering *how;
  double x, y, right[2];
} pen;

static void place_of(const pen *p, double across, double up, double at[2]) {
  at[0] = p->x + across * p->right[0] + up * p->right[1];
  at[1] = p->y + across * p->right[1] - up * p->right[0];
}

static void draw_piece(const pen *p, const double from[2], const double to[2]) {
  double a[2], b[2];
  place_of(p, from[0], from[1], a);
  place_of(p, to[0], to[1], b);
  cli_strokes_line(p->strokes, a[0], a[1], b[0], b[1], p->how->weight, p->how->grey);
}

static void draw_glyph(const pen *p, unsigned code, double across, double up) {
  double last[2] = {0}, bend[2] = {0};
  int is_down = 0, is_bent = 0;
  for (const char *at = strokes_of(code); *at;) {
    if (*at == ' ' || *at == '~') {
      is_down &= *at == '~';
      is_bent = 0;
    }
    int is_bend = *at == '~';
    at += is_bend || *at == ' ';
    const double next[2] = {at[0] - 'A' + across, at[1] - 'E' + up};
    at += 2;
    if (is_bend) {
      memcpy(bend, next, sizeof bend);
      is_bent = 1;
      continue;
    }
    double from[2] = {last[0], last[1]};
    for (int i = 1; i <= PIECES && is_down && is_bent; i++) {
      double t = (double)i / PIECES, u = 1.0 - t, to[2];
      for (int k = 0; k < 2; k++)
        to[k] = u * u * last[k] + 2.0 * u * t * bend[k] + t * t * next[k];
      draw_piece(p, from, to);
      memcpy(from, to, sizeof from);
    }
    if (is_down && !is_bent)
      draw_piece(p, last, next);
    memcpy(last, next, sizeof last);
    is_down = 1;
    is_bent = 0;
  }
}

void cli_strokes_text(cli_strokes *strokes, const char *text, double x, double y, const cli_lettering *how) {
  double scale = how->height / CAPITAL, back = how->anchor * cli_text_length(text, how->height);
  pen p = {strokes, how, x, y, {scale, 0.0}};
  if (how->is_upwards) {
    p.right[0] = 0.0;
    p.right[1] = -scale;
  }
  double across = -back / scale;
  while (*text) {
    unsigned mark, code = cli_glyph_part(take_letter(&text), &mark);
    int width = letter_width(code);
    draw_glyph(&p, code, across, 0.0);
    if (mark)
      draw_glyph(&p, mark, across + 0.5 * width - 3.0, code <= 'Z' && mark != 0xb8 ? 4.0 : 0.0);
    across += width + GAP;
  }
}

/* --- pixels --- */

/* How much of a pixel's width lies within `half` of a line that is `distance` from its middle. */
static double covered_part(double distance, double half) {
  double low = distance - 0.5 > -half ? distance - 0.5 : -half, high = distance + 0.5 < half ? distance + 0.5 : half;
  return high > low ? high - low : 0.0;
}

/* The part of the pixel at a place, from the stroke's beginning, that the stroke covers. */
static double stroke_cover(const cli_stroke *stroke, const double along[2], double length, double x, double y) {
  double half = 0.5 * stroke->width, t = x * along[0] + y * along[1], off = x * along[1] - y * along[0];
  if (stroke->is_flat)
    return covered_part(off, half) * covered_part(t - 0.5 * length, 0.5 * length);
  double past = t < 0.0 ? -t : t > length ? t - length : 0.0;
  return covered_part(past > 0.0 ? sqrt(past * past + off * off) : off, half);
}

static void paint_stroke(const cli_stroke *stroke, int first_row, int n_rows, int width, unsigned char *rgba) {
  double reach = 0.5 * stroke->width + 1.0, along[2], low[2], high[2];
  for (int axis = 0; axis < 2; axis++) {
    along[axis] = stroke->to[axis] - stroke->from[axis];
    low[axis] = floor((along[axis] < 0.0 ? stroke->to : stroke->from)[axis] - reach);
    high[axis] = ceil((along[axis] < 0.0 ? stroke->from : stroke->to)[axis] + reach);
  }
  double length = sqrt(along[0] * along[0] + along[1] * along[1]);
  for (int axis = 0; axis < 2; axis++)
    along[axis] = length > 0.0 ? along[axis] / length : axis == 0;
  int rows[2] = {(int)fmax(low[1], first_row), (int)fmin(high[1], first_row + n_rows)};
  int columns[2] = {(int)fmax(low[0], 0.0), (int)fmin(high[0], width)};
  for (int y = rows[0]; y < rows[1]; y++)
    for (int x = columns[0]; x < columns[1]; x++) {
      unsigned char *pixel = rgba + 4 * ((size_t)(y - first_row) * (size_t)width + (size_t)x);
      double part = stroke_cover(stroke, along, length, x + 0.5 - stroke->from[0], y + 0.5 - stroke->from[1]);
      for (int c = 0; c < 3 && part > 0.0; c++)
        pixel[c] = (unsigned char)(pixel[c] + part * (255.0 * (double)stroke->grey - pixel[c]) + 0.5);
    }
}

void cli_strokes_paint(const cli_strokes *strokes, int first_row, int n_rows, int width, unsigned char *rgba) {
  for (size_t i = 0; i < strokes->n; i++)
    paint_stroke(&strokes->list[i], first_row, n_rows, width, rgba);
}
