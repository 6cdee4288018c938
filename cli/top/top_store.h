/* Rows of a picture that come block by block and go tile by tile: the last ones, in memory or in a file. */
#ifndef CONIC_TOP_STORE_H
#define CONIC_TOP_STORE_H

#include "core/files/scratch.h"

typedef struct cli_top_store {
  conic_context *context;
  size_t width, pixel_bytes, n_rows; /* row y is in the place of row y modulo n_rows */
  unsigned char *rows;               /* null: they are in the file */
  conic_scratch scratch;
} cli_top_store;

/* Keeps the last n_rows rows, in memory where they take no more than most_bytes, else in a file beside PATH, which must
 * stay. Errors: MEMORY, IO. */
conic_status cli_top_store_open(conic_context *context, const char *path, size_t width, size_t pixel_bytes,
                                size_t n_rows, uint64_t most_bytes, cli_top_store *store);
void cli_top_store_close(cli_top_store *store);

/* A part of a row, of `count` pixels. Errors: IO. */
conic_status cli_top_store_put(cli_top_store *store, size_t x, size_t y, const void *pixels, size_t count);
conic_status cli_top_store_get(const cli_top_store *store, size_t x, size_t y, void *pixels, size_t count);

#endif
