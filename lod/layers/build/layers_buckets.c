#include "lod/layers/build/layers_buckets.h"

#include <math.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "lod/layers/format/layers_key.h"

/* So many bits of the keys part the samples at a time. */
enum { SPLIT_BITS = 12, N_SPLIT = 1 << SPLIT_BITS };

static void release_bucket(conic_context *context, conic_layers_bucket *bucket) {
  conic_memory_release(context, bucket->blocks);
  conic_memory_release(context, bucket->open);
  memset(bucket, 0, sizeof *bucket);
}

void conic_layers_buckets_end(conic_layers_buckets *buckets) {
  if (!buckets->context)
    return;
  for (size_t i = 0; i < buckets->n; i++)
    release_bucket(buckets->context, &buckets->buckets[i]);
  conic_memory_release(buckets->context, buckets->buckets);
  conic_spool_end(&buckets->spool);
  memset(buckets, 0, sizeof *buckets);
}

/* Puts the open block away. */
static conic_status close_block(conic_layers_buckets *all, conic_layers_bucket *bucket) {
  if (bucket->n_open == 0)
    return CONIC_OK;
  if (conic_memory_reserve(all->context, &bucket->blocks, bucket->n_blocks, bucket->n_blocks + 1, &bucket->block_room,
                           sizeof *bucket->blocks) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  bucket->blocks[bucket->n_blocks++] = conic_spool_bytes(&all->spool);
  size_t n_bytes = bucket->n_open * sizeof *bucket->open;
  bucket->n_open = 0;
  return conic_spool_append(&all->spool, bucket->open, n_bytes);
}

static conic_status add_sample(conic_layers_buckets *all, conic_layers_bucket *bucket,
                               const conic_layers_sample *sample) {
  if (!bucket->open) {
    bucket->open = conic_memory_allocate(all->context, all->block_samples, sizeof *bucket->open);
    if (!bucket->open)
      return CONIC_ERROR_MEMORY;
  }
  bucket->open[bucket->n_open++] = *sample;
  bucket->count++;
  return bucket->n_open == all->block_samples ? close_block(all, bucket) : CONIC_OK;
}

/* The cells that a cell's keys are parted into. */
typedef struct split {
  uint64_t key;
  unsigned n_bits; /* below the cells' own */
  conic_layers_bucket cells[N_SPLIT];
} split;

static void begin_split(uint64_t key, unsigned n_bits, split *parts) {
  memset(parts, 0, sizeof *parts);
  parts->key = key;
  parts->n_bits = n_bits > SPLIT_BITS ? n_bits - SPLIT_BITS : 0;
}

static conic_status add_to_split(conic_layers_buckets *all, split *parts, const conic_layers_sample *sample) {
  return add_sample(all, &parts->cells[(sample->key - parts->key) >> parts->n_bits], sample);
}

/* Puts what is left in open blocks away and hands the buckets that hold any over, in place of number `at`, which is
 * dropped; or at the end. */
static conic_status end_split(conic_layers_buckets *all, split *parts, size_t at) {
  conic_status status = CONIC_OK;
  size_t n_new = 0, n_dropped = at < all->n;
  for (size_t i = 0; i < N_SPLIT && status == CONIC_OK; i++) {
    conic_layers_bucket *cell = &parts->cells[i];
    cell->key = parts->key + ((uint64_t)i << parts->n_bits);
    cell->n_bits = parts->n_bits;
    status = close_block(all, cell);
    conic_memory_release(all->context, cell->open);
    cell->open = NULL;
    n_new += cell->count > 0;
  }
  if (status == CONIC_OK)
    status =
        conic_memory_reserve(all->context, &all->buckets, all->n, all->n + n_new, &all->room, sizeof *all->buckets);
  if (status != CONIC_OK)
    return status;
  if (n_dropped)
    release_bucket(all->context, &all->buckets[at]);
  memmove(all->buckets + at + n_new, all->buckets + at + n_dropped, (all->n - at - n_dropped) * sizeof *all->buckets);
  for (size_t i = 0, k = at; i < N_SPLIT; i++)
    if (parts->cells[i].count > 0) {
      all->buckets[k++] = parts->cells[i];
      memset(&parts->cells[i], 0, sizeof parts->cells[i]);
    }
  all->n += n_new - n_dropped;
  return CONIC_OK;
}

static void abandon_split(conic_context *context, split *parts) {
  for (size_t i = 0; i < N_SPLIT; i++)
    release_bucket(context, &parts->cells[i]);
  conic_memory_release(context, parts);
}

/* From world units to steps of the grid. */
typedef struct gridding {
  double origin[3], quantum, last;
} gridding;

/* The sample's key, and, where it is bare, where in its steps it is. */
static void place_sample(const gridding *grid, const conic_layers_block *block, const conic_layers_raw *raw,
                         conic_layers_sample *sample) {
  uint32_t steps[3];
  sample->bare = raw->is_bare ? 64 : 0;
  for (int axis = 0; axis < 3; axis++) {
    double place = ((block->origin[axis] - grid->origin[axis]) + (double)raw->position[axis]) / grid->quantum;
    double step = floor(place);
    steps[axis] = (uint32_t)(step > 0.0 ? step < grid->last ? step : grid->last : 0.0);
    int quarter = (int)(4.0 * (place - step));
    if (raw->is_bare)
      sample->bare = (uint8_t)(sample->bare | (quarter < 3 ? quarter : 3) << 2 * axis);
  }
  sample->key = conic_layers_key(steps[0], steps[1], steps[2]);
}

static conic_status fill_first(const conic_layers_intake *intake, const gridding *grid, conic_layers_raw *raws,
                               split *parts, conic_layers_buckets *all) {
  uint64_t offset = 0, n_done = 0;
  conic_layers_block block;
  int is_there = 1;
  conic_status status = conic_layers_intake_read(intake, &offset, &block, raws, &is_there);
  while (status == CONIC_OK && is_there) {
    for (size_t i = 0; i < block.count && status == CONIC_OK; i++) {
      const conic_layers_raw *raw = &raws[i];
      conic_layers_sample sample = {.normal = {raw->normal[0], raw->normal[1]},
                                    .size = raw->size,
                                    .color = {raw->color[0], raw->color[1], raw->color[2]}};
      place_sample(grid, &block, raw, &sample);
      status = add_to_split(all, parts, &sample);
    }
    n_done += block.count;
    if (status == CONIC_OK)
      status = conic_progress(intake->context, "sort", (double)n_done / (double)intake->n_samples);
    if (status == CONIC_OK)
      status = conic_layers_intake_read(intake, &offset, &block, raws, &is_there);
  }
  return status;
}

/* How many samples the bucket's block i holds. */
static size_t block_count(const conic_layers_buckets *all, const conic_layers_bucket *bucket, size_t i) {
  uint64_t left = bucket->count - (uint64_t)i * all->block_samples;
  return left < all->block_samples ? (size_t)left : all->block_samples;
}

static conic_status refine(conic_layers_buckets *all, size_t at, conic_layers_sample *samples, split *parts) {
  const conic_layers_bucket bucket = all->buckets[at];
  conic_status status = CONIC_OK;
  begin_split(bucket.key, bucket.n_bits, parts);
  for (size_t i = 0; i < bucket.n_blocks && status == CONIC_OK; i++) {
    size_t n = block_count(all, &bucket, i);
    status = conic_spool_read(&all->spool, bucket.blocks[i], samples, n * sizeof *samples);
    for (size_t k = 0; k < n && status == CONIC_OK; k++)
      status = add_to_split(all, parts, &samples[k]);
  }
  return status == CONIC_OK ? end_split(all, parts, at) : status;
}

static conic_status refine_all(conic_layers_buckets *all, uint64_t most, split *parts) {
  conic_status status = CONIC_OK;
  conic_layers_sample *samples = conic_memory_allocate(all->context, all->block_samples, sizeof *samples);
  if (!samples)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < all->n && status == CONIC_OK;)
    if (all->buckets[i].count > most && all->buckets[i].n_bits > 0)
      status = refine(all, i, samples, parts);
    else
      i++;
  conic_memory_release(all->context, samples);
  return status;
}

