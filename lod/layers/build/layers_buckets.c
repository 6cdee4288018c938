#include "lod/layers/build/layers_parts.h"

/* So many bits of the keys split the samples at a time, fewer where there is little memory for open blocks. */
enum { MOST_SPLIT_BITS = 12, LEAST_SPLIT_BITS = 4, LEAST_BLOCK = 32, MOST_BLOCK = 1024 };

#define NO_BLOCK UINT64_MAX

void conic_layers_buckets_end(conic_layers_buckets *buckets) {
  if (!buckets->context)
    return;
  conic_memory_release(buckets->context, buckets->buckets);
  conic_spool_end(&buckets->spool);
  memset(buckets, 0, sizeof *buckets);
}

/* A block begins with where the one before it is. */
static size_t block_bytes(const conic_layers_buckets *all, size_t n_samples) {
  return sizeof(uint64_t) + n_samples * all->sample_bytes;
}

/* The cells that a cell's samples are split into: each a bucket with a block that is being filled. */
typedef struct split {
  conic_layers_buckets *all;
  unsigned n_most_bits, n_bits;
  uint64_t key;
  unsigned shift;        /* bits of the key below the cells' own */
  uint64_t n_coincident; /* of so many that coincide; 0: they do not */
  uint8_t is_reversed;
  conic_layers_bucket *cells;
  unsigned char *open; /* blocks */
} split;

