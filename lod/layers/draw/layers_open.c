/* Opening layered point clouds: header and index, from wherever they lie. */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "lod/layers/draw/layers_gather.h"

/* The index is asked for in pieces, so that memory grows with what comes and not with what is claimed. */
enum { PIECE_BYTES = 1 << 22 };

void conic_layers_access_init_sized(conic_layers_access *access, size_t size) {
  conic_ranges_options ranges;
  conic_ranges_options_init(&ranges);
  conic_layers_access own;
  memset(&own, 0, sizeof own);
  own.size = sizeof own;
  own.memory_bytes = (uint64_t)512 << 20;
  own.connect_seconds = ranges.connect_seconds;
  own.stall_seconds = ranges.stall_seconds;
  own.n_retries = ranges.n_retries;
  own.pause_seconds = ranges.pause_seconds;
  own.n_connections = ranges.n_connections;
  conic_options_give(access, size, &own);
}

int conic_layers_is_url(const char *name) {
  return conic_ranges_is_url(name);
}

/* Bytes from `offset` on, into `to`; a whole piece at most. */
static conic_status read_piece(conic_layers *layers, uint64_t offset, unsigned char *to, size_t n_bytes) {
  conic_range range = {.offset = offset, .n_bytes = n_bytes};
  conic_range_answer answer;
  conic_status status = conic_ranges_request(layers->ranges, &range);
  while (status == CONIC_OK) {
    if (conic_ranges_next(layers->ranges, 0.1, &answer))
      break;
    if (conic_ranges_pending(layers->ranges) == 0)
      return CONIC_ERROR_MEMORY;
    if (layers->is_remote)
      status = conic_progress(layers->context, "fetch", 0.0);
  }
  if (status != CONIC_OK) {
    conic_ranges_cancel(layers->ranges);
    return status;
  }
  if (answer.status != CONIC_OK)
    return conic_fail(layers->context, answer.status, "%s: cannot read: %s (at byte %llu)", layers->name, answer.reason,
                      (unsigned long long)offset);
  memcpy(to, answer.bytes, n_bytes);
  conic_ranges_release(layers->ranges, &answer);
  return CONIC_OK;
}

/* Bytes from `offset` on, which the caller releases. */
static conic_status read_bytes(conic_layers *layers, uint64_t offset, uint64_t n_bytes, unsigned char **bytes) {
  size_t done = 0, room = 0;
  conic_status status = CONIC_OK;
  *bytes = NULL;
  while (done < n_bytes && status == CONIC_OK) {
    size_t piece = n_bytes - done < PIECE_BYTES ? (size_t)(n_bytes - done) : PIECE_BYTES;
    if (room - done < piece) {
      room = 2 * room + piece < n_bytes ? 2 * room + piece : (size_t)n_bytes;
      status = conic_memory_grow(layers->context, bytes, done, room, 1);
    }
    if (status == CONIC_OK)
      status = read_piece(layers, offset + done, *bytes + done, piece);
    done += piece;
  }
  return status;
}

/* Of a file that a server sends, damage is the network's. */
static conic_status as_read(const conic_layers *layers, conic_status status) {
  return layers->is_remote && status == CONIC_ERROR_INPUT ? CONIC_ERROR_IO : status;
}

static conic_status read_layers_header(conic_layers *layers) {
  unsigned char *bytes;
  uint64_t size = conic_ranges_size(layers->ranges);
  uint64_t n_bytes = size < CONIC_LAYERS_HEADER_BYTES ? size : CONIC_LAYERS_HEADER_BYTES;
  conic_status status = n_bytes ? read_bytes(layers, 0, n_bytes, &bytes) : CONIC_OK;
  if (!n_bytes)
    return conic_fail(layers->context, CONIC_ERROR_INPUT, "%s: the file is empty", layers->name);
  if (status == CONIC_OK)
    status = conic_layers_read_header(layers->context, layers->name, bytes, (size_t)n_bytes, &layers->header);
  conic_memory_release(layers->context, bytes);
  if (status == CONIC_OK && layers->header.file_bytes != size)
    status = conic_fail(layers->context, CONIC_ERROR_INPUT, "%s: the file has %llu bytes, and should have %llu",
                        layers->name, (unsigned long long)size, (unsigned long long)layers->header.file_bytes);
  return status;
}

