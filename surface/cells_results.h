/* Results of points that are projected cell by cell, by their number in the set. In a team, the first process gets them
 * all from the others. */
#pragma once

#include "core/base/team.h"
#include "core/files/scratch.h"

/* Records of one size, in memory or in a file without a name. */

typedef struct conic_store {
  conic_context *context;
  size_t record_bytes;
  unsigned char *memory; /* null: the records are in the file */
  conic_scratch file;
} conic_store;

/* Makes room for `count` records, contents undefined, in a file beside `path`, or for a null path in memory. On failure
 * the store is empty. Errors: MEMORY, IO. */
conic_status conic_store_begin(conic_context *context, const char *path, uint64_t count, size_t record_bytes,
                               conic_store *store);
void conic_store_end(conic_store *store);

/* Writes or reads the records from number `first` on. Errors: IO. */
conic_status conic_store_write(conic_store *store, uint64_t first, size_t n, const void *records);
conic_status conic_store_read(const conic_store *store, uint64_t first, size_t n, void *records);

typedef struct conic_cell_sample {
  float position[3], normal[3], color[3];
} conic_cell_sample;

typedef struct conic_cell_result {
  conic_cell_sample point;
  uint32_t outcome;
} conic_cell_result;

typedef struct conic_cells_results {
  conic_context *context;
  const conic_team *team; /* null: this process is alone */
  conic_store store;      /* in the first process by number; in others in the order in which they come, each with its
                             number */
  uint64_t n_sent;        /* results in another process's store */
} conic_cells_results;

/* The most results kept at a time. */
enum { CONIC_RESULTS_RUN = 64 };

/* The bytes of the results of n_points in the first process, or of at most n_own in another. */
uint64_t conic_cells_results_bytes(const conic_team *team, uint64_t n_points, uint64_t n_own);

/* Makes room for the results, in a file beside `path`, or for a null path in memory; the caller ends the store, on
 * failure too. Errors: MEMORY, IO. */
conic_status conic_cells_results_begin(conic_context *context, const conic_team *team, const char *path,
                                       uint64_t n_points, uint64_t n_own, conic_cells_results *results);

/* Keeps the results of n points from number `first` on. Errors: IO. */
conic_status conic_cells_results_keep(conic_cells_results *results, uint64_t first, size_t n,
                                      const conic_cell_result *run);

/* Collective in a team: brings all results to the first process. Errors: MEMORY, IO; they are this process's own until
 * the caller makes the team agree. */
conic_status conic_cells_results_bring(conic_cells_results *results);
