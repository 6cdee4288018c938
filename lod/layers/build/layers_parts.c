#include "lod/layers/build/layers_parts.h"

/* There are about so many pieces for each process, and so many cells in a piece. The more pieces, the more even are the
 * parts, and the more of them are merged one after the other. */
enum { PIECES_A_PROCESS = 16, CELLS_A_PIECE = 4 };

/* About so many samples of a kept branch are read in the time that one takes to grow. */
enum { SAMPLES_AS_ONE_KEPT = 64 };

/* Cells in a row whose samples go to one process. */
typedef struct piece {
  uint64_t key;
  int owner;
} piece;

typedef struct dividing {
  conic_layers_parts *parts;
  const conic_layers_plan *plan;
  size_t cell_room;
  uint64_t *counts; /* of the cells' samples, in all processes */
  uint64_t most_in_piece, n_samples;
  size_t n_pieces, piece_room;
  piece *pieces;
} dividing;

void conic_layers_parts_end(conic_layers_parts *parts) {
  if (!parts->context)
    return;
  conic_memory_release_these(parts->context, parts->cells, parts->owners, parts->list, parts->own_keys);
  memset(parts, 0, sizeof *parts);
}

/* The last cell that begins no later than the key. */
static size_t cell_holding(const conic_layers_parts *parts, uint64_t key) {
  size_t n = conic_layers_count_to(parts->cells, sizeof *parts->cells, parts->n_cells, key);
  return n ? n - 1 : 0;
}

int conic_layers_parts_owner(const conic_layers_parts *parts, uint64_t key) {
  return parts->owners[cell_holding(parts, key)];
}

/* Halves a place until no half holds more than `most` of some keys, ascending. */
static conic_status list_cells(dividing *s, uint64_t first, unsigned n_bits, const uint64_t *keys, size_t n,
                               size_t most) {
  conic_layers_parts *parts = s->parts;
  if (n <= most || n_bits == 0)
    return conic_memory_append(parts->context, &parts->cells, &parts->n_cells, &s->cell_room, &first, sizeof first);
  uint64_t middle = first + (UINT64_C(1) << (n_bits - 1));
  size_t n_first = 0;
  while (n_first < n && keys[n_first] < middle)
    n_first++;
  conic_status status = list_cells(s, first, n_bits - 1, keys, n_first, most);
  return status == CONIC_OK ? list_cells(s, middle, n_bits - 1, keys + n_first, n - n_first, most) : status;
}

/* Finds the cells from the few samples that all know. */
static conic_status find_cells(dividing *s, const conic_layers_grid *grid, int n_processes) {
  const conic_layers_raws *raws = grid->raws;
  size_t n = raws->n_some, most = n / ((size_t)n_processes * PIECES_A_PROCESS * CELLS_A_PIECE);
  uint64_t *keys = conic_memory_allocate(s->parts->context, n, sizeof *keys);
  if (!keys)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    keys[i] = conic_layers_grid_key(grid, raws->some[i]);
  qsort(keys, n, sizeof *keys, conic_layers_compare_keys);
  conic_status status = list_cells(s, 0, 3 * s->plan->bits, keys, n, most > 1 ? most : 1);
  conic_memory_release(s->parts->context, keys);
  return status;
}

static conic_status count_sample(void *to, const conic_layers_sample *sample) {
  dividing *s = to;
  s->counts[cell_holding(s->parts, sample->key)]++;
  return CONIC_OK;
}

/* A kept branch has only to be read. It counts in one cell, so that it is not split, however many samples it has. */
static void count_kept_branches(dividing *s, const conic_layers_kept *kept) {
  for (size_t i = 0; i < kept->n && s->parts->team->index == 0; i++)
    s->counts[cell_holding(s->parts, kept->branches[i].key)] += 1 + kept->branches[i].n_samples / SAMPLES_AS_ONE_KEPT;
}

/* Counts the samples of all processes in every cell. Cells that hold none are left out. */
static conic_status count_in_cells(dividing *s, const conic_layers_grid *grid) {
  conic_layers_parts *parts = s->parts;
  const conic_team *team = parts->team;
  size_t n = parts->n_cells, n_kept = 0;
  uint64_t *all = conic_memory_allocate(parts->context, n, (size_t)team->count * sizeof *all);
  s->counts = conic_memory_allocate_zeroed(parts->context, n, sizeof *s->counts);
  conic_status status = all && s->counts ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    count_kept_branches(s, grid->kept);
    status = conic_layers_grid_run(grid, count_sample, s);
  }
  status = conic_team_agree(team, status);
  if (status == CONIC_OK)
    conic_team_collect(team, s->counts, n * sizeof *s->counts, all);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    uint64_t count = 0;
    for (int k = 0; k < team->count; k++)
      count += all[(size_t)k * n + i];
    s->counts[n_kept] = count;
    parts->cells[n_kept] = parts->cells[i];
    n_kept += count > 0;
    s->n_samples += count;
  }
  parts->n_cells = n_kept;
  conic_memory_release(parts->context, all);
  return status;
}

