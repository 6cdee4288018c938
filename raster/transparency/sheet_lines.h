/* The picture where its front surface lets light through: line by line, surface by surface. */
#ifndef CONIC_SHEET_LINES_H
#define CONIC_SHEET_LINES_H

#include "conic/transparency.h"
#include "raster/transparency/pixel_sheets.h"

typedef struct conic_sheet_picture {
  conic_sheet_scene scene;
  const float *mark; /* of each pixel three numbers: it is drawn where the first is not 0 */
  conic_transparency how;
  double chance;
  conic_image *image;          /* the other pixels stay */
  int first_column, first_row; /* of the picture, where mask and image begin */
} conic_sheet_picture;

/* Reports progress as "transparency". Errors: MEMORY, CANCELLED. */
conic_status conic_sheet_lines_draw(const conic_sheet_picture *picture);

#endif
