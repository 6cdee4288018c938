#include "surface/cells_results.h"

/* Results sent at a time. */
enum { SENT_RESULTS = 1 << 16 };

typedef struct sent_result {
  uint64_t number;
  conic_cell_result result;
} sent_result;

static int is_sent(const conic_team *team) {
  return team && team->index > 0;
}

uint64_t conic_cells_results_bytes(const conic_team *team, uint64_t n_points, uint64_t n_own) {
  return is_sent(team) ? n_own * sizeof(sent_result) : n_points * sizeof(conic_cell_result);
}

conic_status conic_cells_results_begin(conic_context *context, const conic_team *team, const char *path,
                                       uint64_t n_points, uint64_t n_own, conic_cells_results *results) {
  *results = (conic_cells_results){.context = context, .team = team};
  return is_sent(team) ? conic_store_begin(context, path, n_own, sizeof(sent_result), &results->store)
                       : conic_store_begin(context, path, n_points, sizeof(conic_cell_result), &results->store);
}

conic_status conic_cells_results_keep(conic_cells_results *results, uint64_t first, size_t n,
                                      const conic_cell_result *run) {
  sent_result sent[CONIC_RESULTS_RUN];
  if (!is_sent(results->team))
    return conic_store_write(&results->store, first, n, run);
  for (size_t i = 0; i < n; i++)
    sent[i] = (sent_result){first + i, run[i]};
  results->n_sent += n;
  return conic_store_write(&results->store, results->n_sent - n, n, sent);
}

/* Sends pages of results, and an empty one at the end. */
static conic_status send_results(const conic_cells_results *results) {
  const conic_team *team = results->team;
  sent_result *page = conic_memory_allocate(results->context, SENT_RESULTS, sizeof *page);
  conic_status status = page ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (uint64_t at = 0; at < results->n_sent && status == CONIC_OK; at += SENT_RESULTS) {
    size_t n = results->n_sent - at < SENT_RESULTS ? (size_t)(results->n_sent - at) : SENT_RESULTS;
    status = conic_store_read(&results->store, at, n, page);
    if (status == CONIC_OK)
      team->send(team->data, 0, page, n * sizeof *page);
  }
  team->send(team->data, 0, "", 0);
  conic_memory_release(results->context, page);
  return status;
}

/* Keeps runs of consecutive numbers together. */
static conic_status keep_sent(conic_cells_results *results, const sent_result *sent, size_t n) {
  conic_cell_result run[CONIC_RESULTS_RUN];
  conic_status status = CONIC_OK;
  size_t n_run = 0;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    run[n_run++] = sent[i].result;
    if (i + 1 < n && n_run < CONIC_RESULTS_RUN && sent[i + 1].number == sent[i].number + 1)
      continue;
    status = conic_cells_results_keep(results, sent[i].number + 1 - n_run, n_run, run);
    n_run = 0;
  }
  return status;
}

/* Continues after a failure, too, because the other processes send all they have. */
conic_status conic_cells_results_bring(conic_cells_results *results) {
  const conic_team *team = results->team;
  conic_status status = CONIC_OK;
  if (is_sent(team))
    return send_results(results);
  for (int from = 1; team && from < team->count; from++)
    for (size_t n_bytes = 1; n_bytes > 0;) {
      sent_result *sent = team->receive(team->data, from, &n_bytes);
      if (status == CONIC_OK)
        status = keep_sent(results, sent, n_bytes / sizeof *sent);
      team->release(team->data, sent);
    }
  return status;
}

/* --- records in memory or in a file --- */

conic_status conic_store_begin(conic_context *context, const char *path, uint64_t count, size_t record_bytes,
                               conic_store *store) {
  *store = (conic_store){.context = context, .record_bytes = record_bytes, .file.descriptor = -1};
  if (path)
    return conic_scratch_open(context, path, &store->file);
  store->memory = conic_memory_allocate(context, (size_t)count, record_bytes);
  return store->memory ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_store_end(conic_store *store) {
  conic_memory_release(store->context, store->memory);
  conic_scratch_close(&store->file);
  store->memory = NULL;
}

conic_status conic_store_write(conic_store *store, uint64_t first, size_t n, const void *records) {
  uint64_t at = first * store->record_bytes;
  if (!store->memory)
    return conic_scratch_write(&store->file, at, records, n * store->record_bytes);
  memcpy(store->memory + at, records, n * store->record_bytes);
  return CONIC_OK;
}

conic_status conic_store_read(const conic_store *store, uint64_t first, size_t n, void *records) {
  uint64_t at = first * store->record_bytes;
  if (!store->memory)
    return conic_scratch_read(&store->file, at, records, n * store->record_bytes);
  memcpy(records, store->memory + at, n * store->record_bytes);
  return CONIC_OK;
}
