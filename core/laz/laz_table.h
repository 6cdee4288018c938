/* The table of a LAZ file's chunks, which stands after them: how long each is, and, where they differ, of how many
 * points. */
#ifndef CONIC_LAZ_TABLE_H
#define CONIC_LAZ_TABLE_H

#include "core/laz/laz.h"

typedef struct conic_laz_chunk {
  uint64_t offset, n_bytes; /* in the file */
  uint64_t n_points;
} conic_laz_chunk;

enum { CONIC_LAZ_TABLE_HEAD_BYTES = 8 };

/* How many chunks a table has whose first bytes these are; 0 where they begin none. */
uint64_t conic_laz_table_count(const unsigned char *head);

/* Unpacks what follows the head: n chunks, the first of which begins at `offset` in a file where the last ends at `end`
 * at most, and that have n_points in all. Fewer are listed where the points end; *n_listed says how many.
 * *n_points_told is how many points they have. Nothing is logged. Errors: INPUT (the table is spoiled), MEMORY. */
conic_status conic_laz_table_read(conic_context *context, const conic_laz_format *format, const unsigned char *bytes,
                                  size_t n_bytes, uint64_t offset, uint64_t end, uint64_t n_points, size_t n,
                                  conic_laz_chunk *chunks, size_t *n_listed);

#endif