static conic_status create_split(conic_layers_buckets *all, size_t memory_bytes, split *s) {
  size_t n_samples = memory_bytes / all->sample_bytes, n_bits = MOST_SPLIT_BITS;
  while (n_bits > LEAST_SPLIT_BITS && n_samples >> n_bits < LEAST_BLOCK)
    n_bits--;
  size_t block = n_samples >> n_bits, n_cells = (size_t)1 << n_bits;
  all->block_samples = block < LEAST_BLOCK ? LEAST_BLOCK : block > MOST_BLOCK ? MOST_BLOCK : block;
  *s = (split){.all = all, .n_most_bits = (unsigned)n_bits};
  s->cells = conic_memory_allocate(all->context, n_cells, sizeof *s->cells);
  s->open = conic_memory_allocate(all->context, n_cells, block_bytes(all, all->block_samples));
  return s->cells && s->open ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static void release_split(split *s) {
  conic_memory_release_these(s->all->context, s->cells, s->open);
}

static void clear_cells(split *s) {
  for (size_t i = 0; i < (size_t)1 << s->n_bits; i++)
    s->cells[i] = (conic_layers_bucket){.key = s->key + ((uint64_t)i << s->shift),
                                        .last_block = NO_BLOCK,
                                        .n_bits = (uint8_t)s->shift,
                                        .is_reversed = s->is_reversed};
}

/* Begins to split all samples, or a bucket's, so that cells hold few more than `most`, or a fraction of it. */
static void begin_split(split *s, uint64_t key, unsigned n_key_bits, uint64_t count, uint64_t most) {
  unsigned n = s->n_most_bits;
  while (n > 1 && count >> (n - 3) < most && n > 3)
    n--;
  s->n_bits = n < n_key_bits ? n : n_key_bits;
  s->key = key;
  s->shift = n_key_bits - s->n_bits;
  s->n_coincident = 0;
  clear_cells(s);
}

/* Begins to split a bucket whose samples coincide: into halves of halves, as the tree does. */
static void begin_halving(split *s, const conic_layers_bucket *bucket, uint64_t most) {
  s->n_bits = 1;
  while (s->n_bits < s->n_most_bits && bucket->count >> s->n_bits > most)
    s->n_bits++;
  s->key = bucket->key;
  s->shift = 0;
  s->n_coincident = bucket->count;
  clear_cells(s);
  for (size_t i = 0; i < (size_t)1 << s->n_bits; i++)
    s->cells[i].key = bucket->key;
}

static size_t cell_of_number(const split *s, uint64_t number) {
  size_t cell = 0;
  uint64_t n = s->n_coincident;
  for (unsigned i = 0; i < s->n_bits; i++) {
    uint64_t half = n / 2;
    int is_second = number >= half;
    cell = 2 * cell + (size_t)is_second;
    number -= is_second ? half : 0;
    n = is_second ? n - half : half;
  }
  return cell;
}

static unsigned char *open_block(const split *s, size_t cell) {
  return s->open + cell * block_bytes(s->all, s->all->block_samples);
}

/* Puts the first samples of the open block away. */
static conic_status close_block(split *s, size_t i_cell, size_t n_samples) {
  conic_layers_bucket *cell = &s->cells[i_cell];
  unsigned char *block = open_block(s, i_cell);
  memcpy(block, &cell->last_block, sizeof cell->last_block);
  cell->last_block = conic_spool_bytes(&s->all->spool);
  return conic_spool_append(&s->all->spool, block, block_bytes(s->all, n_samples));
}

static conic_status add_to_cell(split *s, size_t i_cell, const conic_layers_sample *sample) {
  conic_layers_bucket *cell = &s->cells[i_cell];
  size_t n_open = (size_t)(cell->count++ % s->all->block_samples), n_bytes = s->all->sample_bytes;
  memcpy(open_block(s, i_cell) + sizeof(uint64_t) + n_open * n_bytes, sample, n_bytes);
  return n_open + 1 == s->all->block_samples ? close_block(s, i_cell, n_open + 1) : CONIC_OK;
}

static size_t cell_of_key(const split *s, uint64_t key) {
  return (size_t)((key - s->key) >> s->shift);
}

/* Puts what is left in open blocks away. The buckets that hold any take the place of number `at`, which is dropped, or
 * go to the end. */
static conic_status end_split(split *s, size_t at) {
  conic_layers_buckets *all = s->all;
  conic_status status = CONIC_OK;
  size_t n_cells = (size_t)1 << s->n_bits, n_new = 0, n_dropped = at < all->n;
  for (size_t i = 0; i < n_cells && status == CONIC_OK; i++) {
    size_t n_open = (size_t)(s->cells[i].count % all->block_samples);
    status = n_open ? close_block(s, i, n_open) : CONIC_OK;
    n_new += s->cells[i].count > 0;
  }
  if (status == CONIC_OK)
    status =
        conic_memory_reserve(all->context, &all->buckets, all->n, all->n + n_new, &all->room, sizeof *all->buckets);
  if (status != CONIC_OK)
    return status;
  if (all->n > at + n_dropped) /* there may be no room for none */
    memmove(all->buckets + at + n_new, all->buckets + at + n_dropped, (all->n - at - n_dropped) * sizeof *all->buckets);
  for (size_t i = 0, k = at; i < n_cells; i++)
    if (s->cells[i].count > 0)
      all->buckets[k++] = s->cells[i];
  all->n += n_new - n_dropped;
  return CONIC_OK;
}

static conic_status take_placed(void *to, const conic_layers_sample *sample) {
  split *s = to;
  return add_to_cell(s, cell_of_key(s, sample->key), sample);
}

typedef conic_status take_block(void *data, const unsigned char *samples, size_t n);

/* Hands over the bucket's blocks, the last one first; `block` has room for one. */
static conic_status read_chain(const conic_layers_buckets *all, const conic_layers_bucket *bucket, unsigned char *block,
                               take_block *take, void *data) {
  uint64_t at = bucket->last_block, left = bucket->count;
  conic_status status = CONIC_OK;
  while (left > 0 && status == CONIC_OK) {
    size_t n = (size_t)(left % all->block_samples);
    n = n ? n : all->block_samples;
    status = conic_spool_read(&all->spool, at, block, block_bytes(all, n));
    if (status == CONIC_OK)
      status = take(data, block + sizeof at, n);
    memcpy(&at, block, sizeof at);
    left -= n;
  }
  return status;
}

typedef struct refining {
  split *s;
  uint64_t n_done; /* samples, of those that coincide */
} refining;

/* Goes from the last on, so that each refining turns their order around. */
static conic_status refine_block(void *data, const unsigned char *samples, size_t n) {
  refining *r = data;
  split *s = r->s;
  conic_status status = CONIC_OK;
  for (size_t i = n; i > 0 && status == CONIC_OK; i--) {
    const conic_layers_sample *sample = conic_layers_sample_at(samples, s->all->sample_bytes, i - 1);
    uint64_t number = r->n_done++;
    size_t cell = s->n_coincident == 0 ? cell_of_key(s, sample->key)
                                       : cell_of_number(s, s->is_reversed ? s->n_coincident - 1 - number : number);
    status = add_to_cell(s, cell, sample);
  }
  return status;
}

static conic_status refine(split *s, size_t at, uint64_t most, unsigned char *block) {
  const conic_layers_bucket bucket = s->all->buckets[at];
  refining r = {.s = s};
  s->is_reversed = !bucket.is_reversed;
  if (bucket.n_bits)
    begin_split(s, bucket.key, bucket.n_bits, bucket.count, most);
  else
    begin_halving(s, &bucket, most);
  conic_status status = read_chain(s->all, &bucket, block, refine_block, &r);
  return status == CONIC_OK ? end_split(s, at) : status;
}

/* Whether a key at which a bucket has to end lies within it. */
static int has_border(const conic_layers_bucket *bucket, const conic_layers_borders *borders) {
  size_t low = conic_layers_count_to(borders->keys, sizeof *borders->keys, borders->n, bucket->key);
  return low < borders->n && borders->keys[low] - bucket->key < UINT64_C(1) << bucket->n_bits;
}

static conic_status refine_all(split *s, uint64_t most, const conic_layers_borders *borders) {
  conic_layers_buckets *all = s->all;
  conic_status status = CONIC_OK;
  unsigned char *block = conic_memory_allocate(all->context, block_bytes(all, all->block_samples), 1);
  if (!block)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < all->n && status == CONIC_OK;)
    if (all->buckets[i].count > most || has_border(&all->buckets[i], borders))
      status = refine(s, i, most, block);
    else
      i++;
  conic_memory_release(all->context, block);
  return status;
}

