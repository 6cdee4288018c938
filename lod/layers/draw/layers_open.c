/* Opening layered point clouds: header and index, from wherever they lie. */

#include "lod/layers/draw/layers_gather.h"
#include "lod/layers/draw/layers_octree.h"

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

int conic_layers_is_hierarchy(const char *path) {
  return conic_hierarchy_is_file(path);
}

const char *conic_layers_kind_name(const conic_layers *layers) {
  return layers->octree ? layers->octree->hierarchy->kind->name : "lpc";
}

int conic_layers_is_url(const char *name) {
  return conic_ranges_is_url(name);
}

/* Bytes from `offset` on, which the caller releases. Memory grows with what comes and not with what is claimed. */
static conic_status read_bytes(conic_layers *layers, uint64_t offset, uint64_t n_bytes, unsigned char **bytes) {
  const conic_range range = {.offset = offset, .n_bytes = (size_t)n_bytes};
  size_t n_read;
  return conic_ranges_read(layers->ranges, layers->name, &range, layers->until_s, bytes, &n_read);
}

/* The same of few bytes, into `to`. */
static conic_status read_head(conic_layers *layers, unsigned char *to, size_t n_bytes) {
  unsigned char *bytes;
  conic_status status = read_bytes(layers, 0, n_bytes, &bytes);
  if (status == CONIC_OK)
    memcpy(to, bytes, n_bytes);
  conic_memory_release(layers->context, bytes);
  return status;
}

void conic_layers_access_ranges(const conic_layers_access *access, double until_s, conic_ranges_options *options) {
  conic_ranges_options_init(options);
  options->connect_seconds = access->connect_seconds;
  options->stall_seconds = access->stall_seconds;
  options->n_retries = access->n_retries;
  options->pause_seconds = access->pause_seconds;
  options->n_connections = access->n_connections;
  options->most_whole_bytes = access->memory_bytes / 2;
  options->until_s = until_s;
}

static conic_status open_ranges(conic_layers *layers) {
  conic_ranges_options options;
  conic_layers_access_ranges(&layers->access, layers->until_s, &options);
  return conic_ranges_open(layers->context, layers->name, &options, &layers->ranges);
}

/* Header and index as they came. */
typedef struct layers_start {
  unsigned char header[CONIC_LAYERS_HEADER_BYTES];
  size_t n_header;
  unsigned char *index; /* null where the header is not whole */
  int is_whole;         /* by their sums */
} layers_start;

static conic_status read_start(conic_layers *layers, layers_start *start) {
  conic_layers_header *header = &layers->header;
  conic_status status = layers->ranges ? CONIC_OK : open_ranges(layers);
  if (status != CONIC_OK)
    return status;
  uint64_t size = conic_ranges_size(layers->ranges);
  start->n_header = size < sizeof start->header ? (size_t)size : sizeof start->header;
  if (size == 0)
    return conic_fail(layers->context, CONIC_ERROR_INPUT, "%s: the file is empty", layers->name);
  status = read_head(layers, start->header, start->n_header);
  start->is_whole = start->n_header == sizeof start->header && conic_layers_header_is_whole(start->header);
  if (status != CONIC_OK || !start->is_whole)
    return status;
  status = conic_layers_read_header(layers->context, layers->name, start->header, start->n_header, header);
  if (status == CONIC_OK && header->file_bytes != size)
    status = conic_fail(layers->context, CONIC_ERROR_INPUT, "%s: the file has %llu bytes, and should have %llu",
                        layers->name, (unsigned long long)size, (unsigned long long)header->file_bytes);
  if (status == CONIC_OK)
    status = read_bytes(layers, CONIC_LAYERS_HEADER_BYTES, conic_layers_index_bytes(header), &start->index);
  if (status == CONIC_OK)
    start->is_whole = conic_checksum(start->index, (size_t)conic_layers_index_bytes(header)) == header->index_sum;
  return status;
}

static void drop_start(conic_layers *layers, layers_start *start) {
  conic_memory_release(layers->context, start->index);
  memset(start, 0, sizeof *start);
}

