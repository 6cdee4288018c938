#include "lod/layers/build/layers_shares.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"

/* So many places a process, about, and so many cells a place: the more of the former, the more even are the shares, and
 * the more branches are joined one after the other. */
enum { PARTS_A_RANK = 16, CELLS_A_PART = 4 };

/* Reading a kept branch takes so much less time than growing it, about. */
enum { SAMPLES_AS_ONE_KEPT = 64 };

/* Cells in a row whose samples go to one process. */
typedef struct shared_part {
  uint64_t key;
  int rank;
} shared_part;

typedef struct sharing {
  conic_layers_shares *shares;
  const conic_layers_plan *plan;
  size_t cell_room;
  uint64_t *counts; /* of the cells' samples, in all processes */
  uint64_t most_in_part, n_samples;
  size_t n_parts, part_room;
  shared_part *parts;
} sharing;

void conic_layers_shares_end(conic_layers_shares *shares) {
  if (!shares->context)
    return;
  conic_memory_release(shares->context, shares->cells);
  conic_memory_release(shares->context, shares->owners);
  conic_memory_release(shares->context, shares->limbs);
  conic_memory_release(shares->context, shares->own_keys);
  memset(shares, 0, sizeof *shares);
}

static size_t cell_of_key(const conic_layers_shares *shares, uint64_t key) {
  size_t low = 0, high = shares->n_cells; /* the last that begins no later than the key */
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (shares->cells[middle] <= key)
      low = middle;
    else
      high = middle;
  }
  return low;
}

int conic_layers_shares_owner(const conic_layers_shares *shares, uint64_t key) {
  return shares->owners[cell_of_key(shares, key)];
}

/* Halves a place until no half holds more than `most` of some keys, ascending. */
static conic_status list_cells(sharing *s, uint64_t first, unsigned n_bits, const uint64_t *keys, size_t n,
                               size_t most) {
  conic_layers_shares *shares = s->shares;
  if (n <= most || n_bits == 0) {
    conic_status status = conic_memory_reserve(shares->context, &shares->cells, shares->n_cells, shares->n_cells + 1,
                                               &s->cell_room, sizeof *shares->cells);
    if (status == CONIC_OK)
      shares->cells[shares->n_cells++] = first;
    return status;
  }
  uint64_t middle = first + (UINT64_C(1) << (n_bits - 1));
  size_t n_first = 0;
  while (n_first < n && keys[n_first] < middle)
    n_first++;
  conic_status status = list_cells(s, first, n_bits - 1, keys, n_first, most);
  return status == CONIC_OK ? list_cells(s, middle, n_bits - 1, keys + n_first, n - n_first, most) : status;
}

static int compare_share_keys(const void *a, const void *b) {
  uint64_t first = *(const uint64_t *)a, second = *(const uint64_t *)b;
  return (first > second) - (first < second);
}

/* From the few samples that all know. */
static conic_status find_cells(sharing *s, const conic_layers_placing *placing, int n_ranks) {
  const conic_layers_intake *intake = placing->intake;
  size_t n = intake->n_some, most = n / ((size_t)n_ranks * PARTS_A_RANK * CELLS_A_PART);
  uint64_t *keys = conic_memory_allocate(s->shares->context, n, sizeof *keys);
  if (!keys)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    keys[i] = conic_layers_key_about(placing, intake->some[i]);
  qsort(keys, n, sizeof *keys, compare_share_keys);
  conic_status status = list_cells(s, 0, 3 * s->plan->bits, keys, n, most > 1 ? most : 1);
  conic_memory_release(s->shares->context, keys);
  return status;
}

static conic_status count_sample(void *to, const conic_layers_sample *sample) {
  sharing *s = to;
  s->counts[cell_of_key(s->shares, sample->key)]++;
  return CONIC_OK;
}

/* A kept branch has only to be read. It counts in one cell, so that it is not parted, however many its place has. */
static void count_kept_branches(sharing *s, const conic_layers_kept *kept) {
  for (size_t i = 0; i < kept->n && s->shares->team->index == 0; i++)
    s->counts[cell_of_key(s->shares, kept->branches[i].key)] += 1 + kept->branches[i].n_samples / SAMPLES_AS_ONE_KEPT;
}

/* Of every cell, how many samples all have of it. Cells that hold none are left out. */
static conic_status count_share_cells(sharing *s, const conic_layers_placing *placing) {
  conic_layers_shares *shares = s->shares;
  const conic_team *team = shares->team;
  size_t n = shares->n_cells, n_kept = 0;
  uint64_t *all = conic_memory_allocate(shares->context, n, (size_t)team->count * sizeof *all);
  s->counts = conic_memory_allocate_zeroed(shares->context, n, sizeof *s->counts);
  conic_status status = all && s->counts ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    count_kept_branches(s, placing->kept);
    status = conic_layers_place_all(placing, count_sample, s);
  }
  status = conic_team_agree(team, status);
  if (status == CONIC_OK)
    conic_team_collect(team, s->counts, n * sizeof *s->counts, all);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    uint64_t count = 0;
    for (int k = 0; k < team->count; k++)
      count += all[(size_t)k * n + i];
    s->counts[n_kept] = count;
    shares->cells[n_kept] = shares->cells[i];
    n_kept += count > 0;
    s->n_samples += count;
  }
  shares->n_cells = n_kept;
  conic_memory_release(shares->context, all);
  return status;
}

