#include "lod/blends/levels_build.h"

#include "core/base/radix.h"
#include "core/base/real.h"
#include "core/files/file.h"
#include "core/files/spool.h"
#include "lod/blends/levels_tree.h"

/* AT_ONCE_BYTES: of clouds of a level that wait for others, about; the order of the file depends on it. */
enum { KEY_BITS = 21, BLOCK_ROWS = 4096, WRITE_ROWS = 256, SAMPLES = 512, AT_ONCE_BYTES = 1 << 26 };

/* A Gaussian on its way: its row, and its number as the last of its words. */
struct conic_levels_builder {
  conic_context *context;
  const char *path;
  uint64_t memory_bytes;
  conic_output *output;
  conic_spool rows;
  conic_levels_header header;
  size_t n_words;
  int has_box; /* something has a place */
  double per_cell;
  conic_levels_tree *tree;
  conic_levels_cloud cloud; /* that is being filled */
  size_t n_filled;
};

conic_status conic_levels_builder_open(conic_context *context, const char *path, uint32_t cloud_size,
                                       uint64_t memory_bytes, conic_levels_builder **builder) {
  conic_levels_builder *b = *builder = conic_memory_allocate_zeroed(context, 1, sizeof *b);
  if (!b)
    return CONIC_ERROR_MEMORY;
  b->context = context;
  b->path = path;
  b->memory_bytes = memory_bytes;
  b->header = (conic_levels_header){.version = CONIC_LEVELS_VERSION, .cloud_size = cloud_size};
  conic_spool_begin(context, path, (size_t)(memory_bytes / 4), &b->rows);
  conic_status status = conic_output_open(context, path, &b->output);
  if (status != CONIC_OK) {
    conic_levels_builder_abandon(b);
    *builder = NULL;
  }
  return status;
}

void conic_levels_builder_abandon(conic_levels_builder *builder) {
  if (!builder)
    return;
  conic_memory_release_these(builder->context, builder->cloud.rows, builder->cloud.parts, builder->cloud.numbers);
  conic_levels_tree_destroy(builder->tree);
  conic_spool_end(&builder->rows);
  conic_output_abandon(builder->output);
  conic_memory_release(builder->context, builder);
}

/* What the first scene says is so for all. */
static void begin_header(conic_levels_builder *b, const conic_gaussians *scene) {
  conic_levels_header *h = &b->header;
  h->flags = (scene->is_antialiased ? CONIC_LEVELS_ANTIALIASED : 0) | (scene->is_linear ? CONIC_LEVELS_LINEAR : 0);
  h->sh_degree = (uint32_t)scene->sh_degree;
  memcpy(h->origin, scene->origin, sizeof h->origin);
  memcpy(h->frame, scene->frame, sizeof h->frame);
  memcpy(h->up, scene->up, sizeof h->up);
  b->n_words = conic_levels_row(h) + 1;
}

static const char *find_difference(const conic_levels_builder *b, const conic_gaussians *scene) {
  if (!scene->scale[2])
    return "2D Gaussians are not merged; --payload plain keeps its discs";
  if (b->header.n + scene->count > CONIC_MOST_GAUSSIANS)
    return "the Gaussians are too many together";
  if (b->header.n == 0)
    return NULL;
  if (!scene->is_linear != !(b->header.flags & CONIC_LEVELS_LINEAR))
    return "scenes of linear and of display colours do not go together";
  return scene->sh_degree > (int)b->header.sh_degree
             ? "its harmonics have a higher degree than the first scene's: name it first"
             : NULL;
}

/* The words of Gaussian i. */
static void take_row(const conic_levels_builder *b, const conic_gaussians *scene, size_t i, float *row) {
  float room[CONIC_MOST_HARMONICS];
  const float *harmonics = conic_gaussians_harmonics(scene, i, room);
  const size_t n = conic_harmonics_of_degree((int)b->header.sh_degree),
               n_own = conic_harmonics_of_degree(scene->sh_degree);
  const uint32_t number = (uint32_t)(b->header.n + i);
  for (int axis = 0; axis < 3; axis++) {
    row[axis] = scene->position[axis][i];
    if (scene->origin[axis] != b->header.origin[axis])
      row[axis] = (float)(conic_gaussians_mean(scene, axis, i) - b->header.origin[axis]);
    row[CONIC_BLEND_SCALE + axis] = scene->scale[axis][i];
  }
  for (int k = 0; k < 4; k++)
    row[CONIC_BLEND_ROTATION + k] = scene->rotation[k][i];
  row[CONIC_BLEND_OPACITY] = scene->opacity[i];
  for (size_t k = 0; k < n; k++)
    row[CONIC_BLEND_HARMONICS + k] = k < n_own ? harmonics[k] : 0.0f;
  memcpy(row + b->n_words - 1, &number, sizeof number);
}