conic_status conic_layers_buckets_fill(const conic_layers_intake *intake, const conic_layers_plan *plan,
                                       const double origin[3], size_t memory_bytes, uint64_t most,
                                       conic_layers_buckets *buckets) {
  conic_context *context = intake->context;
  gridding grid = {.quantum = plan->quantum, .last = (double)((UINT64_C(1) << plan->bits) - 1)};
  memcpy(grid.origin, origin, sizeof grid.origin);
  memset(buckets, 0, sizeof *buckets);
  buckets->context = context;
  size_t block = memory_bytes / 8 / N_SPLIT / sizeof(conic_layers_sample); /* open blocks take an eighth */
  buckets->block_samples = block < 64 ? 64 : block > 1024 ? 1024 : block;
  conic_spool_begin(context, intake->spool.path, memory_bytes - memory_bytes / 8, &buckets->spool);
  split *parts = conic_memory_allocate(context, 1, sizeof *parts);
  if (!parts)
    return CONIC_ERROR_MEMORY;
  begin_split(0, 3 * plan->bits, parts);
  conic_layers_raw *raws = conic_memory_allocate(context, CONIC_LAYERS_BLOCK, sizeof *raws);
  conic_status status = raws ? fill_first(intake, &grid, raws, parts, buckets) : CONIC_ERROR_MEMORY;
  conic_memory_release(context, raws);
  if (status == CONIC_OK)
    status = end_split(buckets, parts, 0);
  if (status == CONIC_OK)
    status = refine_all(buckets, most, parts);
  abandon_split(context, parts);
  return status;
}

