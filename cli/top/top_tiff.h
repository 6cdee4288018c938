/* One TIFF of an orthophoto: takes blocks of pixels, from the left and from the top, and writes tiles. */
#pragma once

#include "cli/top/top_store.h"
#include "core/pictures/tiff_tiles.h"
#include "source/top/top_view.h"

#define CLI_TOP_NODATA (-9999.0)

typedef struct cli_top_tiff {
  conic_context *context;
  conic_tiff_layout layout;
  conic_tiff *tiff;
  cli_top_store store;
  unsigned char *pixels; /* a block's, or a tile's */
  size_t n_rows_done;    /* rows that were written as tiles */
} cli_top_tiff;

/* Where a block is in a picture: x, y of its first pixel in the picture, and that pixel within the block. */
typedef struct cli_top_cut {
  size_t x, y, width, height;
  size_t block_x, block_y;
} cli_top_cut;

/* Opens the file. Kept rows take up to most_bytes of memory. `path` must outlive it. Errors: as conic_tiff_open. */
conic_status cli_top_tiff_open(conic_context *context, const char *path, const conic_tiff_layout *layout,
                               uint64_t most_bytes, cli_top_tiff *file);
/* Takes the wanted plane of a block: rgba, or Z, NaN where nothing is. Errors: MEMORY, IO. */
conic_status cli_top_tiff_put(cli_top_tiff *file, const conic_image *block, const cli_top_cut *cut);
/* Writes the tiles of the rows above n_rows. Errors: MEMORY, IO. */
conic_status cli_top_tiff_advance(cli_top_tiff *file, size_t n_rows);
/* Ends the file if `status` is OK, else drops it. Releases everything; returns `status`, or what went wrong. */
conic_status cli_top_tiff_end(cli_top_tiff *file, conic_status status);

/* Writes PATH's world file: .tfw beside .tif, .pgw beside .png, and so on: the ending's first and last letter, and w.
 * `pixel` is a pixel's edge; the corner is x and y of the picture's upper left corner. Errors: MEMORY, IO. */
conic_status cli_world_file_write(conic_context *context, const char *path, double pixel, const double corner[2]);