conic_status conic_levels_builder_append(conic_levels_builder *b, const char *name, conic_gaussians *scene) {
  double low[3], high[3];
  float words[CONIC_BLEND_MOST_FLOATS + 1];
  const char *wrong = find_difference(b, scene);
  if (wrong)
    return conic_fail(b->context, CONIC_ERROR_INPUT, "%s: %s", name, wrong);
  conic_status status = CONIC_OK;
  if (b->header.n == 0)
    begin_header(b, scene);
  else if (strcmp(scene->frame, b->header.frame) != 0)
    status = conic_gaussians_turn(b->context, scene, b->header.frame);
  if (status == CONIC_OK && conic_gaussians_bounds(scene, low, high) > 0) {
    for (int axis = 0; axis < 3; axis++) {
      b->header.low[axis] = b->has_box ? fmin(b->header.low[axis], low[axis]) : low[axis];
      b->header.high[axis] = b->has_box ? fmax(b->header.high[axis], high[axis]) : high[axis];
    }
    b->has_box = 1;
  }
  for (size_t i = 0; i < scene->count && status == CONIC_OK; i++) {
    take_row(b, scene, i, words);
    status = conic_spool_append(&b->rows, words, b->n_words * sizeof *words);
  }
  b->header.n += scene->count;
  return status;
}

/* --- in order --- */

/* Along Morton's curve over cubes; what has no place comes last. */
static uint64_t key_of(const conic_levels_builder *b, const float *row) {
  uint64_t key = 0;
  for (int axis = 0; axis < 3; axis++) {
    const double cell = ((double)row[axis] + b->header.origin[axis] - b->header.low[axis]) * b->per_cell;
    if (!(cell >= 0.0 && cell < (double)(1 << KEY_BITS)))
      return ((uint64_t)1 << 3 * KEY_BITS) - 1;
    key |= conic_spread_bits((uint64_t)cell) << axis;
  }
  return key;
}

/* Adds a Gaussian to the cloud that is being filled, and hands that on when it is whole. */
static conic_status add_row(conic_levels_builder *b, const float *words, size_t n_left) {
  const size_t n_row = b->n_words - 1;
  conic_status status = CONIC_OK;
  if (b->n_filled == 0)
    status = conic_levels_cloud_allocate(b->context, n_left < b->header.cloud_size ? n_left : b->header.cloud_size,
                                         n_row, &b->cloud);
  if (status != CONIC_OK)
    return status;
  memcpy(b->cloud.rows + b->n_filled * n_row, words, n_row * sizeof *words);
  memcpy(&b->cloud.numbers[b->n_filled++], words + n_row, sizeof *b->cloud.numbers);
  if (b->n_filled < b->cloud.n)
    return CONIC_OK;
  b->n_filled = 0;
  return conic_levels_tree_add(b->tree, &b->cloud);
}

/* Hands on n Gaussians in their order; so many came before. */
static conic_status add_in_order(conic_levels_builder *b, const float *words, size_t n, uint64_t n_before) {
  conic_radix_item *items = conic_memory_allocate(b->context, n, sizeof *items);
  conic_status status = items ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    items[i] = (conic_radix_item){key_of(b, words + i * b->n_words), (uint32_t)i};
  if (status == CONIC_OK)
    status = conic_radix_sort(b->context, items, n, 3 * KEY_BITS);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    if (i % BLOCK_ROWS == 0)
      status = conic_progress(b->context, "merge", (double)(n_before + i) / (double)b->header.n);
    if (status == CONIC_OK)
      status = add_row(b, words + items[i].value * b->n_words, (size_t)(b->header.n - n_before) - i);
  }
  conic_memory_release(b->context, items);
  return status;
}

