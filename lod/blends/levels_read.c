#include "lod/blends/levels_read.h"

#include "lod/layers/draw/layers_scene.h"

static conic_status read_levels_bytes(conic_levels *l, uint64_t offset, size_t n, unsigned char **bytes) {
  const conic_range range = {.offset = offset, .n_bytes = n};
  size_t n_read;
  return conic_ranges_read(l->ranges, l->name, &range, l->until_s, bytes, &n_read);
}

static conic_status read_levels_start(conic_levels *l) {
  unsigned char *bytes = NULL;
  const uint64_t size = conic_ranges_size(l->ranges);
  const size_t n = size < CONIC_FILE_HEADER_BYTES ? (size_t)size : CONIC_FILE_HEADER_BYTES;
  conic_status status = n ? read_levels_bytes(l, 0, n, &bytes) : CONIC_OK;
  if (status == CONIC_OK)
    status = conic_levels_read_header(l->context, l->name, bytes, n, size, &l->header);
  conic_memory_release(l->context, bytes);
  bytes = NULL;
  if (status != CONIC_OK)
    return status;
  conic_levels_find_shape(l->header.n_leaves, &l->shape);
  status = conic_memory_allocate_these(l->context, CONIC_ROOM(l->entries, l->shape.n_clouds),
                                       CONIC_ZEROED(l->clouds, l->shape.n_clouds));
  if (status == CONIC_OK)
    status = read_levels_bytes(l, l->header.index_at, (size_t)l->shape.n_clouds * CONIC_LEVELS_ENTRY_BYTES, &bytes);
  if (status == CONIC_OK)
    status = conic_levels_read_index(l->context, l->name, &l->header, bytes, l->entries);
  conic_memory_release(l->context, bytes);
  return status;
}

conic_status conic_levels_open(conic_context *context, const char *name, const conic_layers_access *access,
                               conic_levels **levels) {
  conic_layers_access own;
  conic_ranges_options options;
  *levels = NULL;
  conic_layers_access_init(&own);
  if (access && !conic_options_take(&own, access))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "levels: the access options were not initialised");
  conic_levels *l = conic_memory_allocate_zeroed(context, 1, sizeof *l);
  if (!l)
    return CONIC_ERROR_MEMORY;
  l->context = context;
  l->memory_bytes = own.memory_bytes;
  l->until_s = own.seconds > 0.0 ? conic_seconds_now() + own.seconds : HUGE_VAL;
  conic_layers_access_ranges(&own, l->until_s, &options);
  l->name = conic_memory_copy_text(context, name);
  conic_status status = l->name ? conic_zstd_create(context, &l->zstd) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_ranges_open(context, name, &options, &l->ranges);
  if (status == CONIC_OK)
    status = read_levels_start(l);
  if (status != CONIC_OK)
    conic_levels_close(l);
  else
    *levels = l;
  return status;
}

void conic_levels_drop(conic_levels *levels, uint32_t cloud) {
  conic_memory_release(levels->context, levels->clouds[cloud].columns);
  levels->clouds[cloud] = (conic_levels_loaded){NULL, NULL};
}

void conic_levels_close(conic_levels *levels) {
  if (!levels)
    return;
  for (uint32_t i = 0; levels->clouds && i < levels->shape.n_clouds; i++)
    conic_levels_drop(levels, i);
  conic_ranges_close(levels->ranges);
  conic_zstd_destroy(levels->context, levels->zstd);
  conic_memory_release_these(levels->context, levels->entries, levels->clouds, levels->name, levels);
}

/* --- clouds --- */

static int is_leaf_cloud(const conic_levels *l, uint32_t i) {
  return i >= l->shape.n_clouds - l->header.n_leaves;
}

/* How many Gaussians the cloud above has; 1 above the root. */
static uint32_t count_above(const conic_levels *l, uint32_t i) {
  int level = l->shape.n_levels - 1;
  while (level > 0 && l->shape.first[level] > i)
    level--;
  return level ? l->entries[l->shape.first[level - 1] + (i - l->shape.first[level]) / CONIC_LEVELS_CHILDREN].n : 1;
}

/* Whether the numbers beside the rows have a meaning. */
static int is_sound(const conic_levels *l, uint32_t i, const uint32_t *columns) {
  const size_t n = l->entries[i].n, n_row = conic_levels_row(&l->header), is_leaf = (size_t)is_leaf_cloud(l, i);
  const uint32_t *link = columns + (conic_levels_columns(&l->header, (int)is_leaf) - 1) * n,
                 n_above = count_above(l, i);
  for (size_t k = 0; k < n; k++) {
    if ((link[k] & CONIC_LEVELS_PARENT) >= n_above || link[k] >> (CONIC_LEVELS_PARTS_BIT + CONIC_LEVELS_CHILDREN))
      return 0;
    if (is_leaf && columns[n_row * n + k] >= l->header.n)
      return 0;
    for (size_t c = 0; !is_leaf && c < CONIC_BLEND_PARTS; c++) {
      const float value = conic_float_of_bits(columns[(n_row + c) * n + k]);
      if (value - value != 0.0f || (c < CONIC_BLEND_PARTS - 3 && value < 0.0f)) /* all but the tint */
        return 0;
    }
  }
  return 1;
}

