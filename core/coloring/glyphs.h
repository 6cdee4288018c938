/* Letters for pictures: digits, capitals and a few signs, five pixels wide and seven high. */
#pragma once

#include <stdint.h>

/* GLYPH_STEP: from one letter to the next. */
enum { CONIC_GLYPH_WIDTH = 5, CONIC_GLYPH_HEIGHT = 7, CONIC_GLYPH_STEP = 6 };

/* Rows from the top, five bits each, the leftmost pixel highest. Small letters look like capitals, unknown ones like a
 * box. */
const uint8_t *conic_glyph(char letter);