static conic_status list_part_pieces(dividing *s, size_t first, size_t end, uint64_t *n_before) {
  const conic_layers_parts *parts = s->parts;
  uint64_t n = 0;
  for (size_t i = first; i < end; i++)
    n += s->counts[i];
  if (n > s->most_in_piece && end - first > 1) {
    size_t middle = conic_layers_middle(parts->cells, sizeof *parts->cells, first, end);
    conic_status status = list_part_pieces(s, first, middle, n_before);
    return status == CONIC_OK ? list_part_pieces(s, middle, end, n_before) : status;
  }
  int n_processes = parts->team->count;
  int owner = (int)((double)*n_before * (double)n_processes / (double)s->n_samples);
  const piece made = {.key = parts->cells[first], .owner = owner < n_processes ? owner : n_processes - 1};
  for (size_t i = first; i < end; i++)
    parts->owners[i] = made.owner;
  *n_before += n;
  return conic_memory_append(parts->context, &s->pieces, &s->n_pieces, &s->piece_room, &made, sizeof made);
}

static conic_status list_parts(dividing *s, size_t first, size_t end) {
  conic_layers_parts *parts = s->parts;
  if (s->pieces[first].owner != s->pieces[end - 1].owner) {
    size_t middle = conic_layers_middle(s->pieces, sizeof *s->pieces, first, end);
    conic_status status = list_parts(s, first, middle);
    if (status == CONIC_OK)
      status = list_parts(s, middle, end);
    if (status == CONIC_OK)
      parts->list[parts->n - 1].n_merges++;
    return status;
  }
  const conic_layers_part part = {.key = s->pieces[first].key, .owner = s->pieces[first].owner};
  return conic_memory_append(parts->context, &parts->list, &parts->n, &parts->room, &part, sizeof part);
}

static conic_status list_own_keys(conic_layers_parts *parts) {
  parts->own_keys = conic_memory_allocate(parts->context, parts->n, sizeof *parts->own_keys);
  if (!parts->own_keys)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < parts->n; i++)
    if (!parts->team || parts->list[i].owner == parts->team->index)
      parts->own_keys[parts->n_own++] = parts->list[i].key;
  return CONIC_OK;
}

static conic_status divide_samples(dividing *s, const conic_layers_grid *grid, uint64_t least) {
  conic_layers_parts *parts = s->parts;
  uint64_t n_before = 0;
  int n_processes = parts->team->count;
  conic_status status = find_cells(s, grid, n_processes);
  status = conic_team_agree(parts->team, status);
  if (status == CONIC_OK)
    status = count_in_cells(s, grid);
  if (status != CONIC_OK)
    return status;
  s->most_in_piece = s->n_samples / ((uint64_t)n_processes * PIECES_A_PROCESS);
  s->most_in_piece = s->most_in_piece > least ? s->most_in_piece : least;
  parts->owners = conic_memory_allocate(parts->context, parts->n_cells, sizeof *parts->owners);
  status = parts->owners ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = list_part_pieces(s, 0, parts->n_cells, &n_before);
  return status == CONIC_OK ? list_parts(s, 0, s->n_pieces) : status;
}