static conic_status read_index(conic_layers *layers) {
  conic_context *context = layers->context;
  const conic_layers_header *header = &layers->header;
  unsigned char *bytes;
  conic_status status = read_bytes(layers, CONIC_LAYERS_HEADER_BYTES, conic_layers_index_bytes(header), &bytes);
  if (status == CONIC_OK) {
    layers->entries = conic_memory_allocate(context, header->n_clouds, sizeof *layers->entries);
    layers->first_sample = conic_memory_allocate(context, header->n_clouds, sizeof *layers->first_sample);
    status = layers->entries && layers->first_sample ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK)
    status = as_read(layers, conic_layers_read_index(context, layers->name, header, bytes, layers->entries));
  conic_memory_release(context, bytes);
  uint64_t first = 0;
  for (uint32_t i = 0; status == CONIC_OK && i < header->n_clouds; i++) {
    layers->first_sample[i] = first;
    first += layers->entries[i].n_samples;
  }
  return status;
}

static conic_status open_ranges(conic_layers *layers) {
  conic_ranges_options options;
  conic_ranges_options_init(&options);
  options.connect_seconds = layers->access.connect_seconds;
  options.stall_seconds = layers->access.stall_seconds;
  options.n_retries = layers->access.n_retries;
  options.pause_seconds = layers->access.pause_seconds;
  options.n_connections = layers->access.n_connections;
  options.most_whole_bytes = layers->access.memory_bytes / 2;
  return conic_ranges_open(layers->context, layers->name, &options, &layers->ranges);
}

conic_status conic_layers_open(conic_context *context, const char *name, const conic_layers_access *access,
                               conic_layers **layers) {
  *layers = NULL;
  conic_layers_access own;
  conic_layers_access_init(&own);
  if (access && !conic_options_take(&own, access))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "layers: the access options were not initialised");
  conic_layers *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->access = own;
  made->is_remote = conic_ranges_is_url(name);
  made->name = conic_memory_allocate(context, strlen(name) + 1, 1);
  conic_status status = made->name ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    memcpy(made->name, name, strlen(name) + 1);
    status = open_ranges(made);
  }
  if (status == CONIC_OK)
    status = read_layers_header(made);
  if (status == CONIC_OK)
    status = read_index(made);
  if (status == CONIC_OK)
    status = conic_layers_store_open(made);
  if (status != CONIC_OK) {
    conic_layers_close(made);
    return status;
  }
  *layers = made;
  return CONIC_OK;
}

void conic_layers_close(conic_layers *layers) {
  if (!layers)
    return;
  conic_context *context = layers->context;
  conic_layers_store_close(layers);
  conic_ranges_close(layers->ranges);
  conic_renderer_destroy(layers->hider);
  if (layers->set)
    conic_layers_set_release(context, layers->set);
  conic_memory_release(context, layers->set);
  conic_memory_release(context, layers->entries);
  conic_memory_release(context, layers->first_sample);
  conic_memory_release(context, layers->name);
  conic_memory_release(context, layers);
}

void conic_layers_measure(const conic_layers *layers, float cutoff, conic_layers_scale *scale) {
  const conic_layers_header *header = &layers->header;
  memset(scale, 0, sizeof *scale);
  scale->n_samples = header->n_samples;
  scale->n_clouds = header->n_clouds;
  scale->n_levels = (int)header->n_levels;
  scale->has_colors = (header->flags & CONIC_LAYERS_COLORS) != 0;
  memcpy(scale->minimum, header->low, sizeof scale->minimum);
  memcpy(scale->maximum, header->high, sizeof scale->maximum);
  scale->near_z = header->near_z;
  scale->splat_length = header->splat_radius / (double)cutoff;
  scale->spacing = header->spacing;
}
