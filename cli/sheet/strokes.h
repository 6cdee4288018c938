/* Lines and letters on paper: a list of strokes, in pixels from the sheet's upper left corner, with y downwards. They
 * become pixels here, and stay strokes in a PDF. */
#pragma once

#include "core/base/base.h"

typedef struct cli_stroke {
  double from[2], to[2], width;
  float grey;  /* 0: black, 1: white */
  int is_flat; /* its ends are cut off straight; else round */
} cli_stroke;

/* `status` is that of the first stroke for which there was no memory. */
typedef struct cli_strokes {
  conic_context *context;
  cli_stroke *list;
  size_t n, room;
  conic_status status;
} cli_strokes;

/* How letters look. */
typedef struct cli_lettering {
  double height; /* of capitals */
  double weight; /* the strokes' width */
  double anchor; /* which part of the text is at its place: 0 the beginning, 0.5 the middle, 1 the end */
  int is_upwards;
  float grey;
} cli_lettering;

void cli_strokes_line(cli_strokes *strokes, double x0, double y0, double x1, double y1, double width, float grey);
/* A filled rectangle. */
void cli_strokes_block(cli_strokes *strokes, double x, double y, double width, double height, float grey);
/* UTF-8 of ASCII, Latin-1 and a few signs; any other letter is a box. The place is on the line that letters stand on.
 */
void cli_strokes_text(cli_strokes *strokes, const char *text, double x, double y, const cli_lettering *how);
double cli_text_length(const char *text, double height);

/* Paints the rows from first_row on into pixels of R, G, B, A, a byte each. */
void cli_strokes_paint(const cli_strokes *strokes, int first_row, int n_rows, int width, unsigned char *rgba);
void cli_strokes_release(cli_strokes *strokes);
