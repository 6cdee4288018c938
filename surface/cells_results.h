/* What became of points that are projected cell by cell, by their numbers in the set: of a team's in its first process,
 * which the others send theirs. */
#ifndef CONIC_CELLS_RESULTS_H
#define CONIC_CELLS_RESULTS_H

#include "core/base/team.h"
#include "surface/store.h"

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
  conic_store store;      /* in the first process by number; in others as they come, each with its number */
  uint64_t n_sent;        /* of the latter */
} conic_cells_results;

/* Results that are kept at a time, at most. */
enum { CONIC_RESULTS_RUN = 64 };

/* The bytes of those of n_points in the first process, and of at most n_own in another. */
uint64_t conic_cells_results_bytes(const conic_team *team, uint64_t n_points, uint64_t n_own);

/* Room for them, in a file beside `path`, or where that is null in memory. Errors: MEMORY, IO. */
conic_status conic_cells_results_begin(conic_context *context, const conic_team *team, const char *path,
                                       uint64_t n_points, uint64_t n_own, conic_cells_results *results);
void conic_cells_results_end(conic_cells_results *results);

/* Keeps what became of n points from number `first` on. Errors: IO. */
conic_status conic_cells_results_keep(conic_cells_results *results, uint64_t first, size_t n,
                                      const conic_cell_result *run);

/* Collective of a team: brings all to the first process. Errors: MEMORY, IO; not of whom it befell only, but of all
 * once they have agreed, which is the caller's to see to. */
conic_status conic_cells_results_bring(conic_cells_results *results);

#endif
