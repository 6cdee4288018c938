#include "core/scans/e57_file.h"

#include "core/base/byte_order.h"

enum { SECTION_BYTES = 32, PACKET_BYTES = 4, INDEX_PACKET = 0, DATA_PACKET = 1, IGNORED_PACKET = 2 };

conic_status conic_e57_records_open(conic_e57_file *file, const conic_e57_scan *scan, conic_e57_records *records) {
  unsigned char section[SECTION_BYTES];
  uint64_t at = scan->records_offset;
  memset(records, 0, sizeof *records);
  records->file = file;
  records->scan = scan;
  records->n_left = scan->n_records;
  conic_status status = conic_e57_file_take(file, &at, section, sizeof section);
  if (status == CONIC_OK && section[0] != 1)
    status = conic_e57_wrong(file, "no points begin where the XML says", scan->records_offset);
  records->packet = conic_load_bits(section + 16, 8);
  return status;
}

void conic_e57_records_close(conic_e57_records *records) {
  for (size_t i = 0; i < CONIC_E57_MOST_COLUMNS; i++)
    conic_memory_release(records->file->context, records->streams[i].bytes);
}

/* Appends n bytes to the unused ones of a stream. */
static conic_status feed_stream(conic_e57_records *records, conic_e57_stream *stream, uint64_t *at, size_t n) {
  size_t used = (size_t)(stream->bit / 8);
  if (!stream->is_wanted || n == 0)
    return conic_e57_file_skip(records->file, at, n);
  if (used > 0)
    memmove(stream->bytes, stream->bytes + used, stream->n - used);
  stream->n -= used;
  stream->bit %= 8;
  conic_status status = CONIC_OK;
  if (stream->n + n > stream->room)
    status = conic_memory_reserve(records->file->context, &stream->bytes, stream->n, stream->n + n, &stream->room, 1);
  if (status == CONIC_OK)
    status = conic_e57_file_take(records->file, at, stream->bytes + stream->n, n);
  stream->n += status == CONIC_OK ? n : 0;
  return status;
}

/* A packet has the sizes of all streams' bytes, and then the bytes. */
static conic_status feed_streams(conic_e57_records *records, uint64_t at, size_t n_bytes) {
  unsigned char sizes[2 * CONIC_E57_MOST_COLUMNS + 2];
  size_t n = records->scan->n_columns, n_used = PACKET_BYTES + 2 + 2 * n;
  if (n_used > n_bytes)
    return conic_e57_wrong(records->file, "a packet is too short", records->packet);
  conic_status status = conic_e57_file_take(records->file, &at, sizes, 2 + 2 * n);
  if (status == CONIC_OK && conic_load_bits(sizes, 2) != n)
    return conic_e57_wrong(records->file, "a packet has other values than the XML says", records->packet);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    size_t size = (size_t)conic_load_bits(sizes + 2 + 2 * i, 2);
    n_used += size;
    status = n_used > n_bytes ? conic_e57_wrong(records->file, "a packet is too short", records->packet)
                              : feed_stream(records, &records->streams[i], &at, size);
  }
  return status;
}

static conic_status next_packet(conic_e57_records *records) {
  unsigned char head[PACKET_BYTES];
  uint64_t at = records->packet, next = records->packet;
  conic_status status = conic_e57_file_take(records->file, &at, head, sizeof head);
  if (status != CONIC_OK)
    return status;
  size_t n_bytes = (size_t)conic_load_bits(head + 2, 2) + 1;
  if (head[0] != INDEX_PACKET && head[0] != DATA_PACKET && head[0] != IGNORED_PACKET)
    return conic_e57_wrong(records->file, "a packet is of no kind that there is", records->packet);
  if (n_bytes < PACKET_BYTES)
    return conic_e57_wrong(records->file, "a packet is too short", records->packet);
  if (head[0] == DATA_PACKET)
    status = feed_streams(records, at, n_bytes);
  if (status == CONIC_OK)
    status = conic_e57_file_skip(records->file, &next, n_bytes);
  records->packet = next;
  return status;
}

static uint64_t count_ready(const conic_e57_records *records) {
  uint64_t ready = CONIC_E57_BLOCK;
  ready = ready < records->n_left ? ready : records->n_left;
  for (size_t i = 0; i < records->scan->n_columns; i++) {
    const conic_e57_stream *stream = &records->streams[i];
    unsigned bits = records->scan->columns[i].bits;
    if (!stream->is_wanted || bits == 0)
      continue;
    uint64_t whole = ((uint64_t)stream->n * 8 - stream->bit) / bits;
    ready = whole < ready ? whole : ready;
  }
  return ready;
}

conic_status conic_e57_records_fill(conic_e57_records *records, size_t *n) {
  uint64_t ready = count_ready(records);
  while (ready == 0 && records->n_left > 0) {
    conic_status status = next_packet(records);
    if (status != CONIC_OK)
      return status;
    ready = count_ready(records);
  }
  *n = (size_t)ready;
  records->n_left -= ready;
  return CONIC_OK;
}

/* Up to 64 bits from a bit on, the lowest first. */
static uint64_t value_bits_at(const unsigned char *bytes, uint64_t bit, unsigned n_bits) {
  const unsigned char *from = bytes + bit / 8;
  unsigned shift = (unsigned)(bit % 8), n_bytes = (shift + n_bits + 7) / 8;
  uint64_t low = conic_load_bits(from, n_bytes < 8 ? n_bytes : 8) >> shift;
  if (n_bytes > 8)
    low |= (uint64_t)from[8] << (64 - shift);
  return n_bits < 64 ? low & ((UINT64_C(1) << n_bits) - 1) : low;
}

void conic_e57_records_take(conic_e57_records *records, int i_column, size_t n, double *values) {
  const conic_e57_column *column = &records->scan->columns[i_column];
  conic_e57_stream *stream = &records->streams[i_column];
  for (size_t i = 0; i < n; i++) {
    uint64_t raw = column->bits ? value_bits_at(stream->bytes, stream->bit, column->bits) : 0;
    stream->bit += column->bits;
    if (column->type == CONIC_E57_SINGLE)
      values[i] = (double)conic_float_of_bits((uint32_t)raw);
    else if (column->type == CONIC_E57_DOUBLE)
      values[i] = conic_double_of_bits(raw);
    else
      values[i] = (double)(int64_t)((uint64_t)column->low + raw) * column->scale + column->offset;
  }
}