enum { DIGIT_BITS = 11, N_DIGITS = 1 << DIGIT_BITS };

/* Stable, by so many bits of the key from `shift` on. */
static void sort_by_digit(const conic_layers_sample *from, size_t n, unsigned shift, conic_layers_sample *to) {
  size_t starts[N_DIGITS + 1] = {0};
  for (size_t i = 0; i < n; i++)
    starts[(from[i].key >> shift & (N_DIGITS - 1)) + 1]++;
  for (size_t i = 1; i < N_DIGITS; i++)
    starts[i] += starts[i - 1];
  for (size_t i = 0; i < n; i++)
    to[starts[from[i].key >> shift & (N_DIGITS - 1)]++] = from[i];
}

static void sort(conic_layers_sample *samples, size_t n, conic_layers_sample *scratch) {
  uint64_t differing = 0;
  conic_layers_sample *from = samples, *to = scratch;
  for (size_t i = 1; i < n; i++)
    differing |= samples[i].key ^ samples[0].key;
  for (unsigned shift = 0; shift < 64 && differing >> shift; shift += DIGIT_BITS) {
    sort_by_digit(from, n, shift, to);
    conic_layers_sample *held = from;
    from = to;
    to = held;
  }
  if (from != samples)
    memcpy(samples, from, n * sizeof *samples);
}

conic_status conic_layers_buckets_load(const conic_layers_buckets *buckets, size_t first, size_t end,
                                       conic_layers_sample *samples, conic_layers_sample *scratch) {
  size_t n = 0;
  for (size_t i = first; i < end; i++) {
    const conic_layers_bucket *bucket = &buckets->buckets[i];
    for (size_t k = 0; k < bucket->n_blocks; k++) {
      size_t count = block_count(buckets, bucket, k);
      conic_status status = conic_spool_read(&buckets->spool, bucket->blocks[k], samples + n, count * sizeof *samples);
      if (status != CONIC_OK)
        return status;
      n += count;
    }
  }
  sort(samples, n, scratch);
  return CONIC_OK;
}
