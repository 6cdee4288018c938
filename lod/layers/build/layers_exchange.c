#include "lod/layers/build/layers_exchange.h"

#include <string.h>

#include "core/base/memory.h"

enum { LEAST_PARCEL = 64, MOST_PARCEL = 1 << 16 };

/* What waits to be sent: a parcel for each process. */
typedef struct exchanging {
  const conic_layers_shares *shares;
  conic_layers_arrivals *arrivals;
  size_t room; /* samples of a parcel */
  unsigned char *parcels;
  size_t *n_in;
  int is_over; /* nobody has more, or somebody failed, of which all know */
} exchanging;

void conic_layers_arrivals_end(conic_layers_arrivals *arrivals) {
  if (!arrivals->context)
    return;
  conic_spool_end(&arrivals->spool);
  conic_memory_release(arrivals->context, arrivals->list);
  memset(arrivals, 0, sizeof *arrivals);
}

static conic_status put_parcel_aside(conic_layers_arrivals *a, int from, const void *samples, size_t n) {
  if (n == 0)
    return CONIC_OK;
  conic_status status = conic_memory_reserve(a->context, &a->list, a->n, a->n + 1, &a->room, sizeof *a->list);
  if (status != CONIC_OK)
    return status;
  a->list[a->n++] = (conic_layers_arrival){from, conic_spool_bytes(&a->spool), n};
  a->n_samples += n;
  return conic_spool_append(&a->spool, samples, n * a->sample_bytes);
}

static unsigned char *parcel_for(const exchanging *e, int rank) {
  return e->parcels + (size_t)rank * e->room * e->arrivals->sample_bytes;
}

/* Everybody tells everybody how it stands; then all have failed, if one has. Whether parcels go round once more. */
static int tell_state(exchanging *e, conic_status *status, int is_last) {
  enum { HAS_MORE, HAS_NO_MORE, HAS_FAILED };
  const conic_team *team = e->shares->team;
  size_t sizes[CONIC_MOST_IN_TEAM];
  int own = *status != CONIC_OK ? HAS_FAILED : is_last ? HAS_NO_MORE : HAS_MORE, has_failed = 0;
  char *all = team->collect(team->data, &own, sizeof own, sizes);
  e->is_over = 1;
  for (int i = 0; i < team->count; i++) {
    int state;
    memcpy(&state, all + (size_t)i * sizeof state, sizeof state);
    has_failed |= state == HAS_FAILED;
    e->is_over &= state != HAS_MORE;
  }
  team->release(team->data, all);
  e->is_over |= has_failed;
  if (has_failed && *status == CONIC_OK)
    *status = CONIC_ERROR_CANCELLED;
  return !has_failed;
}

/* Everybody meets everybody, who gets what waits for it. Whoever fails now goes on, so that nobody waits in vain. */
static conic_status swap_parcels(exchanging *e, conic_status status, int is_last) {
  const conic_team *team = e->shares->team;
  conic_layers_arrivals *arrivals = e->arrivals;
  if (!tell_state(e, &status, is_last))
    return status;
  for (int round = 0; round < team->count; round++) {
    int partner = conic_team_partner(team, round);
    const unsigned char *parcel = parcel_for(e, partner);
    size_t n_bytes = e->n_in[partner] * arrivals->sample_bytes, n_received = n_bytes;
    e->n_in[partner] = 0;
    void *received = partner == team->index ? NULL : conic_team_swap(team, partner, parcel, n_bytes, &n_received);
    if (status == CONIC_OK)
      status = put_parcel_aside(arrivals, partner, received ? received : parcel, n_received / arrivals->sample_bytes);
    arrivals->sent_bytes += received ? n_bytes : 0;
    if (received)
      team->release(team->data, received);
  }
  return status;
}

static conic_status send_sample(void *to, const conic_layers_sample *sample) {
  exchanging *e = to;
  int owner = conic_layers_shares_owner(e->shares, sample->key);
  size_t n_bytes = e->arrivals->sample_bytes;
  memcpy(parcel_for(e, owner) + e->n_in[owner] * n_bytes, sample, n_bytes);
  if (++e->n_in[owner] < e->room)
    return CONIC_OK;
  if (owner != e->shares->team->index)
    return swap_parcels(e, CONIC_OK, 0);
  e->n_in[owner] = 0;
  return put_parcel_aside(e->arrivals, owner, parcel_for(e, owner), e->room);
}

conic_status conic_layers_exchange(const conic_layers_shares *shares, const conic_layers_placing *placing,
                                   const char *path, size_t memory_bytes, conic_layers_arrivals *arrivals) {
  size_t n_ranks = (size_t)shares->team->count, parcels_bytes = memory_bytes / 4;
  *arrivals = (conic_layers_arrivals){.context = shares->context, .sample_bytes = placing->sample_bytes};
  conic_spool_begin(shares->context, path, memory_bytes - parcels_bytes, &arrivals->spool);
  exchanging e = {.shares = shares, .arrivals = arrivals};
  e.room = parcels_bytes / (n_ranks * placing->sample_bytes);
  e.room = e.room < LEAST_PARCEL ? LEAST_PARCEL : e.room > MOST_PARCEL ? MOST_PARCEL : e.room;
  e.parcels = conic_memory_allocate(shares->context, n_ranks * e.room, placing->sample_bytes);
  e.n_in = conic_memory_allocate_zeroed(shares->context, n_ranks, sizeof *e.n_in);
  conic_status status = conic_team_agree(shares->team, e.parcels && e.n_in ? CONIC_OK : CONIC_ERROR_MEMORY);
  e.is_over = status != CONIC_OK;
  if (status == CONIC_OK)
    status = conic_layers_place_all(placing, send_sample, &e);
  while (!e.is_over)
    status = swap_parcels(&e, status, 1);
  conic_memory_release(shares->context, e.parcels);
  conic_memory_release(shares->context, e.n_in);
  return conic_team_agree(shares->team, status);
}

static conic_status take_arrival(const conic_layers_arrivals *a, const conic_layers_arrival *arrival,
                                 unsigned char *parcel, conic_layers_take *take, void *to) {
  conic_status status = conic_spool_read(&a->spool, arrival->at, parcel, arrival->n * a->sample_bytes);
  for (size_t i = 0; i < arrival->n && status == CONIC_OK; i++)
    status = take(to, conic_layers_sample_at(parcel, a->sample_bytes, i));
  return status;
}

conic_status conic_layers_arrivals_run(const void *arrivals, conic_layers_take *take, void *to) {
  const conic_layers_arrivals *a = arrivals;
  conic_status status = CONIC_OK;
  size_t most = 0;
  int n_ranks = 0;
  for (size_t i = 0; i < a->n; i++) {
    most = a->list[i].n > most ? a->list[i].n : most;
    n_ranks = a->list[i].from >= n_ranks ? a->list[i].from + 1 : n_ranks;
  }
  unsigned char *parcel = conic_memory_allocate(a->context, most, a->sample_bytes);
  if (!parcel)
    return CONIC_ERROR_MEMORY;
  for (int from = 0; from < n_ranks && status == CONIC_OK; from++)
    for (size_t i = 0; i < a->n && status == CONIC_OK; i++)
      if (a->list[i].from == from)
        status = take_arrival(a, &a->list[i], parcel, take, to);
  conic_memory_release(a->context, parcel);
  return status;
}
