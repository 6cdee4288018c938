#include "lod/layers/draw/layers_store.h"

#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/threads.h"
#include "lod/layers/draw/layers_scene.h"

/* So many answers are decoded together. */
enum { DECODED_TOGETHER = 64 };

/* A cloud on its way into memory. */
typedef struct arrival {
  conic_range_answer answer;
  void *block;
  conic_layers_cloud cloud;
  const char *wrong; /* with its bytes; null: nothing */
} arrival;

typedef struct arrivals {
  conic_layers *layers;
  arrival all[DECODED_TOGETHER];
  size_t n;
} arrivals;

conic_status conic_layers_store_open(conic_layers *layers) {
  conic_layers_store *store = &layers->store;
  conic_context *context = layers->context;
  size_t n_threads = (size_t)conic_context_threads(context);
  store->newest = store->oldest = CONIC_NO_CLOUD;
  store->slots = conic_memory_allocate_zeroed(context, layers->header.n_clouds, sizeof *store->slots);
  store->decoders = conic_memory_allocate_zeroed(context, n_threads, sizeof(void *));
  if (!store->slots || !store->decoders)
    return CONIC_ERROR_MEMORY;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n_threads && status == CONIC_OK; i++)
    status = conic_layers_decoder_create(context, &layers->header, &store->decoders[i]);
  return status;
}

void conic_layers_store_close(conic_layers *layers) {
  conic_layers_store *store = &layers->store;
  conic_context *context = layers->context;
  for (uint32_t i = 0; store->slots && i < layers->header.n_clouds; i++)
    conic_memory_release(context, store->slots[i].block);
  for (int i = 0; store->decoders && i < conic_context_threads(context); i++)
    conic_layers_decoder_destroy(store->decoders[i]);
  conic_memory_release(context, store->slots);
  conic_memory_release(context, store->decoders);
  memset(store, 0, sizeof *store);
}

static size_t bytes_of(const conic_layers *layers, uint32_t cloud) {
  return conic_layers_cloud_bytes(&layers->header, &layers->entries[cloud]);
}

static void unlink_slot(conic_layers_store *store, uint32_t cloud) {
  conic_layers_slot *slot = &store->slots[cloud];
  uint32_t *from_newer = slot->newer == CONIC_NO_CLOUD ? &store->newest : &store->slots[slot->newer].older;
  uint32_t *from_older = slot->older == CONIC_NO_CLOUD ? &store->oldest : &store->slots[slot->older].newer;
  *from_newer = slot->older;
  *from_older = slot->newer;
}

static void link_newest(conic_layers_store *store, uint32_t cloud) {
  conic_layers_slot *slot = &store->slots[cloud];
  slot->newer = CONIC_NO_CLOUD;
  slot->older = store->newest;
  if (store->newest == CONIC_NO_CLOUD)
    store->oldest = cloud;
  else
    store->slots[store->newest].newer = cloud;
  store->newest = cloud;
}

static void drop_cloud(conic_layers *layers, uint32_t cloud) {
  conic_layers_store *store = &layers->store;
  unlink_slot(store, cloud);
  conic_memory_release(layers->context, store->slots[cloud].block);
  store->slots[cloud].block = NULL;
  store->n_bytes -= bytes_of(layers, cloud);
}

/* Drops what was not used for longest, so that there is room for so many bytes more. */
static void make_room_for_bytes(conic_layers *layers, size_t n_bytes) {
  conic_layers_store *store = &layers->store;
  uint64_t bound = conic_layers_cache_bytes(layers);
  for (uint32_t cloud = store->oldest; cloud != CONIC_NO_CLOUD && store->n_bytes + n_bytes > bound;) {
    uint32_t newer = store->slots[cloud].newer;
    if (store->slots[cloud].n_pins == 0)
      drop_cloud(layers, cloud);
    cloud = newer;
  }
}

static void pin(conic_layers_store *store, uint32_t cloud) {
  store->slots[cloud].n_pins++;
  unlink_slot(store, cloud);
  link_newest(store, cloud);
}

static conic_status request(conic_layers *layers, uint32_t cloud) {
  const conic_layers_entry *entry = &layers->entries[cloud];
  conic_range range = {.offset = entry->offset, .n_bytes = entry->n_bytes, .priority = cloud, .id = cloud};
  return conic_ranges_request(layers->ranges, &range);
}

static void decode_task(void *data, size_t i_item, int i_thread) {
  arrivals *a = data;
  arrival *one = &a->all[i_item];
  if (one->block)
    one->wrong = conic_layers_decode(a->layers->store.decoders[i_thread], &a->layers->entries[one->answer.id],
                                     one->answer.bytes, &one->cloud);
}

static void keep_cloud(conic_layers *layers, arrival *one) {
  conic_layers_store *store = &layers->store;
  conic_layers_slot *slot = &store->slots[one->answer.id];
  slot->block = one->block;
  slot->cloud = one->cloud;
  slot->is_doubted = 0;
  link_newest(store, one->answer.id);
  slot->n_pins++;
  store->n_bytes += bytes_of(layers, one->answer.id);
  store->n_read++;
  one->block = NULL;
}

