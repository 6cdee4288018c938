/* The table of a LAZ file's chunks, which comes after them: how long each is, and, where they differ, how many points
 * it has. */
#pragma once

#include "core/laz/laz.h"

typedef struct conic_laz_chunk {
  uint64_t offset, n_bytes; /* in the file */
  uint64_t n_points;
} conic_laz_chunk;

enum { CONIC_LAZ_TABLE_HEAD_BYTES = 8 };

/* The number of chunks in a table that begins with these bytes; 0 where they begin no table. */
uint64_t conic_laz_table_count(const unsigned char *head);

/* Unpacks the rest of a table: n chunks with n_points in all; the first begins at `offset` in the file, and the last
 * ends at or before `end`. Fewer are listed where the points end: *n_listed of them, with *n_points_told points.
 * Nothing is logged. Errors: INPUT (the table is spoiled), MEMORY. */
conic_status conic_laz_table_read(conic_context *context, const conic_laz_format *format, const unsigned char *bytes,
                                  size_t n_bytes, uint64_t offset, uint64_t end, uint64_t n_points, size_t n,
                                  conic_laz_chunk *chunks, size_t *n_listed);