/* Parts of the curve that fit into memory: part p has the keys up to ends[p]. */
typedef struct curve_parts {
  size_t n;
  uint64_t *ends, *begin, *filled; /* begin: of its Gaussians among all */
  float *block, *buffers;
  uint32_t *n_buffered;
  conic_scratch file;
} curve_parts;

static size_t part_of(const curve_parts *parts, uint64_t key) {
  size_t low = 0;
  CONIC_BISECT(low, parts->n - 1, parts->ends[middle] < key);
  return low;
}

CONIC_DEFINE_ORDER(order_keys, conic_radix_item, key)

/* Ends of parts by keys of some Gaussians. */
static conic_status find_ends(conic_levels_builder *b, curve_parts *parts) {
  const size_t n_samples = SAMPLES * parts->n;
  conic_radix_item *items = conic_memory_allocate(b->context, n_samples, sizeof *items);
  conic_status status = items ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n_samples && status == CONIC_OK; i++) {
    float row[3];
    const uint64_t at = b->header.n * i / n_samples;
    status = conic_spool_read(&b->rows, at * b->n_words * sizeof *row, row, sizeof row);
    items[i].key = key_of(b, row);
  }
  if (status == CONIC_OK) {
    qsort(items, n_samples, sizeof *items, order_keys);
    for (size_t p = 0; p < parts->n; p++)
      parts->ends[p] = items[(p + 1) * SAMPLES - 1].key;
  }
  conic_memory_release(b->context, items);
  return status;
}

static conic_status empty_buffer(conic_levels_builder *b, curve_parts *parts, size_t p) {
  const size_t n_bytes = b->n_words * sizeof(float), n = parts->n_buffered[p];
  conic_status status = conic_scratch_write(&parts->file, (parts->begin[p] + parts->filled[p]) * n_bytes,
                                            parts->buffers + p * WRITE_ROWS * b->n_words, n * n_bytes);
  parts->filled[p] += n;
  parts->n_buffered[p] = 0;
  return status;
}

/* Goes through all Gaussians: counts those of each part, or puts them there. */
static conic_status deal_rows(conic_levels_builder *b, curve_parts *parts, int is_counting) {
  conic_status status = CONIC_OK;
  const size_t n_bytes = b->n_words * sizeof(float);
  for (uint64_t at = 0; at < b->header.n && status == CONIC_OK; at += BLOCK_ROWS) {
    const size_t n = b->header.n - at < BLOCK_ROWS ? (size_t)(b->header.n - at) : BLOCK_ROWS;
    status = conic_spool_read(&b->rows, at * n_bytes, parts->block, n * n_bytes);
    if (status == CONIC_OK)
      status = conic_progress(b->context, "sort", (double)at / (double)b->header.n);
    for (size_t i = 0; i < n && status == CONIC_OK; i++) {
      const float *words = parts->block + i * b->n_words;
      const size_t p = part_of(parts, key_of(b, words));
      if (is_counting) {
        parts->begin[p + 1]++;
        continue;
      }
      memcpy(parts->buffers + (p * WRITE_ROWS + parts->n_buffered[p]++) * b->n_words, words, n_bytes);
      if (parts->n_buffered[p] == WRITE_ROWS)
        status = empty_buffer(b, parts, p);
    }
  }
  for (size_t p = 0; p < parts->n && status == CONIC_OK && !is_counting; p++)
    status = empty_buffer(b, parts, p);
  return status;
}

static conic_status add_parts(conic_levels_builder *b, curve_parts *parts) {
  conic_status status = CONIC_OK;
  const size_t n_bytes = b->n_words * sizeof(float);
  for (size_t p = 0; p < parts->n && status == CONIC_OK; p++) {
    const size_t n = (size_t)(parts->begin[p + 1] - parts->begin[p]);
    float *words = conic_memory_allocate(b->context, n, n_bytes);
    status =
        words ? conic_scratch_read(&parts->file, parts->begin[p] * n_bytes, words, n * n_bytes) : CONIC_ERROR_MEMORY;
    if (status == CONIC_OK)
      status = add_in_order(b, words, n, parts->begin[p]);
    conic_memory_release(b->context, words);
  }
  return status;
}

