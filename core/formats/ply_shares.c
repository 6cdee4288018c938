#include "core/formats/ply_shares.h"

#include <stdatomic.h>

typedef struct row_sharing {
  const conic_ply_source *source;
  const conic_ply_taker *taker;
  uint64_t offset; /* of the first in the file */
  size_t n_rows, n_at_once;
  char *rooms; /* a thread's: the taker's, and bytes of so many rows */
  size_t room_bytes;
  atomic_int status, is_cut;
} row_sharing;

enum { LEAST_SHARED_BYTES = 1 << 16 };

static void read_share(void *data, size_t i_item, int i_thread) {
  row_sharing *s = data;
  char *room = s->rooms + (size_t)i_thread * s->room_bytes;
  unsigned char *bytes = (unsigned char *)room + conic_memory_rounded(s->taker->room_bytes);
  size_t row_bytes = s->source->element->least_row_bytes, row = i_item * CONIC_PLY_SHARED_ROWS, n_read;
  size_t end = s->n_rows - row < CONIC_PLY_SHARED_ROWS ? s->n_rows : row + CONIC_PLY_SHARED_ROWS;
  for (size_t n; row < end; row += n) {
    n = end - row < s->n_at_once ? end - row : s->n_at_once;
    conic_status status =
        conic_input_read_at(s->source->input, s->offset + row * row_bytes, bytes, n * row_bytes, &n_read);
    if (status != CONIC_OK)
      atomic_store(&s->status, status);
    else if (n_read < n * row_bytes)
      atomic_store(&s->is_cut, 1);
    else
      s->taker->take(s->taker->data, bytes, n, row, room);
  }
}

conic_status conic_ply_share_rows(conic_ply_source *source, uint64_t n, const conic_ply_taker *taker) {
  conic_context *context = source->input->context;
  size_t row_bytes = source->element->least_row_bytes;
  uint64_t n_there = conic_input_remaining_bytes(source->input) / row_bytes, skipped;
  row_sharing s = {.source = source, .taker = taker, .offset = conic_input_offset(source->input)};
  s.n_rows = (size_t)(n < n_there ? n : n_there);
  s.n_at_once = (LEAST_SHARED_BYTES + row_bytes - 1) / row_bytes;
  s.room_bytes = conic_memory_rounded(conic_memory_rounded(taker->room_bytes) + s.n_at_once * row_bytes);
  s.rooms = conic_memory_allocate(context, (size_t)conic_context_threads(context), s.room_bytes);
  if (!s.rooms)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_parallel_told(
      context, "read", 0.0, 1.0, (s.n_rows + CONIC_PLY_SHARED_ROWS - 1) / CONIC_PLY_SHARED_ROWS, read_share, &s);
  conic_memory_release(context, s.rooms);
  if (status == CONIC_OK)
    status = (conic_status)atomic_load(&s.status);
  if (status != CONIC_OK || atomic_load(&s.is_cut))
    return status;
  source->i_row += s.n_rows;
  return conic_input_skip(source->input, s.n_rows * row_bytes, &skipped);
}
