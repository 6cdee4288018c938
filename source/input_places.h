/* Where the inputs of a picture stand: turned, scaled evenly and shifted from where their files have them. */
#pragma once

#include "conic/source.h"

typedef struct conic_place {
  double rotation[3][3], scale, shift[3];
  double matrix[3][4]; /* scale · rotation, and the shift */
  int is_moved;
} conic_place;

/* Fills in a place from its matrix. Returns what is wrong with that; null: nothing. */
const char *conic_place_find_parts(conic_place *place);

/* Reads conic_source_options.place for n inputs into `places`. Errors: ARGUMENT. */
conic_status conic_places_read(conic_context *context, const char *text, size_t n, conic_place *places);

/* The text for some of the inputs, which are `kept`, by their numbers among these; null: nothing of them is moved. The
 * caller releases it through the context's memory. Errors: MEMORY. */
conic_status conic_places_part(conic_context *context, const char *text, const int *is_kept, size_t n, char **part);
