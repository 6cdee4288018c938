/* Opening a hybrid model from wherever it lies: header and arrays. Pictures read the chunks that they show. */

#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/hybrid/model/hybrid_layout.h"
#include "lod/hybrid/model/hybrid_store.h"

/* The arrays are asked for in pieces, so that memory grows with what comes and not with what is claimed. */
enum { INDEX_PIECE_BYTES = 1 << 22 };

typedef struct chy_opening {
  conic_hybrid *hybrid;
  const char *name;
  conic_layers_access access;
  double until_s;
  conic_ranges *ranges;
} chy_opening;

int conic_hybrid_is_url(const char *name) {
  size_t n = strcspn(name, "?#");
  return conic_ranges_is_url(name) && n > 4 && strncmp(name + n - 4, ".chy", 4) == 0;
}

static conic_status open_chy_ranges(chy_opening *o) {
  conic_ranges_options options;
  conic_ranges_options_init(&options);
  options.connect_seconds = o->access.connect_seconds;
  options.stall_seconds = o->access.stall_seconds;
  options.n_retries = o->access.n_retries;
  options.pause_seconds = o->access.pause_seconds;
  options.n_connections = o->access.n_connections;
  if (o->access.memory_bytes)
    options.most_whole_bytes = o->access.memory_bytes / 2;
  options.until_s = o->until_s;
  return conic_ranges_open(o->hybrid->context, o->name, &options, &o->ranges);
}

/* Reads `n_bytes` from the beginning of the file; the first `done` are there. */
static conic_status read_to(chy_opening *o, uint64_t n_bytes, uint64_t done, unsigned char **bytes) {
  conic_context *context = o->hybrid->context;
  uint64_t room = done;
  conic_status status = CONIC_OK;
  while (done < n_bytes && status == CONIC_OK) {
    uint64_t left = n_bytes - done;
    conic_range range = {.offset = done, .n_bytes = left < INDEX_PIECE_BYTES ? (size_t)left : INDEX_PIECE_BYTES};
    unsigned char *piece = NULL;
    size_t n_piece;
    status = conic_ranges_read(o->ranges, o->name, &range, o->until_s, &piece, &n_piece);
    if (status == CONIC_OK && room - done < n_piece) {
      room = 2 * room + n_piece < n_bytes ? 2 * room + n_piece : n_bytes;
      status = conic_memory_grow(context, bytes, (size_t)done, (size_t)room, 1);
    }
    if (status == CONIC_OK && *bytes)
      memcpy(*bytes + done, piece, n_piece);
    done += n_piece;
    conic_memory_release(context, piece);
  }
  return status;
}

static conic_status read_chy_index(chy_opening *o, unsigned char **bytes) {
  conic_hybrid *h = o->hybrid;
  uint64_t size = conic_ranges_size(o->ranges);
  uint64_t n_header = size < CONIC_FILE_HEADER_BYTES ? size : CONIC_FILE_HEADER_BYTES;
  if (size == 0)
    return conic_fail(h->context, CONIC_ERROR_INPUT, "%s: the file is empty", o->name);
  conic_status status = read_to(o, n_header, 0, bytes);
  if (status == CONIC_OK)
    status = conic_file_read_header(h->context, o->name, &conic_chy_kind, *bytes, (size_t)n_header, h);
  if (status != CONIC_OK)
    return status;
  uint64_t n_bytes = conic_chy_lay_out(h).n_bytes;
  if (n_bytes <= size)
    status = read_to(o, n_bytes, n_header, bytes);
  return status == CONIC_OK ? conic_chy_take_index(h, o->name, size, *bytes) : status;
}

/* What comes damaged from a server is asked for once again. */
static conic_status open_chy_index(chy_opening *o) {
  conic_hybrid *h = o->hybrid;
  conic_status status = CONIC_OK;
  for (int is_second = 0; is_second < 2; is_second++) {
    unsigned char *bytes = NULL;
    status = open_chy_ranges(o);
    if (status == CONIC_OK)
      status = read_chy_index(o, &bytes);
    h->owned = bytes;
    if (status != CONIC_ERROR_INPUT || is_second || !o->ranges || !conic_ranges_is_url(o->name) ||
        o->access.n_retries == 0)
      return status;
    conic_ranges_close(o->ranges);
    conic_memory_release(h->context, bytes);
    o->ranges = NULL;
    h->owned = NULL;
  }
  return status;
}

/* What is left of the memory when the program and the index have theirs is shared by what is drawn and the chunks. */
static uint64_t share_memory(chy_opening *o) {
  conic_hybrid *h = o->hybrid;
  const uint64_t own_bytes = (UINT64_C(14) << 20) + ((uint64_t)conic_context_threads(h->context) << 21);
  uint64_t all = o->access.memory_bytes, index = conic_chy_lay_out(h).n_bytes + 32 * conic_hybrid_count_chunks(h);
  uint64_t rest = all > own_bytes + index + all / 4 ? all - own_bytes - index : all / 4;
  h->drawing_bytes = rest / 2;
  return rest / 5 * 2;
}

static conic_status open_chy(chy_opening *o) {
  conic_hybrid *h = o->hybrid;
  conic_status status = open_chy_index(o);
  if (status != CONIC_OK) {
    conic_ranges_close(o->ranges);
    return status;
  }
  return conic_hybrid_store_open(h, o->name, o->ranges, conic_chy_lay_out(h).n_bytes, share_memory(o), &h->store);
}

conic_status conic_hybrid_open(conic_context *context, const char *name, const conic_layers_access *access,
                               conic_hybrid **hybrid) {
  chy_opening o = {.name = name};
  *hybrid = NULL;
  conic_layers_access_init(&o.access);
  o.access.memory_bytes = 0;
  if (access && !conic_options_take(&o.access, access))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "hybrid: the access options were not initialised");
  o.until_s = o.access.seconds > 0.0 ? conic_seconds_now() + o.access.seconds : HUGE_VAL;
  o.hybrid = conic_memory_allocate_zeroed(context, 1, sizeof *o.hybrid);
  if (!o.hybrid)
    return CONIC_ERROR_MEMORY;
  o.hybrid->context = context;
  conic_status status = open_chy(&o);
  if (status == CONIC_OK)
    *hybrid = o.hybrid;
  else
    conic_hybrid_destroy(o.hybrid);
  return status;
}