static conic_status take_cloud(conic_levels *l, uint32_t i, const unsigned char *bytes) {
  const conic_levels_entry *entry = &l->entries[i];
  const size_t n_columns = conic_levels_columns(&l->header, is_leaf_cloud(l, i)), n_words = n_columns * entry->n;
  conic_levels_loaded *cloud = &l->clouds[i];
  if (conic_checksum(bytes, entry->n_bytes) != entry->sum)
    return conic_fail(l->context, CONIC_ERROR_INPUT, "%s: cloud %u is damaged: its sum is another (at byte %llu)",
                      l->name, (unsigned)i, (unsigned long long)entry->offset);
  unsigned char *planes = conic_memory_allocate(l->context, n_words, 4);
  cloud->columns = conic_memory_allocate(l->context, 4 * n_words + entry->n, 1);
  conic_status status = planes && cloud->columns ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK &&
      (!conic_levels_unpack(l->zstd, bytes, entry->n_bytes, n_columns, entry->n, planes, cloud->columns) ||
       !is_sound(l, i, cloud->columns)))
    status = conic_fail(l->context, CONIC_ERROR_INPUT, "%s: cloud %u is damaged (at byte %llu)", l->name, (unsigned)i,
                        (unsigned long long)entry->offset);
  conic_memory_release(l->context, planes);
  if (status != CONIC_OK)
    conic_levels_drop(l, i);
  else
    cloud->is_open = (unsigned char *)(cloud->columns + n_words);
  l->n_read += status == CONIC_OK;
  return status;
}

static conic_status await_cloud(conic_levels *l) {
  conic_range_answer answer;
  while (!conic_ranges_next(l->ranges, 0.1, &answer)) {
    conic_status status =
        conic_ranges_pending(l->ranges) ? conic_progress(l->context, "fetch", 0.0) : CONIC_ERROR_MEMORY;
    if (status != CONIC_OK)
      return status;
  }
  if (answer.status != CONIC_OK)
    return conic_fail(l->context, answer.status, "%s: cannot read: %s (at byte %llu)", l->name, answer.reason,
                      (unsigned long long)l->entries[answer.id].offset);
  conic_status status = take_cloud(l, answer.id, answer.bytes);
  conic_ranges_release(l->ranges, &answer);
  return status;
}

conic_status conic_levels_load(conic_levels *levels, const uint32_t *clouds, size_t n) {
  conic_status status = CONIC_OK;
  size_t n_asked = 0;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const conic_levels_entry *entry = &levels->entries[clouds[i]];
    const conic_range range = {entry->offset, entry->n_bytes, i, clouds[i], ""};
    if (levels->clouds[clouds[i]].columns)
      continue;
    status = conic_ranges_request(levels->ranges, &range);
    n_asked++;
  }
  for (size_t i = 0; i < n_asked && status == CONIC_OK; i++)
    status = await_cloud(levels);
  if (status != CONIC_OK)
    conic_ranges_cancel(levels->ranges);
  return status;
}

/* --- all of it --- */

conic_status conic_levels_read(conic_context *context, const char *path, conic_gaussians *set) {
  const conic_levels_wish all = {.part = CONIC_LEVELS_ALL};
  conic_levels_scene scene;
  memset(&scene, 0, sizeof scene);
  conic_status status = conic_levels_open(context, path, NULL, &scene.levels);
  if (status == CONIC_OK)
    status = conic_levels_choose(&scene, 1, &all);
  conic_levels_close(scene.levels);
  *set = scene.set;
  return status;
}

/* Whether no Gaussian of a cloud has sums above those of what stands for it. */
static int is_bounded(const conic_levels *l, uint32_t above, uint32_t i) {
  const size_t n = l->entries[i].n, n_above = l->entries[above].n, n_row = conic_levels_row(&l->header);
  const uint32_t *own = l->clouds[i].columns, *over = l->clouds[above].columns;
  const uint32_t *link = own + (conic_levels_columns(&l->header, is_leaf_cloud(l, i)) - 1) * n;
  for (size_t k = 0; k < n && !is_leaf_cloud(l, i); k++)
    for (size_t c = n_row; c < n_row + 3; c++) /* light, depth, edge */
      if (conic_float_of_bits(own[c * n + k]) >
          conic_float_of_bits(over[c * n_above + (link[k] & CONIC_LEVELS_PARENT)]))
        return 0;
  return 1;
}

conic_status conic_levels_check(conic_levels *l, uint64_t *n_damaged, uint64_t *n_unbounded) {
  conic_status status = CONIC_OK;
  *n_damaged = *n_unbounded = 0;
  for (int level = 0; level < l->shape.n_levels; level++)
    for (uint32_t k = 0; k < l->shape.count[level]; k++) {
      const uint32_t i = l->shape.first[level] + k;
      const uint32_t above = level ? l->shape.first[level - 1] + k / CONIC_LEVELS_CHILDREN : i;
      status = conic_levels_load(l, &i, 1);
      if (status != CONIC_OK && status != CONIC_ERROR_INPUT)
        return status;
      *n_damaged += status != CONIC_OK;
      if (status == CONIC_OK && level && l->clouds[above].columns)
        *n_unbounded += !is_bounded(l, above, i);
      if (level && (k % CONIC_LEVELS_CHILDREN == CONIC_LEVELS_CHILDREN - 1 || k + 1 == l->shape.count[level]))
        conic_levels_drop(l, above);
    }
  return CONIC_OK;
}