static conic_status take_index(conic_layers *layers, const unsigned char *bytes) {
  conic_layers_header *header = &layers->header;
  size_t n_all = conic_layers_all_entries(header);
  if (conic_memory_allocate_these(layers->context, CONIC_ROOM(layers->entries, n_all),
                                  CONIC_ROOM(layers->first_sample, n_all)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_layers_read_index(layers->context, layers->name, header, bytes, layers->entries);
  uint64_t first = 0;
  layers->stand_ins = *header;
  if (status == CONIC_OK && header->version >= 3 &&
      conic_layers_stand_in_schema(&header->schema, header->quantum, &layers->stand_ins.schema))
    layers->n_all = (uint32_t)n_all;
  for (uint32_t i = 0; status == CONIC_OK && i < conic_layers_all(layers); i++) {
    layers->first_sample[i] = first;
    first += layers->entries[i].n_samples;
  }
  return status;
}

/* Whether the part that is damaged, header or index, is yet to be asked for again. */
static int is_to_repeat(const conic_layers *layers, const layers_start *start, int n_repeats[2]) {
  return !start->is_whole && layers->is_remote && layers->access.n_retries > 0 && n_repeats[!start->index]++ == 0;
}

/* What comes damaged from a server is asked for once again. */
static conic_status read_header_and_index(conic_layers *layers) {
  layers_start start = {.n_header = 0};
  int n_repeats[2] = {0, 0};
  conic_status status = read_start(layers, &start);
  while (status == CONIC_OK && is_to_repeat(layers, &start, n_repeats)) {
    conic_ranges_close(layers->ranges);
    layers->ranges = NULL;
    drop_start(layers, &start);
    status = read_start(layers, &start);
  }
  if (status == CONIC_OK && !start.index) /* which says what is wrong with it */
    status = conic_layers_read_header(layers->context, layers->name, start.header, start.n_header, &layers->header);
  else if (status == CONIC_OK)
    status = take_index(layers, start.index);
  drop_start(layers, &start);
  return status;
}

/* What the first bytes say that the file is: another's hierarchy, or a .lpc. */
static conic_status open_kind(conic_layers *layers) {
  unsigned char head[CONIC_HIERARCHY_HEAD_BYTES];
  conic_status status = open_ranges(layers);
  if (status != CONIC_OK)
    return status;
  uint64_t size = conic_ranges_size(layers->ranges);
  size_t n = size < sizeof head ? (size_t)size : sizeof head;
  if (n > 0)
    status = read_head(layers, head, n);
  if (status != CONIC_OK)
    return status;
  const conic_hierarchy_kind *kind = conic_hierarchy_kind_of(layers->name, head, n);
  return kind ? conic_layers_octree_open(layers, kind) : read_header_and_index(layers);
}

/* The file that is opened, where a folder is given. */
static conic_status take_name(conic_layers *layers, const char *name) {
  char file[CONIC_HIERARCHY_PATH_ROOM];
  if (!layers->is_remote && conic_hierarchy_find_file(name, file, sizeof file))
    name = file;
  layers->name = conic_memory_copy_text(layers->context, name);
  return layers->name ? CONIC_OK : CONIC_ERROR_MEMORY;
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
  made->choice.colored_by = -1;
  made->access = own;
  made->until_s = own.seconds > 0.0 ? conic_seconds_now() + own.seconds : HUGE_VAL;
  made->is_remote = conic_ranges_is_url(name);
  conic_status status = take_name(made, name);
  if (status == CONIC_OK)
    status = open_kind(made);
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
  conic_filter_destroy(context, layers->choice.filter);
  if (layers->octree)
    conic_layers_octree_close(layers);
  else
    conic_ranges_close(layers->ranges);
  conic_renderer_destroy(layers->hider);
  if (layers->set)
    conic_layers_set_release(context, layers->set);
  conic_memory_release_these(context, layers->set, layers->facings, layers->entries, layers->first_sample, layers->name,
                             layers);
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
  for (int axis = 0; axis < 3; axis++)
    scale->up[axis] = (double)header->up[axis];
}
