#include "source/splat_exchange.h"

#include "core/base/base.h"
#include "core/splats/columns.h"

/* Splats sent at a time. */
enum { PARCEL = 1 << 16, FIELDS = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES };

typedef struct splat_exchange {
  const conic_splats_shares *shares;
  const conic_splats *from;
  const size_t *begin;
  const uint32_t *list;
  size_t *received; /* where the splats from each process go; and the end */
  uint32_t *ids;
  float *own[CONIC_SPLATS_COLUMNS], *got[CONIC_SPLATS_COLUMNS];
  size_t n_columns;
  uint32_t *parcel;
} splat_exchange;

static size_t list_floats(const conic_splats *splats, float *floats[CONIC_SPLATS_COLUMNS]) {
  conic_splats set = *splats;
  conic_column columns[CONIC_SPLATS_COLUMNS];
  size_t n = 0;
  conic_splats_list_columns(&set, columns);
  for (size_t i = 0; i < CONIC_SPLATS_COLUMNS; i++)
    if (*columns[i].floats && (columns[i].field == 0 || columns[i].field & FIELDS))
      floats[n++] = *columns[i].floats;
  return n;
}

/* Every process tells every other how many splats it sends. */
static void swap_counts(splat_exchange *e) {
  const conic_team *team = e->shares->team;
  size_t *counts = e->received + 1;
  for (int round = 0; round < team->count; round++) {
    int partner = conic_team_partner(team, round);
    uint64_t mine = e->begin[partner + 1] - e->begin[partner], theirs = mine;
    size_t n_bytes;
    if (partner != team->index) {
      void *received = conic_team_swap(team, partner, &mine, sizeof mine, &n_bytes);
      memcpy(&theirs, received, sizeof theirs);
      team->release(team->data, received);
    }
    counts[partner] = (size_t)theirs;
  }
  e->received[0] = 0;
  for (int k = 0; k < team->count; k++)
    e->received[k + 1] += e->received[k];
}

static size_t parcel_of(size_t first, size_t end) {
  return first >= end ? 0 : end - first < PARCEL ? end - first : PARCEL;
}

/* Packs column by column, the places first. */
static void pack_splats(const splat_exchange *e, size_t first, size_t n, uint32_t *to) {
  const uint32_t *list = e->list + first;
  for (size_t i = 0; i < n; i++)
    to[i] = (uint32_t)(e->shares->first + list[i]);
  for (size_t k = 0; k < e->n_columns; k++) {
    const float *column = e->own[k];
    float *place = (float *)to + (k + 1) * n;
    for (size_t i = 0; i < n; i++)
      place[i] = column[list[i]];
  }
}

static void unpack_splats(const splat_exchange *e, size_t first, size_t n, const uint32_t *from) {
  memcpy(e->ids + first, from, n * sizeof *from);
  for (size_t k = 0; k < e->n_columns; k++)
    memcpy(e->got[k] + first, from + (k + 1) * n, n * sizeof(float));
}

static void meet_partner(const splat_exchange *e, int partner) {
  const conic_team *team = e->shares->team;
  size_t end = e->begin[partner + 1], got_end = e->received[partner + 1];
  for (size_t at = e->begin[partner], got_at = e->received[partner]; at < end || got_at < got_end;) {
    size_t n = parcel_of(at, end), n_got = parcel_of(got_at, got_end), n_bytes;
    void *received = e->parcel;
    pack_splats(e, at, n, e->parcel);
    if (partner != team->index)
      received = conic_team_swap(team, partner, e->parcel, n * (e->n_columns + 1) * sizeof *e->parcel, &n_bytes);
    unpack_splats(e, got_at, n_got, received);
    if (partner != team->index)
      team->release(team->data, received);
    at += n;
    got_at += n_got;
  }
}

static conic_status make_exchange_room(conic_context *context, splat_exchange *e, conic_splats *to) {
  size_t n = e->received[e->shares->team->count];
  conic_status status = conic_splats_allocate(context, n, conic_splats_fields(e->from) & FIELDS, to);
  if (status != CONIC_OK)
    return status;
  memcpy(to->origin, e->from->origin, sizeof to->origin);
  e->n_columns = list_floats(e->from, e->own);
  list_floats(to, e->got);
  return conic_memory_allocate_these(context, CONIC_ROOM(e->ids, n),
                                     CONIC_ROOM(e->parcel, (e->n_columns + 1) * PARCEL));
}

conic_status conic_splats_exchange(conic_context *context, const conic_splats_shares *shares, const conic_splats *from,
                                   const size_t *begin, const uint32_t *list, conic_splats *to, uint32_t **ids) {
  splat_exchange e = {.shares = shares, .from = from, .begin = begin, .list = list};
  memset(to, 0, sizeof *to);
  e.received = conic_memory_allocate(context, (size_t)shares->team->count + 1, sizeof *e.received);
  conic_status status = conic_team_agree(shares->team, e.received ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK) {
    swap_counts(&e);
    status = conic_team_agree(shares->team, make_exchange_room(context, &e, to));
  }
  for (int round = 0; round < shares->team->count && status == CONIC_OK; round++)
    meet_partner(&e, conic_team_partner(shares->team, round));
  if (status != CONIC_OK) {
    conic_splats_release(context, to);
    conic_memory_release(context, e.ids);
    e.ids = NULL;
  }
  *ids = e.ids;
  conic_memory_release_these(context, e.received, e.parcel);
  return status;
}
