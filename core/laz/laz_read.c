#include "core/laz/laz_stream.h"
#include "core/laz/laz_table.h"

/* Chunks of up to so many bytes of records, and of no more than so many times their packed bytes, are decoded whole,
 * several at once; larger ones in pieces. */
enum {
  MOST_AT_ONCE = 1 << 23,
  USUAL_BYTES = 1 << 21,
  CHUNKS_A_THREAD = 2,
  GROUP = 64,
  PIECE_BYTES = 1 << 16,
  MOST_GAIN = 48
};

/* The file's bytes, wherever they are. */
typedef struct packed_bytes {
  conic_input *input;
  unsigned char *held; /* of a pipe: all bytes from `start` on */
  uint64_t start, end; /* offsets in the file: where the points begin, and where the file ends */
} packed_bytes;

typedef struct laz_reading {
  conic_context *context;
  const conic_laz_format *format;
  packed_bytes from;
  uint64_t n_points, n_read; /* n_read: including skipped ones */
  uint64_t first, end;       /* the points to hand over */
  unsigned wanted;
  size_t piece; /* in points */
  int is_again, n_threads;
  int is_spoiled; /* the current chunk is */
  conic_laz_receiver *receive;
  void *cookie;
  conic_laz_chunk *chunks;
  size_t n_chunks;
  conic_laz_decoder **decoders; /* one for each thread */
  unsigned char *packed, *records;
  size_t packed_room, records_room;
} laz_reading;

/* --- bytes --- */

static conic_status hold_pipe(packed_bytes *from) {
  size_t n_held;
  conic_status status = conic_input_take_rest(from->input, SIZE_MAX, &from->held, &n_held);
  from->end = from->start + n_held;
  return status;
}

static uint64_t bytes_after(const packed_bytes *from, uint64_t offset) {
  return offset < from->end ? from->end - offset : 0;
}

/* n bytes at an offset, or as many as there are. */
static conic_status copy_packed(const packed_bytes *from, uint64_t offset, unsigned char *bytes, size_t n,
                                size_t *n_copied) {
  uint64_t left = bytes_after(from, offset);
  *n_copied = 0;
  n = n < left ? n : (size_t)left;
  if (n == 0)
    return CONIC_OK;
  if (!from->held)
    return conic_input_read_at(from->input, offset, bytes, n, n_copied);
  memcpy(bytes, from->held + (offset - from->start), n);
  *n_copied = n;
  return CONIC_OK;
}

static conic_status laz_spoiled(const laz_reading *r, uint64_t offset, uint64_t i_chunk) {
  return conic_fail(r->context, CONIC_ERROR_INPUT, "%s: LAZ: chunk %llu is spoiled (at byte %llu)", r->from.input->name,
                    (unsigned long long)i_chunk, (unsigned long long)offset);
}

/* Notes a decoder's INPUT status as a spoiled chunk. Other faults of the input are logged already. */
static conic_status note_spoiled(laz_reading *r, conic_status status) {
  r->is_spoiled |= status == CONIC_ERROR_INPUT;
  return status;
}

/* --- the table --- */

/* Finds the table: its offset is before the first chunk, or, in a file written to a pipe, at the very end; 0: there is
 * no table. */
static conic_status find_table(laz_reading *r, uint64_t *offset) {
  unsigned char bytes[8];
  size_t n;
  const packed_bytes *from = &r->from;
  *offset = 0;
  conic_status status = copy_packed(from, from->start, bytes, sizeof bytes, &n);
  if (status == CONIC_OK && n == sizeof bytes)
    *offset = conic_load_64(bytes);
  if (status == CONIC_OK && n == sizeof bytes && *offset == UINT64_MAX) {
    status = copy_packed(from, from->end - 8, bytes, sizeof bytes, &n);
    *offset = n == sizeof bytes ? conic_load_64(bytes) : 0;
  }
  if (*offset < from->start + 8 || *offset > from->end || from->end - *offset < CONIC_LAZ_TABLE_HEAD_BYTES)
    *offset = 0;
  return status;
}

/* The table ends where the file does, or where it cannot be longer. */
static conic_status unpack_table(laz_reading *r, uint64_t table, uint64_t n_chunks) {
  size_t room = (size_t)n_chunks * 20 + 64, n;
  unsigned char *bytes = conic_memory_allocate(r->context, room, 1);
  r->chunks = conic_memory_allocate(r->context, (size_t)n_chunks, sizeof *r->chunks);
  conic_status status = bytes && r->chunks ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = copy_packed(&r->from, table + CONIC_LAZ_TABLE_HEAD_BYTES, bytes, room, &n);
  if (status == CONIC_OK)
    status = conic_laz_table_read(r->context, r->format, bytes, n, r->from.start + 8, table, r->n_points,
                                  (size_t)n_chunks, r->chunks, &r->n_chunks);
  conic_memory_release(r->context, bytes);
  return status;
}

