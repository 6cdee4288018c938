#include "core/laz/laz_table.h"

#include "core/laz/laz_stream.h"

uint64_t conic_laz_table_count(const unsigned char *head) {
  return conic_load_32(head) == 0 ? conic_load_32(head + 4) : 0;
}

conic_status conic_laz_table_read(conic_context *context, const conic_laz_format *format, const unsigned char *bytes,
                                  size_t n_bytes, uint64_t offset, uint64_t end, uint64_t n_points, size_t n,
                                  conic_laz_chunk *chunks, size_t *n_listed) {
  conic_laz_arena arena = {.context = context};
  conic_laz_stream stream;
  conic_laz_integer *integer = conic_memory_allocate_zeroed(context, 1, sizeof *integer);
  int32_t count = 0, size = 0;
  *n_listed = 0;
  if (!integer)
    return CONIC_ERROR_MEMORY;
  conic_laz_stream_begin(&stream, &arena, bytes, n_bytes);
  for (size_t i = 0; i < n && n_points > 0 && !stream.is_spoiled && !arena.is_out; i++) {
    if (format->chunk_points == CONIC_LAZ_VARIABLE)
      count = conic_laz_integer_32(&stream, integer, count, 0);
    size = conic_laz_integer_32(&stream, integer, size, 1);
    uint64_t n_here = format->chunk_points == CONIC_LAZ_VARIABLE ? (uint32_t)count : format->chunk_points;
    n_here = n_here < n_points ? n_here : n_points;
    stream.is_spoiled |= (uint32_t)size > end - offset;
    if (stream.is_spoiled)
      break;
    chunks[(*n_listed)++] = (conic_laz_chunk){offset, (uint32_t)size, n_here};
    offset += (uint32_t)size;
    n_points -= n_here;
  }
  conic_laz_arena_release(&arena);
  conic_memory_release(context, integer);
  return arena.is_out ? CONIC_ERROR_MEMORY : stream.is_spoiled ? CONIC_ERROR_INPUT : CONIC_OK;
}