/* What becomes of a cloud that did not arrive as it should: asked for once again, missed, or an error. */
static conic_status take_failure(conic_layers *layers, const arrival *one, conic_layers_loading *loading) {
  uint32_t cloud = one->answer.id;
  conic_layers_slot *slot = &layers->store.slots[cloud];
  unsigned long long offset = layers->entries[cloud].offset;
  if (one->wrong && layers->is_remote && !slot->is_doubted && layers->access.n_retries > 0) {
    slot->is_doubted = 1;
    return request(layers, cloud);
  }
  conic_status status = one->wrong ? CONIC_ERROR_INPUT : one->answer.status;
  const char *reason = one->wrong ? one->wrong : one->answer.reason;
  loading->n_missing++;
  loading->n_damaged += status == CONIC_ERROR_INPUT;
  if (status == CONIC_ERROR_INPUT ? !loading->tolerates_damage : !loading->may_miss)
    return conic_fail(layers->context, status, "%s: cannot read cloud %u: %s (at byte %llu)", layers->name, cloud,
                      reason, offset);
  if (status == CONIC_ERROR_INPUT && loading->n_damaged == 1)
    conic_log(layers->context, CONIC_LOG_WARNING, "%s: cloud %u: %s (at byte %llu); what is damaged is drawn coarser",
              layers->name, cloud, reason, offset);
  return CONIC_OK;
}

/* Fetches what has come by now, or within the wait. */
static void collect_clouds(conic_layers *layers, double wait_s, arrivals *a) {
  for (a->n = 0; a->n < DECODED_TOGETHER; a->n++) {
    arrival *one = &a->all[a->n];
    memset(one, 0, sizeof *one);
    if (!conic_ranges_next(layers->ranges, a->n == 0 ? wait_s : 0.0, &one->answer))
      return;
    if (one->answer.status != CONIC_OK) { /* its reason holds until the next call */
      a->n++;
      return;
    }
  }
}

static conic_status allocate_blocks(conic_layers *layers, arrivals *a) {
  for (size_t i = 0; i < a->n; i++) {
    arrival *one = &a->all[i];
    if (one->answer.status != CONIC_OK)
      continue;
    size_t n_bytes = bytes_of(layers, one->answer.id);
    make_room_for_bytes(layers, n_bytes);
    one->block = conic_memory_allocate(layers->context, n_bytes, 1);
    if (!one->block)
      return CONIC_ERROR_MEMORY;
    conic_layers_cloud_place(&layers->header, &layers->entries[one->answer.id], one->block, &one->cloud);
  }
  return CONIC_OK;
}

static conic_status take_arrivals(conic_layers *layers, arrivals *a, conic_layers_loading *loading) {
  conic_status status = allocate_blocks(layers, a);
  if (status == CONIC_OK)
    conic_parallel_for(layers->context, a->n, decode_task, a);
  for (size_t i = 0; i < a->n; i++) {
    arrival *one = &a->all[i];
    if (status == CONIC_OK && one->block && !one->wrong)
      keep_cloud(layers, one);
    else if (status == CONIC_OK)
      status = take_failure(layers, one, loading);
    conic_memory_release(layers->context, one->block);
    if (one->answer.bytes)
      conic_ranges_release(layers->ranges, &one->answer);
  }
  return status;
}

/* Waits for what was asked for. */
static conic_status take_all(conic_layers *layers, size_t n_asked, conic_layers_loading *loading) {
  arrivals a = {.layers = layers};
  while (conic_ranges_pending(layers->ranges) > 0) {
    double left = loading->until_s - conic_seconds_now();
    if (!(left > 0.0))
      break;
    collect_clouds(layers, left < 0.1 ? left : 0.1, &a);
    conic_status status = take_arrivals(layers, &a, loading);
    double fraction = 1.0 - (double)conic_ranges_pending(layers->ranges) / (double)n_asked;
    if (status == CONIC_OK && layers->is_remote)
      status = conic_progress(layers->context, "fetch", fraction);
    if (status != CONIC_OK)
      return status;
  }
  loading->n_missing += conic_ranges_pending(layers->ranges);
  return CONIC_OK;
}

conic_status conic_layers_store_load(conic_layers *layers, conic_layers_loading *loading) {
  conic_status status = CONIC_OK;
  size_t n_asked = 0;
  loading->n_missing = loading->n_damaged = 0;
  for (size_t i = 0; i < loading->n; i++)
    if (layers->store.slots[loading->clouds[i]].block)
      pin(&layers->store, loading->clouds[i]);
  for (size_t i = 0; i < loading->n && status == CONIC_OK; i++)
    if (!layers->store.slots[loading->clouds[i]].block) {
      status = request(layers, loading->clouds[i]);
      n_asked++;
    }
  if (status == CONIC_OK)
    status = take_all(layers, n_asked, loading);
  conic_ranges_cancel(layers->ranges);
  if (status == CONIC_OK && loading->n_missing && !loading->may_miss)
    status = conic_fail(layers->context, CONIC_ERROR_MEMORY, "%s: clouds are missing", layers->name);
  if (status != CONIC_OK)
    conic_layers_store_unpin(layers, loading);
  return status;
}

void conic_layers_store_unpin(conic_layers *layers, const conic_layers_loading *loading) {
  for (size_t i = 0; i < loading->n; i++) {
    conic_layers_slot *slot = &layers->store.slots[loading->clouds[i]];
    if (slot->n_pins > 0)
      slot->n_pins--;
  }
}

size_t conic_layers_store_fit(const conic_layers *layers, const uint32_t *clouds, size_t n, uint64_t n_bytes) {
  uint64_t sum = 0;
  for (size_t i = 0; i < n; i++) {
    sum += bytes_of(layers, clouds[i]);
    if (sum > n_bytes)
      return i ? i : 1;
  }
  return n;
}