/* Lists no chunks where there is no table, or a wrong one. */
static conic_status read_table(laz_reading *r) {
  unsigned char head[CONIC_LAZ_TABLE_HEAD_BYTES];
  uint64_t offset, n_chunks = 0;
  size_t n = 0;
  conic_status status = find_table(r, &offset);
  if (status == CONIC_OK && offset)
    status = copy_packed(&r->from, offset, head, sizeof head, &n);
  if (status == CONIC_OK && n == sizeof head)
    n_chunks = conic_laz_table_count(head);
  if (status != CONIC_OK || n_chunks == 0 || n_chunks > (r->from.end - r->from.start) / r->format->point_bytes)
    return status;
  status = unpack_table(r, offset, n_chunks);
  if (status == CONIC_ERROR_INPUT) {
    r->n_chunks = 0;
    return CONIC_OK;
  }
  return status;
}

/* --- chunks side by side --- */

typedef struct laz_group {
  laz_reading *reading;
  size_t first, n;
  size_t packed_at[GROUP], records_at[GROUP];
  conic_status status[GROUP];
} laz_group;

static void unpack_chunk(void *data, size_t i_item, int i_thread) {
  laz_group *group = data;
  laz_reading *r = group->reading;
  const conic_laz_chunk *chunk = &r->chunks[group->first + i_item];
  group->status[i_item] =
      conic_laz_decode(r->decoders[i_thread], r->format, r->packed + group->packed_at[i_item], (size_t)chunk->n_bytes,
                       (size_t)chunk->n_points, r->wanted, r->records + group->records_at[i_item]);
}

static int is_for_group(const laz_reading *r, size_t i) {
  size_t most = MOST_AT_ONCE / r->format->point_bytes;
  return i < r->n_chunks && r->chunks[i].n_points <= most &&
         r->chunks[i].n_points * r->format->point_bytes <= MOST_GAIN * r->chunks[i].n_bytes &&
         r->chunks[i].n_bytes <= conic_laz_most_bytes(r->format, most);
}

/* Chunks without bytes, which damaged files have, need an address, too. */
static conic_status reserve_room(laz_reading *r, unsigned char **bytes, size_t *room, size_t wanted) {
  return wanted < *room ? CONIC_OK : conic_memory_reserve(r->context, bytes, 0, wanted + 1, room, 1);
}

/* Takes as many chunks of the usual size as keep all threads busy for a while. */
static conic_status plan_group(laz_reading *r, laz_group *group) {
  size_t n_packed = 0, n_records = 0, most = (size_t)r->n_threads * CHUNKS_A_THREAD;
  for (group->n = 0; group->n < GROUP && is_for_group(r, group->first + group->n); group->n++) {
    const conic_laz_chunk *chunk = &r->chunks[group->first + group->n];
    if (group->n >= most && n_records + chunk->n_points * r->format->point_bytes > most * USUAL_BYTES)
      break;
    if (group->n > 0 && r->n_read + n_records / r->format->point_bytes >= r->end)
      break;
    group->packed_at[group->n] = n_packed;
    group->records_at[group->n] = n_records;
    n_packed += (size_t)chunk->n_bytes;
    n_records += (size_t)chunk->n_points * r->format->point_bytes;
  }
  conic_status status = reserve_room(r, &r->packed, &r->packed_room, n_packed);
  return status == CONIC_OK ? reserve_room(r, &r->records, &r->records_room, n_records) : status;
}

static conic_status hand_over(laz_reading *r, const unsigned char *records, size_t n) {
  uint64_t at = r->n_read, first = at > r->first ? at : r->first, end = at + n < r->end ? at + n : r->end;
  r->n_read += n;
  return first < end ? r->receive(r->cookie, records + (first - at) * r->format->point_bytes, (size_t)(end - first))
                     : CONIC_OK;
}

static conic_status read_group(laz_reading *r, laz_group *group) {
  conic_status status = plan_group(r, group);
  if (status != CONIC_OK)
    return status;
  const conic_laz_chunk *first = &r->chunks[group->first], *last = first + group->n - 1;
  size_t n_bytes = (size_t)(last->offset + last->n_bytes - first->offset), n;
  status = copy_packed(&r->from, first->offset, r->packed, n_bytes, &n);
  if (status == CONIC_OK && n < n_bytes)
    return laz_spoiled(r, first->offset, group->first);
  if (status != CONIC_OK)
    return status;
  conic_parallel_for(r->context, group->n, unpack_chunk, group);
  for (size_t i = 0; i < group->n && status == CONIC_OK; i++) {
    status =
        group->status[i] == CONIC_ERROR_INPUT ? laz_spoiled(r, first[i].offset, group->first + i) : group->status[i];
    if (status == CONIC_OK)
      status = hand_over(r, r->records + group->records_at[i], (size_t)first[i].n_points);
  }
  return status;
}

