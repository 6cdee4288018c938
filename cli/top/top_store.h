/* Rows of a picture that arrive block by block and leave tile by tile: keeps the last ones, in memory or in a file. */
#pragma once

#include "core/files/scratch.h"

typedef struct cli_top_store {
  conic_context *context;
  size_t width, pixel_bytes, n_rows; /* row y is at row y modulo n_rows */
  unsigned char *rows;               /* null: the rows are in the file */
  conic_scratch scratch;
} cli_top_store;

/* Keeps the last n_rows rows: in memory if they take at most most_bytes, else in a file beside PATH, which must outlive
 * the store. Errors: MEMORY, IO. */
conic_status cli_top_store_open(conic_context *context, const char *path, size_t width, size_t pixel_bytes,
                                size_t n_rows, uint64_t most_bytes, cli_top_store *store);
void cli_top_store_close(cli_top_store *store);

/* Stores `count` pixels of a row. Errors: IO. */
conic_status cli_top_store_put(cli_top_store *store, size_t x, size_t y, const void *pixels, size_t count);
conic_status cli_top_store_get(const cli_top_store *store, size_t x, size_t y, void *pixels, size_t count);