static conic_status add_by_parts(conic_levels_builder *b, size_t n) {
  curve_parts parts = {.n = n, .file = {.descriptor = -1}};
  conic_status status = conic_memory_allocate_these(
      b->context, CONIC_ROOM(parts.ends, n), CONIC_ZEROED(parts.begin, n + 1), CONIC_ZEROED(parts.filled, n),
      CONIC_ROOM(parts.block, BLOCK_ROWS * b->n_words), CONIC_ROOM(parts.buffers, n * WRITE_ROWS * b->n_words),
      CONIC_ZEROED(parts.n_buffered, n));
  if (status == CONIC_OK)
    status = conic_scratch_open(b->context, b->path, &parts.file);
  if (status == CONIC_OK)
    status = find_ends(b, &parts);
  if (status == CONIC_OK)
    status = deal_rows(b, &parts, 1);
  for (size_t p = 0; p < n && status == CONIC_OK; p++)
    parts.begin[p + 1] += parts.begin[p];
  if (status == CONIC_OK)
    status = deal_rows(b, &parts, 0);
  if (status == CONIC_OK)
    status = add_parts(b, &parts);
  conic_scratch_close(&parts.file);
  conic_memory_release_these(b->context, parts.ends, parts.begin, parts.filled, parts.block, parts.buffers,
                             parts.n_buffered);
  return status;
}

/* --- the file --- */

static conic_status write_levels(conic_levels_builder *b) {
  unsigned char bytes[CONIC_FILE_HEADER_BYTES] = {0};
  FILE *to = conic_output_stream(b->output);
  conic_levels_header *h = &b->header;
  const uint64_t n_bytes = h->n * b->n_words * sizeof(float);
  const uint64_t a_cloud = (uint64_t)h->cloud_size * 3 * b->n_words * sizeof(float);
  const uint64_t n_at_once = AT_ONCE_BYTES / (a_cloud * CONIC_LEVELS_CHILDREN * CONIC_LEVELS_CHILDREN);
  const double extent = fmax(h->high[0] - h->low[0], fmax(h->high[1] - h->low[1], h->high[2] - h->low[2]));
  b->per_cell = extent > 0.0 ? ((double)(1 << KEY_BITS) - 0.5) / extent : 0.0;
  h->n_leaves = (uint32_t)((h->n + h->cloud_size - 1) / h->cloud_size);
  fwrite(bytes, 1, sizeof bytes, to);
  conic_status status = conic_levels_tree_create(b->context, h,
                                                 n_at_once < 1    ? 1
                                                 : n_at_once > 64 ? 64
                                                                  : (size_t)n_at_once,
                                                 to, b->path, &b->tree);
  if (status == CONIC_OK)
    status = add_by_parts(b, (size_t)(n_bytes / (b->memory_bytes / 4) + 1));
  if (status == CONIC_OK)
    status = conic_levels_tree_end(b->tree, h);
  conic_levels_write_header(h, bytes);
  if (status == CONIC_OK && (fseek(to, 0, SEEK_SET) != 0 || fwrite(bytes, 1, sizeof bytes, to) != sizeof bytes))
    status = conic_fail(b->context, CONIC_ERROR_IO, "%s: cannot write: %s", b->path, strerror(errno));
  return status;
}

conic_status conic_levels_builder_finish(conic_levels_builder *b, conic_levels_statistics *statistics) {
  conic_levels_shape shape;
  conic_status status =
      !b->has_box ? conic_fail(b->context, CONIC_ERROR_INPUT, "%s: there is no Gaussian that could be drawn", b->path)
                  : write_levels(b);
  conic_levels_find_shape(b->header.n_leaves, &shape);
  *statistics = (conic_levels_statistics){b->header.n, b->header.n_merged, shape.n_clouds,
                                          b->header.index_at + (uint64_t)shape.n_clouds * CONIC_LEVELS_ENTRY_BYTES,
                                          shape.n_levels};
  if (status == CONIC_OK) {
    status = conic_output_commit(b->output);
    b->output = NULL;
  }
  conic_levels_builder_abandon(b);
  return status;
}