/* --- a chunk in pieces --- */

/* Decodes the next n points of the first decoder's chunk. */
static conic_status decode_piece(laz_reading *r, size_t n) {
  conic_status status = note_spoiled(r, conic_laz_next(r->decoders[0], n, r->records));
  if (status == CONIC_OK)
    status = conic_progress(r->context, "read", (double)r->n_read / (double)r->n_points);
  return status == CONIC_OK ? hand_over(r, r->records, n) : status;
}

/* Decodes in a window that moves through the file. *n_bytes is how many the chunk took. */
static conic_status read_serial(laz_reading *r, uint64_t offset, uint64_t n_points, uint64_t *n_bytes) {
  const conic_laz_format *format = r->format;
  conic_laz_decoder *decoder = r->decoders[0];
  size_t window = conic_laz_most_bytes(format, r->piece), n;
  window = window < bytes_after(&r->from, offset) ? window : (size_t)bytes_after(&r->from, offset);
  conic_status status = reserve_room(r, &r->packed, &r->packed_room, window);
  if (status == CONIC_OK)
    status = reserve_room(r, &r->records, &r->records_room, r->piece * format->point_bytes);
  *n_bytes = 0;
  for (uint64_t done = 0; done < n_points && status == CONIC_OK;) {
    size_t n_now = n_points - done < r->piece ? (size_t)(n_points - done) : r->piece;
    status = copy_packed(&r->from, offset + *n_bytes, r->packed, window, &n);
    if (status == CONIC_OK && done == 0)
      status = note_spoiled(r, conic_laz_begin(decoder, format, r->packed, n, n_points, r->wanted));
    else if (status == CONIC_OK)
      conic_laz_feed(decoder, r->packed, n);
    if (status == CONIC_OK)
      status = decode_piece(r, n_now);
    *n_bytes += status == CONIC_OK ? conic_laz_taken(decoder) : 0;
    done += n_now;
  }
  return status;
}

static conic_status decode_pieces(laz_reading *r, size_t n_bytes, uint64_t n_points) {
  conic_laz_decoder *decoder = r->decoders[0];
  conic_status status = note_spoiled(r, conic_laz_begin(decoder, r->format, r->packed, n_bytes, n_points, r->wanted));
  for (uint64_t done = 0; done < n_points && status == CONIC_OK;) {
    size_t n_now = n_points - done < r->piece ? (size_t)(n_points - done) : r->piece;
    status = decode_piece(r, n_now);
    done += n_now;
  }
  return status;
}

/* Needs all bytes of the chunk at once. With `n_points` 0 the chunk's head tells the number. */
static conic_status read_layered(laz_reading *r, uint64_t offset, uint64_t n_points, uint64_t *n_bytes) {
  const conic_laz_format *format = r->format;
  size_t n_head = conic_laz_head_bytes(format), n;
  conic_status status = reserve_room(r, &r->packed, &r->packed_room, n_head);
  if (status == CONIC_OK)
    status = reserve_room(r, &r->records, &r->records_room, r->piece * format->point_bytes);
  if (status == CONIC_OK)
    status = copy_packed(&r->from, offset, r->packed, n_head, &n);
  if (status != CONIC_OK)
    return status;
  *n_bytes = n == n_head ? conic_laz_layered_bytes(format, r->packed) : UINT64_MAX;
  if (*n_bytes > bytes_after(&r->from, offset))
    return note_spoiled(r, CONIC_ERROR_INPUT);
  if (n_points == 0)
    n_points = conic_laz_layered_points(format, r->packed);
  n_points = n_points < r->n_points - r->n_read ? n_points : r->n_points - r->n_read;
  status = reserve_room(r, &r->packed, &r->packed_room, (size_t)*n_bytes);
  if (status == CONIC_OK)
    status = copy_packed(&r->from, offset, r->packed, (size_t)*n_bytes, &n);
  return status == CONIC_OK ? decode_pieces(r, n, n_points) : status;
}

static conic_status read_chunk(laz_reading *r, uint64_t offset, uint64_t n_points, uint64_t *n_bytes) {
  return r->format->compressor == 3 ? read_layered(r, offset, n_points, n_bytes)
                                    : read_serial(r, offset, n_points, n_bytes);
}

/* --- all chunks --- */