conic_status conic_layers_parts_find(const conic_team *team, const conic_layers_grid *grid,
                                     const conic_layers_plan *plan, uint64_t least, conic_layers_parts *parts) {
  dividing s = {.parts = parts, .plan = plan};
  *parts = (conic_layers_parts){.context = plan->context, .team = team};
  conic_status status = CONIC_OK;
  if (team)
    status = divide_samples(&s, grid, least);
  else {
    parts->list = conic_memory_allocate_zeroed(plan->context, 1, sizeof *parts->list);
    parts->n = 1;
    status = parts->list ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  if (status == CONIC_OK)
    status = list_own_keys(parts);
  conic_memory_release_these(plan->context, s.counts, s.pieces);
  return conic_team_agree(team, status);
}

/* --- sending samples to the owners of their parts --- */

enum { LEAST_MESSAGE = 64, MOST_MESSAGE = 1 << 16 };

/* The messages to all processes that are being filled. */
typedef struct sending {
  const conic_layers_parts *parts;
  conic_layers_received *received;
  size_t room; /* samples of a message */
  unsigned char *messages;
  size_t *n_in;
  int is_over; /* all know that no process has more, or that one has failed */
} sending;

void conic_layers_received_end(conic_layers_received *received) {
  if (!received->context)
    return;
  conic_spool_end(&received->spool);
  conic_memory_release(received->context, received->list);
  memset(received, 0, sizeof *received);
}

static conic_status keep_received(conic_layers_received *a, int from, const void *samples, size_t n) {
  if (n == 0)
    return CONIC_OK;
  const conic_layers_message message = {from, conic_spool_bytes(&a->spool), n};
  conic_status status = conic_memory_append(a->context, &a->list, &a->n, &a->room, &message, sizeof message);
  a->n_samples += n;
  return status == CONIC_OK ? conic_spool_append(&a->spool, samples, n * a->sample_bytes) : status;
}

static unsigned char *message_for(const sending *e, int to) {
  return e->messages + (size_t)to * e->room * e->received->sample_bytes;
}

/* Every process tells all others how it stands. Where one has failed, all have. Returns whether messages go round once
 * more. */
static int tell_state(sending *e, conic_status *status, int is_last) {
  enum { HAS_MORE, HAS_NO_MORE, HAS_FAILED };
  const conic_team *team = e->parts->team;
  int own = *status != CONIC_OK ? HAS_FAILED : is_last ? HAS_NO_MORE : HAS_MORE, has_failed = 0;
  int states[CONIC_MOST_IN_TEAM];
  conic_team_collect(team, &own, sizeof own, states);
  e->is_over = 1;
  for (int i = 0; i < team->count; i++) {
    has_failed |= states[i] == HAS_FAILED;
    e->is_over &= states[i] != HAS_MORE;
  }
  e->is_over |= has_failed;
  if (has_failed && *status == CONIC_OK)
    *status = CONIC_ERROR_CANCELLED;
  return !has_failed;
}

/* Swaps messages with every process. Who fails meanwhile goes on, so that no other waits in vain. */
static conic_status swap_messages(sending *e, conic_status status, int is_last) {
  const conic_team *team = e->parts->team;
  conic_layers_received *received = e->received;
  if (!tell_state(e, &status, is_last))
    return status;
  for (int round = 0; round < team->count; round++) {
    int partner = conic_team_partner(team, round);
    const unsigned char *message = message_for(e, partner);
    size_t n_bytes = e->n_in[partner] * received->sample_bytes, n_received = n_bytes;
    e->n_in[partner] = 0;
    void *swapped = partner == team->index ? NULL : conic_team_swap(team, partner, message, n_bytes, &n_received);
    if (status == CONIC_OK)
      status = keep_received(received, partner, swapped ? swapped : message, n_received / received->sample_bytes);
    received->sent_bytes += swapped ? n_bytes : 0;
    if (swapped)
      team->release(team->data, swapped);
  }
  return status;
}

static conic_status send_sample(void *to, const conic_layers_sample *sample) {
  sending *e = to;
  int owner = conic_layers_parts_owner(e->parts, sample->key);
  size_t n_bytes = e->received->sample_bytes;
  memcpy(message_for(e, owner) + e->n_in[owner] * n_bytes, sample, n_bytes);
  if (++e->n_in[owner] < e->room)
    return CONIC_OK;
  if (owner != e->parts->team->index)
    return swap_messages(e, CONIC_OK, 0);
  e->n_in[owner] = 0;
  return keep_received(e->received, owner, message_for(e, owner), e->room);
}

conic_status conic_layers_send_samples(const conic_layers_parts *parts, const conic_layers_grid *grid, const char *path,
                                       size_t memory_bytes, conic_layers_received *received) {
  size_t n_processes = (size_t)parts->team->count, message_bytes = memory_bytes / 4;
  *received = (conic_layers_received){.context = parts->context, .sample_bytes = grid->sample_bytes};
  conic_spool_begin(parts->context, path, memory_bytes - message_bytes, &received->spool);
  sending e = {.parts = parts, .received = received};
  e.room = message_bytes / (n_processes * grid->sample_bytes);
  e.room = e.room < LEAST_MESSAGE ? LEAST_MESSAGE : e.room > MOST_MESSAGE ? MOST_MESSAGE : e.room;
  e.messages = conic_memory_allocate(parts->context, n_processes * e.room, grid->sample_bytes);
  e.n_in = conic_memory_allocate_zeroed(parts->context, n_processes, sizeof *e.n_in);
  conic_status status = conic_team_agree(parts->team, e.messages && e.n_in ? CONIC_OK : CONIC_ERROR_MEMORY);
  e.is_over = status != CONIC_OK;
  if (status == CONIC_OK)
    status = conic_layers_grid_run(grid, send_sample, &e);
  while (!e.is_over)
    status = swap_messages(&e, status, 1);
  conic_memory_release_these(parts->context, e.messages, e.n_in);
  return conic_team_agree(parts->team, status);
}

conic_status conic_layers_received_run(const void *received, conic_layers_take *take, void *to) {
  const conic_layers_received *r = received;
  conic_status status = CONIC_OK;
  size_t most = 0;
  int n_processes = 0;
  for (size_t i = 0; i < r->n; i++) {
    most = r->list[i].n > most ? r->list[i].n : most;
    n_processes = r->list[i].from >= n_processes ? r->list[i].from + 1 : n_processes;
  }
  unsigned char *samples = conic_memory_allocate(r->context, most, r->sample_bytes);
  if (!samples)
    return CONIC_ERROR_MEMORY;
  for (int from = 0; from < n_processes; from++)
    for (size_t i = 0; i < r->n && status == CONIC_OK; i++) {
      if (r->list[i].from != from)
        continue;
      status = conic_spool_read(&r->spool, r->list[i].at, samples, r->list[i].n * r->sample_bytes);
      for (size_t k = 0; k < r->list[i].n && status == CONIC_OK; k++)
        status = take(to, conic_layers_sample_at(samples, r->sample_bytes, k));
    }
  conic_memory_release(r->context, samples);
  return status;
}
