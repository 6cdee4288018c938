#include "lod/hybrid/model/hybrid_store.h"

#include "lod/hybrid/model/hybrid_chunks.h"

#define CONIC_NO_CHUNK UINT32_MAX

/* A chunk. Those that are in memory and not held are in a list, from the one that was let go last. */
typedef struct chunk_slot {
  unsigned char *bytes; /* null: it is not there */
  uint32_t newer, older;
  uint32_t n_holds;
  uint8_t is_doubted; /* its bytes were wrong once */
} chunk_slot;

struct conic_hybrid_store {
  conic_context *context;
  conic_ranges *ranges;
  char *name;
  int is_remote;
  uint64_t data_at, cache_bytes;
  chunk_slot *slots;
  uint32_t newest, oldest;
  conic_hybrid_traffic traffic;
};

conic_status conic_hybrid_store_open(const conic_hybrid *h, const char *name, conic_ranges *ranges, uint64_t data_at,
                                     uint64_t cache_bytes, conic_hybrid_store **made) {
  conic_hybrid_store *store = *made = conic_memory_allocate_zeroed(h->context, 1, sizeof *store);
  if (!store) {
    conic_ranges_close(ranges);
    return CONIC_ERROR_MEMORY;
  }
  store->context = h->context;
  store->ranges = ranges;
  store->is_remote = conic_ranges_is_url(name);
  store->data_at = store->traffic.n_bytes = data_at;
  store->cache_bytes = cache_bytes ? cache_bytes : UINT64_MAX;
  store->newest = store->oldest = CONIC_NO_CHUNK;
  if (conic_memory_allocate_these(h->context, CONIC_ROOM(store->name, strlen(name) + 1),
                                  CONIC_ZEROED(store->slots, conic_hybrid_count_chunks(h))) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  memcpy(store->name, name, strlen(name) + 1);
  return CONIC_OK;
}

static chunk_slot *unlink_chunk(conic_hybrid_store *store, uint32_t chunk) {
  chunk_slot *slot = &store->slots[chunk];
  *(slot->newer == CONIC_NO_CHUNK ? &store->newest : &store->slots[slot->newer].older) = slot->older;
  *(slot->older == CONIC_NO_CHUNK ? &store->oldest : &store->slots[slot->older].newer) = slot->newer;
  return slot;
}

static void link_chunk(conic_hybrid_store *store, uint32_t chunk) {
  chunk_slot *slot = &store->slots[chunk];
  slot->newer = CONIC_NO_CHUNK;
  slot->older = store->newest;
  *(store->newest == CONIC_NO_CHUNK ? &store->oldest : &store->slots[store->newest].newer) = chunk;
  store->newest = chunk;
}

static void drop_oldest(const conic_hybrid *h) {
  conic_hybrid_store *store = h->store;
  uint32_t chunk = store->oldest;
  chunk_slot *slot = unlink_chunk(store, chunk);
  store->traffic.n_kept_bytes -= conic_hybrid_chunk_place(h, chunk).n_bytes;
  conic_memory_release(store->context, slot->bytes);
  slot->bytes = NULL;
}

void conic_hybrid_store_close(conic_hybrid_store *store) {
  if (!store)
    return;
  for (uint32_t chunk = store->oldest; chunk != CONIC_NO_CHUNK; chunk = store->slots[chunk].newer)
    conic_memory_release(store->context, store->slots[chunk].bytes);
  conic_memory_release_these(store->context, store->slots, store->name);
  conic_ranges_close(store->ranges);
  conic_memory_release(store->context, store);
}

const unsigned char *conic_hybrid_store_bytes(const conic_hybrid_store *store, uint32_t chunk) {
  return store->slots[chunk].bytes;
}

uint64_t conic_hybrid_store_room(const conic_hybrid *h) {
  return h->store ? h->store->cache_bytes : UINT64_MAX;
}

conic_hybrid_traffic conic_hybrid_store_traffic(const conic_hybrid *h) {
  conic_hybrid_traffic none = {0, 0, 0, 0};
  if (!h->store)
    return none;
  h->store->traffic.n_received = conic_ranges_received(h->store->ranges);
  return h->store->traffic;
}

/* --- reading --- */

static conic_status ask_for_chunk(const conic_hybrid *h, uint32_t chunk) {
  conic_hybrid_place place = conic_hybrid_chunk_place(h, chunk);
  conic_range range = {
      .offset = h->store->data_at + place.at, .n_bytes = (size_t)place.n_bytes, .priority = place.at, .id = chunk};
  return conic_ranges_request(h->store->ranges, &range);
}

static conic_status fail_chunk(const conic_hybrid *h, uint32_t chunk, conic_status status, const char *reason) {
  return conic_fail(h->context, status, "%s: cannot read chunk %u: %s (at byte %llu)", h->store->name, (unsigned)chunk,
                    reason, (unsigned long long)(h->store->data_at + conic_hybrid_chunk_place(h, chunk).at));
}

/* A copy of what came; what came wrong from a server is asked for once again. */
static conic_status take_answer(const conic_hybrid *h, const conic_range_answer *answer) {
  conic_hybrid_store *store = h->store;
  chunk_slot *slot = &store->slots[answer->id];
  if (answer->status != CONIC_OK)
    return fail_chunk(h, answer->id, answer->status, answer->reason);
  while (store->oldest != CONIC_NO_CHUNK && store->traffic.n_kept_bytes + answer->n_bytes > store->cache_bytes)
    drop_oldest(h);
  unsigned char *bytes = conic_memory_copy(store->context, answer->bytes, answer->n_bytes);
  if (!bytes)
    return CONIC_ERROR_MEMORY;
  const char *wrong = conic_hybrid_take_chunk(h, answer->id, bytes);
  if (!wrong) {
    slot->bytes = bytes;
    store->traffic.n_chunks++;
    store->traffic.n_bytes += answer->n_bytes;
    store->traffic.n_kept_bytes += answer->n_bytes;
    return CONIC_OK;
  }
  conic_memory_release(store->context, bytes);
  if (!store->is_remote || slot->is_doubted)
    return fail_chunk(h, answer->id, CONIC_ERROR_INPUT, wrong);
  slot->is_doubted = 1;
  return ask_for_chunk(h, answer->id);
}

static conic_status take_answers(const conic_hybrid *h) {
  conic_ranges *ranges = h->store->ranges;
  size_t n_asked = conic_ranges_pending(ranges);
  conic_status status = CONIC_OK;
  while (status == CONIC_OK && conic_ranges_pending(ranges) > 0) {
    conic_range_answer answer;
    if (conic_ranges_next(ranges, 0.1, &answer)) {
      status = take_answer(h, &answer);
      if (answer.bytes)
        conic_ranges_release(ranges, &answer);
    }
    if (status == CONIC_OK && h->store->is_remote)
      status = conic_progress(h->context, "fetch", 1.0 - (double)conic_ranges_pending(ranges) / (double)n_asked);
  }
  return status;
}

conic_status conic_hybrid_store_hold(const conic_hybrid *h, const uint32_t *chunks, size_t n) {
  conic_hybrid_store *store = h->store;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && store; i++) {
    chunk_slot *slot = &store->slots[chunks[i]];
    if (slot->n_holds++ > 0 || conic_hybrid_chunk_place(h, chunks[i]).n_bytes == 0)
      continue;
    if (slot->bytes)
      unlink_chunk(store, chunks[i]);
    else if (status == CONIC_OK)
      status = ask_for_chunk(h, chunks[i]);
  }
  if (store && status == CONIC_OK)
    status = take_answers(h);
  if (store && status != CONIC_OK) {
    conic_ranges_cancel(store->ranges);
    conic_hybrid_store_let_go(h, chunks, n);
  }
  return status;
}

void conic_hybrid_store_let_go(const conic_hybrid *h, const uint32_t *chunks, size_t n) {
  for (size_t i = 0; i < n && h->store; i++) {
    chunk_slot *slot = &h->store->slots[chunks[i]];
    if (--slot->n_holds == 0 && slot->bytes)
      link_chunk(h->store, chunks[i]);
  }
}