static conic_status read_listed(laz_reading *r) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < r->n_chunks && r->n_read < r->end && status == CONIC_OK;) {
    laz_group group = {.reading = r, .first = i, .n = 1};
    uint64_t n_bytes;
    if (r->n_read + r->chunks[i].n_points <= r->first) {
      r->n_read += r->chunks[i++].n_points;
      continue;
    }
    status = conic_progress(r->context, "read", (double)r->n_read / (double)r->n_points);
    if (status == CONIC_OK && is_for_group(r, i))
      status = read_group(r, &group);
    else if (status == CONIC_OK && r->chunks[i].n_points) {
      status = read_chunk(r, r->chunks[i].offset, r->chunks[i].n_points, &n_bytes);
      status = r->is_spoiled ? laz_spoiled(r, r->chunks[i].offset, i) : status;
    }
    i += group.n;
  }
  return status;
}

/* Reads chunks one after the other, each from where the one before ends, with all fields: which of them are spoiled
 * must not decide how many points there are. If the file ends within a chunk, the whole chunks have been read. */
static conic_status read_unlisted(laz_reading *r, uint64_t offset) {
  const conic_laz_format *format = r->format;
  int is_counted = format->chunk_points != CONIC_LAZ_VARIABLE;
  conic_status status = CONIC_OK;
  r->wanted = CONIC_LAZ_ALL;
  for (uint64_t i = 0, n_bytes = 0; r->n_read < r->end; i++, offset += n_bytes) {
    uint64_t left = r->n_points - r->n_read, n_points = left;
    if (is_counted)
      n_points = format->chunk_points < left ? format->chunk_points : left;
    else if (format->compressor == 3)
      n_points = 0;
    uint64_t n_before = r->n_read;
    status = read_chunk(r, offset, n_points, &n_bytes);
    if (r->is_spoiled)
      return r->n_read > 0 ? CONIC_OK : laz_spoiled(r, offset, i);
    if (status != CONIC_OK || r->n_read == n_before)
      break;
  }
  return status;
}

static conic_status make_decoders(laz_reading *r) {
  conic_status status = CONIC_OK;
  r->n_threads = conic_context_threads(r->context);
  r->decoders = conic_memory_allocate_zeroed(r->context, (size_t)r->n_threads, sizeof(conic_laz_decoder *));
  if (!r->decoders)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < r->n_threads && status == CONIC_OK; i++)
    status = conic_laz_decoder_create(r->context, &r->decoders[i]);
  return status;
}

static conic_status read_all_chunks(laz_reading *r) {
  int is_chunked = r->format->compressor != 1;
  conic_status status = is_chunked ? read_table(r) : CONIC_OK;
  if (status != CONIC_OK)
    return status;
  if (r->n_chunks > 0)
    status = read_listed(r);
  else if (is_chunked && r->format->compressor == 2 && r->format->chunk_points == CONIC_LAZ_VARIABLE)
    return conic_fail(r->context, CONIC_ERROR_INPUT, "%s: LAZ: the table of the chunks is missing (at byte %llu)",
                      r->from.input->name, (unsigned long long)r->from.start);
  else {
    if (is_chunked && !r->is_again)
      conic_log(r->context, CONIC_LOG_WARNING,
                "%s: LAZ: the table of the chunks is missing or spoiled; they are read one after the other",
                r->from.input->name);
    status = read_unlisted(r, r->from.start + (is_chunked ? 8 : 0));
  }
  return status;
}

conic_status conic_laz_read(conic_input *input, const conic_laz_format *format, uint64_t n_points, uint64_t first,
                            uint64_t end, unsigned wanted, int is_again, conic_laz_receiver *receive, void *cookie) {
  uint64_t start = conic_input_offset(input);
  laz_reading r = {.context = input->context,
                   .format = format,
                   .from = {.input = input, .start = start, .end = input->size_bytes},
                   .n_points = n_points,
                   .first = first,
                   .end = end < n_points ? end : n_points,
                   .wanted = wanted,
                   .is_again = is_again,
                   .receive = receive,
                   .cookie = cookie};
  size_t piece = PIECE_BYTES / format->point_bytes;
  r.piece = piece ? piece : 1;
  if (r.first >= r.end)
    return CONIC_OK;
  conic_status status = input->has_size ? CONIC_OK : hold_pipe(&r.from);
  if (status == CONIC_OK)
    status = make_decoders(&r);
  if (status == CONIC_OK)
    status = read_all_chunks(&r);
  if (status == CONIC_OK && r.n_read < r.end && !is_again)
    conic_log(r.context, CONIC_LOG_WARNING,
              "%s: LAZ: the file ends, or is spoiled, before all of its points: %llu of %llu are left out", input->name,
              (unsigned long long)(n_points - r.n_read), (unsigned long long)n_points);
  for (int i = 0; r.decoders && i < r.n_threads; i++)
    conic_laz_decoder_destroy(r.decoders[i]);
  conic_memory_release_these(r.context, r.decoders, r.chunks, r.packed, r.records, r.from.held);
  return status;
}
