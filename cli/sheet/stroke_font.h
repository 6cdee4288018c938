/* The letters of sheets, as strokes of a pen, which have the same bits everywhere. */
#pragma once

/* The strokes of a letter by its code: a place is two characters, x from 'A' and y from 'E', on a grid where capitals
 * are 12 high; a blank lifts the pen; ~ stands before a place that a curve is bent towards (quadratic Bézier). Null:
 * there is no such letter. */
const char *cli_glyph_strokes(unsigned code);

/* Of a letter of Latin-1 with a mark: the letter below it, and the mark's own code, or else the letter and 0. */
unsigned cli_glyph_part(unsigned code, unsigned *mark);