conic_status conic_layers_buckets_fill(conic_context *context, const char *path, const conic_layers_feed *feed,
                                       const conic_layers_plan *plan, const conic_layers_borders *borders,
                                       size_t memory_bytes, uint64_t most, conic_layers_buckets *buckets) {
  size_t open_bytes = memory_bytes / 4;
  split s;
  memset(buckets, 0, sizeof *buckets);
  buckets->context = context;
  buckets->sample_bytes = plan->sample_bytes;
  conic_spool_begin(context, path, memory_bytes - open_bytes, &buckets->spool);
  conic_status status = create_split(buckets, open_bytes, &s);
  if (status == CONIC_OK) {
    begin_split(&s, 0, 3 * plan->bits, feed->n_samples, most);
    status = feed->run(feed->from, take_placed, &s);
  }
  if (status == CONIC_OK)
    status = end_split(&s, 0);
  if (status == CONIC_OK)
    status = refine_all(&s, most, borders);
  release_split(&s);
  return status;
}

conic_status conic_layers_buckets_add(conic_layers_buckets *buckets, const conic_layers_kept_branch *const *kept,
                                      size_t n) {
  size_t left = buckets->n, at = left + n;
  conic_status status =
      conic_memory_reserve(buckets->context, &buckets->buckets, left, at, &buckets->room, sizeof *buckets->buckets);
  if (status != CONIC_OK)
    return status;
  buckets->n = at;
  while (n > 0) { /* from the end on, so that each goes where nothing is any more */
    const conic_layers_kept_branch *last = kept[n - 1];
    if (left > 0 && buckets->buckets[left - 1].key > last->key)
      buckets->buckets[--at] = buckets->buckets[--left];
    else {
      n--;
      buckets->buckets[--at] = (conic_layers_bucket){
          .key = last->key, .count = last->n_samples, .n_bits = (uint8_t)last->n_bits, .kept = last};
    }
  }
  return CONIC_OK;
}

enum { DIGIT_BITS = 11, N_DIGITS = 1 << DIGIT_BITS };

/* Stable, by so many bits of the key from `shift` on. */
static void sort_records_by_digit(const unsigned char *from, size_t stride, size_t n, unsigned shift,
                                  unsigned char *to) {
  size_t starts[N_DIGITS + 1] = {0};
  for (size_t i = 0; i < n; i++)
    starts[(conic_layers_sample_at(from, stride, i)->key >> shift & (N_DIGITS - 1)) + 1]++;
  for (size_t i = 1; i < N_DIGITS; i++)
    starts[i] += starts[i - 1];
  for (size_t i = 0; i < n; i++)
    memcpy(to + starts[conic_layers_sample_at(from, stride, i)->key >> shift & (N_DIGITS - 1)]++ * stride,
           from + i * stride, stride);
}

/* Returns which of the two arrays has them in order. */
static unsigned char *sort_records(unsigned char *samples, size_t stride, size_t n, unsigned char *scratch) {
  uint64_t differing = 0;
  unsigned char *from = samples, *to = scratch;
  for (size_t i = 1; i < n; i++)
    differing |= conic_layers_sample_at(samples, stride, i)->key ^ conic_layers_sample_at(samples, stride, 0)->key;
  for (unsigned shift = 0; shift < 64 && differing >> shift; shift += DIGIT_BITS) {
    sort_records_by_digit(from, stride, n, shift, to);
    unsigned char *held = from;
    from = to;
    to = held;
  }
  return from;
}

typedef struct bucket_copy {
  unsigned char *next; /* where the next goes, or before this */
  size_t stride;
  int is_reversed;
} bucket_copy;

static conic_status copy_block(void *data, const unsigned char *samples, size_t n) {
  bucket_copy *c = data;
  if (!c->is_reversed) {
    c->next -= n * c->stride;
    memcpy(c->next, samples, n * c->stride);
  }
  for (size_t i = n; c->is_reversed && i > 0; i--, c->next += c->stride)
    memcpy(c->next, samples + (i - 1) * c->stride, c->stride);
  return CONIC_OK;
}

conic_status conic_layers_buckets_load(const conic_layers_buckets *buckets, size_t first, size_t end,
                                       unsigned char *samples, unsigned char *scratch, unsigned char **sorted) {
  size_t n = 0, stride = buckets->sample_bytes;
  unsigned char *block = conic_memory_allocate(buckets->context, block_bytes(buckets, buckets->block_samples), 1);
  conic_status status = block ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = first; i < end && status == CONIC_OK; i++) {
    const conic_layers_bucket *bucket = &buckets->buckets[i];
    size_t n_after = n + (size_t)bucket->count;
    bucket_copy c = {samples + (bucket->is_reversed ? n : n_after) * stride, stride, bucket->is_reversed};
    status = read_chain(buckets, bucket, block, copy_block, &c);
    n = n_after;
  }
  conic_memory_release(buckets->context, block);
  *sorted = status == CONIC_OK ? sort_records(samples, stride, n, scratch) : NULL;
  return status;
}