/* The first of some keys in a row, which lie so many bytes apart, that is past the middle of the place they share. */
static size_t split_share_keys(const void *keys, size_t stride, size_t first, size_t end) {
  const char *bytes = keys;
  uint64_t low, high, at;
  memcpy(&low, bytes + first * stride, sizeof low);
  memcpy(&high, bytes + (end - 1) * stride, sizeof high);
  uint64_t bit = UINT64_C(1) << (63 - __builtin_clzll(low ^ high));
  size_t i = first;
  do
    memcpy(&at, bytes + ++i * stride, sizeof at);
  while (!(at & bit));
  return i;
}

static conic_status list_shared_parts(sharing *s, size_t first, size_t end, uint64_t *n_before) {
  const conic_layers_shares *shares = s->shares;
  uint64_t n = 0;
  for (size_t i = first; i < end; i++)
    n += s->counts[i];
  if (n > s->most_in_part && end - first > 1) {
    size_t middle = split_share_keys(shares->cells, sizeof *shares->cells, first, end);
    conic_status status = list_shared_parts(s, first, middle, n_before);
    return status == CONIC_OK ? list_shared_parts(s, middle, end, n_before) : status;
  }
  conic_status status =
      conic_memory_reserve(shares->context, &s->parts, s->n_parts, s->n_parts + 1, &s->part_room, sizeof *s->parts);
  if (status != CONIC_OK)
    return status;
  int n_ranks = shares->team->count;
  int rank = (int)((double)*n_before * (double)n_ranks / (double)s->n_samples);
  s->parts[s->n_parts++] = (shared_part){.key = shares->cells[first], .rank = rank < n_ranks ? rank : n_ranks - 1};
  for (size_t i = first; i < end; i++)
    shares->owners[i] = s->parts[s->n_parts - 1].rank;
  *n_before += n;
  return CONIC_OK;
}

static conic_status list_limbs(sharing *s, size_t first, size_t end) {
  conic_layers_shares *shares = s->shares;
  if (s->parts[first].rank != s->parts[end - 1].rank) {
    size_t middle = split_share_keys(s->parts, sizeof *s->parts, first, end);
    conic_status status = list_limbs(s, first, middle);
    if (status == CONIC_OK)
      status = list_limbs(s, middle, end);
    if (status == CONIC_OK)
      shares->limbs[shares->n_limbs - 1].n_joins++;
    return status;
  }
  conic_status status = conic_memory_reserve(shares->context, &shares->limbs, shares->n_limbs, shares->n_limbs + 1,
                                             &shares->limb_room, sizeof *shares->limbs);
  if (status == CONIC_OK)
    shares->limbs[shares->n_limbs++] = (conic_layers_limb){.key = s->parts[first].key, .rank = s->parts[first].rank};
  return status;
}

static conic_status list_own_keys(conic_layers_shares *shares) {
  shares->own_keys = conic_memory_allocate(shares->context, shares->n_limbs, sizeof *shares->own_keys);
  if (!shares->own_keys)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < shares->n_limbs; i++)
    if (!shares->team || shares->limbs[i].rank == shares->team->index)
      shares->own_keys[shares->n_own++] = shares->limbs[i].key;
  return CONIC_OK;
}

static conic_status share_cells_out(sharing *s, const conic_layers_placing *placing, uint64_t least) {
  conic_layers_shares *shares = s->shares;
  uint64_t n_before = 0;
  int n_ranks = shares->team->count;
  conic_status status = find_cells(s, placing, n_ranks);
  status = conic_team_agree(shares->team, status);
  if (status == CONIC_OK)
    status = count_share_cells(s, placing);
  if (status != CONIC_OK)
    return status;
  s->most_in_part = s->n_samples / ((uint64_t)n_ranks * PARTS_A_RANK);
  s->most_in_part = s->most_in_part > least ? s->most_in_part : least;
  shares->owners = conic_memory_allocate(shares->context, shares->n_cells, sizeof *shares->owners);
  status = shares->owners ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = list_shared_parts(s, 0, shares->n_cells, &n_before);
  return status == CONIC_OK ? list_limbs(s, 0, s->n_parts) : status;
}

conic_status conic_layers_shares_find(const conic_team *team, const conic_layers_placing *placing,
                                      const conic_layers_plan *plan, uint64_t least, conic_layers_shares *shares) {
  sharing s = {.shares = shares, .plan = plan};
  *shares = (conic_layers_shares){.context = plan->context, .team = team};
  conic_status status = CONIC_OK;
  if (team)
    status = share_cells_out(&s, placing, least);
  else {
    shares->limbs = conic_memory_allocate_zeroed(plan->context, 1, sizeof *shares->limbs);
    shares->n_limbs = 1;
    status = shares->limbs ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK)
    status = list_own_keys(shares);
  conic_memory_release(plan->context, s.counts);
  conic_memory_release(plan->context, s.parts);
  return conic_team_agree(team, status);
}
