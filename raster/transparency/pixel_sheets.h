/* The surfaces behind one pixel, from front to back. A sheet is what the picture's rule of visibility blends into one
 * surface, once all before it is taken away. */
#pragma once

#include "conic/transparency.h"
#include "raster/explain/pixel_contributions.h"
#include "raster/tiles/finish.h"

#define CONIC_NO_SHEET_PART UINT32_MAX

/* What covers pixels of a line, each part naming the pixel's next by its number; splats are in file order. */
typedef struct conic_sheet_splat {
  uint32_t footprint, next;
  conic_fragment fragment;
} conic_sheet_splat;

typedef struct conic_sheet_triangle {
  const conic_triangle_record *record;
  float iz;
  uint32_t next;
} conic_sheet_triangle;

/* A splat of the pixel, by how near it is. */
typedef struct conic_ranked_splat {
  float seen, hides;
  float reach; /* the greatest `hides` of it and all behind it */
  uint32_t i_splat;
} conic_ranked_splat;

typedef struct conic_ranked_triangle {
  float iz;
  uint32_t i_triangle;
} conic_ranked_triangle;

/* What is the same for all pixels. The contributions' splats are without opacity. */
typedef struct conic_sheet_scene {
  const conic_contributions *contributions;
  const conic_finish *finish;
  const float *opacity; /* of the set's splats; null: 1 */
} conic_sheet_scene;

typedef struct conic_pixel_sheets {
  const conic_sheet_scene *scene;
  const conic_sheet_splat *splats;       /* the line's */
  const conic_sheet_triangle *triangles; /* likewise */
  int x, y;
  float ray[2];
  conic_ranked_splat *ranked; /* this pixel's; those before `i` are taken away */
  size_t n, i;
  conic_ranked_triangle *ranked_triangles;
  size_t n_triangles, i_triangle;
} conic_pixel_sheets;

/* A sheet, shaded as if it were alone. */
typedef struct conic_sheet {
  conic_finished_pixel pixel;
  float opacity; /* above 0, to 1 */
  float z, weight;
  uint32_t count, id;
} conic_sheet;

/* Puts the pixel's parts in order: its ray, n and n_triangles are given, and of `ranked` i_splat, of ranked_triangles
 * all. */
void conic_pixel_sheets_begin(conic_pixel_sheets *sheets);

/* Takes the nearest sheet away that is not wholly transparent. Returns whether there was one. */
int conic_pixel_sheets_next(conic_pixel_sheets *sheets, conic_sheet *sheet);

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
