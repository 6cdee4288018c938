#include "lod/layers/draw/layers_store.h"

#include "lod/layers/draw/layers_octree.h"

/* So many answers are decoded together. */
enum { DECODED_TOGETHER = 64, BLOCK_STEP = 1 << 14 };

/* The part of a block that tells where its arrays are. */
enum { HEAD_BYTES = (sizeof(conic_layers_cloud) + 63) / 64 * 64 };

/* A cloud on its way into memory. */
typedef struct arrival {
  conic_range_answer answer;
  conic_layers_cloud *cloud; /* null: none */
  const char *wrong;         /* with its bytes; null: nothing */
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
  store->slots = conic_memory_allocate_zeroed(context, conic_layers_all(layers), sizeof *store->slots);
  if (layers->octree)
    return store->slots ? CONIC_OK : CONIC_ERROR_MEMORY;
  store->decoders = conic_memory_allocate_zeroed(context, 2 * n_threads, sizeof(void *));
  if (!store->slots || !store->decoders)
    return CONIC_ERROR_MEMORY;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n_threads && status == CONIC_OK; i++)
    status = conic_layers_decoder_create(context, &layers->header, &layers->choice, &store->decoders[i]);
  for (size_t i = 0; i < n_threads && status == CONIC_OK && layers->n_all; i++)
    status = conic_layers_decoder_create(context, &layers->stand_ins, NULL, &store->decoders[n_threads + i]);
  return status;
}

void conic_layers_store_close(conic_layers *layers) {
  conic_layers_store *store = &layers->store;
  conic_context *context = layers->context;
  for (uint32_t i = 0; store->slots && i < conic_layers_all(layers); i++)
    conic_memory_release(context, store->slots[i].cloud);
  for (int i = 0; store->decoders && i < 2 * conic_context_threads(context); i++)
    conic_layers_decoder_destroy(store->decoders[i]);
  conic_memory_release_these(context, store->slots, store->decoders);
  memset(store, 0, sizeof *store);
}

static const conic_layers_header *header_of(const conic_layers *layers, uint32_t cloud) {
  return conic_layers_is_stand_in(layers, cloud) ? &layers->stand_ins : &layers->header;
}

/* What is made of values: stand-ins have none. */
static const conic_layers_choice *choice_of(const conic_layers *layers, uint32_t cloud) {
  return conic_layers_is_stand_in(layers, cloud) ? NULL : &layers->choice;
}

/* There are few sizes, so that what one cloud leaves another can take. */
static size_t bytes_of(const conic_layers *layers, uint32_t cloud) {
  size_t n_bytes = HEAD_BYTES + conic_layers_cloud_bytes(header_of(layers, cloud), &layers->entries[cloud],
                                                         choice_of(layers, cloud));
  return (n_bytes + (BLOCK_STEP - 1)) / BLOCK_STEP * BLOCK_STEP;
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

/* Drops what was not used for longest, so that there is room for so many bytes more. */
static void make_room_for_bytes(conic_layers *layers, size_t n_bytes) {
  conic_layers_store *store = &layers->store;
  uint64_t bound = conic_layers_cache_bytes(layers);
  for (uint32_t cloud = store->oldest; cloud != CONIC_NO_CLOUD && store->n_bytes + n_bytes > bound;) {
    uint32_t newer = store->slots[cloud].newer;
    if (store->slots[cloud].n_pins == 0) {
      unlink_slot(store, cloud);
      conic_memory_release(layers->context, store->slots[cloud].cloud);
      store->slots[cloud].cloud = NULL;
      store->n_bytes -= bytes_of(layers, cloud);
    }
    cloud = newer;
  }
}

static conic_range range_of_cloud(const conic_layers *layers, uint32_t cloud) {
  const conic_layers_entry *entry = &layers->entries[cloud];
  conic_range range = {.offset = entry->offset, .n_bytes = entry->n_bytes, .priority = cloud, .id = cloud};
  if (layers->octree)
    conic_layers_octree_locate(layers, cloud, &range);
  return range;
}

static conic_status request(conic_layers *layers, uint32_t cloud) {
  conic_range range = range_of_cloud(layers, cloud);
  return conic_ranges_request(layers->ranges, &range);
}

static void decode_task(void *data, size_t i_item, int i_thread) {
  arrivals *a = data;
  arrival *one = &a->all[i_item];
  if (one->cloud && a->layers->octree)
    one->wrong =
        conic_layers_octree_decode(a->layers, one->answer.id, one->answer.bytes, one->answer.n_bytes, one->cloud);
  else if (one->cloud) {
    if (conic_layers_is_stand_in(a->layers, one->answer.id))
      i_thread += conic_context_threads(a->layers->context);
    one->wrong = conic_layers_decode(a->layers->store.decoders[i_thread], &a->layers->entries[one->answer.id],
                                     one->answer.bytes, one->cloud);
  }
}

static conic_status keep_cloud(conic_layers *layers, arrival *one) {
  conic_layers_store *store = &layers->store;
  conic_layers_slot *slot = &store->slots[one->answer.id];
  slot->cloud = one->cloud;
  slot->is_doubted = 0;
  link_newest(store, one->answer.id);
  slot->n_pins += slot->is_wanted;
  store->n_ahead += slot->is_asked;
  store->n_asked -= slot->is_asked;
  slot->is_asked = slot->is_wanted = 0;
  store->n_bytes += bytes_of(layers, one->answer.id);
  store->n_read++;
  one->cloud = NULL;
  return layers->octree ? conic_layers_octree_keep(layers, one->answer.id, slot->cloud) : CONIC_OK;
}

/* What becomes of a cloud that did not arrive as it should: asked for once again, missed, or an error. */
static conic_status take_failure(conic_layers *layers, const arrival *one, conic_layers_loading *loading) {
  uint32_t cloud = one->answer.id;
  conic_layers_slot *slot = &layers->store.slots[cloud];
  unsigned long long offset = layers->entries[cloud].offset;
  layers->store.n_asked -= slot->is_asked;
  slot->is_asked = 0;
  if (!slot->is_wanted) /* whoever wants it will ask again */
    return CONIC_OK;
  if (one->wrong && layers->is_remote && !slot->is_doubted && layers->access.n_retries > 0) {
    slot->is_doubted = 1;
    return request(layers, cloud);
  }
  conic_status status = one->wrong ? CONIC_ERROR_INPUT : one->answer.status;
  const char *reason = one->wrong ? one->wrong : one->answer.reason;
  slot->is_wanted = 0;
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

/* Fetches what has come by now, or within the wait; where that is below 0, nothing more is asked for. */
static void collect_clouds(conic_layers *layers, double wait_s, arrivals *a) {
  for (a->n = 0; a->n < DECODED_TOGETHER; a->n++) {
    arrival *one = &a->all[a->n];
    memset(one, 0, sizeof *one);
    if (!conic_ranges_next(layers->ranges, a->n == 0 || wait_s < 0.0 ? wait_s : 0.0, &one->answer))
      return;
    if (one->answer.status != CONIC_OK) { /* its reason holds until the next call */
      a->n++;
      return;
    }
  }
}

conic_status conic_layers_store_allocate(const conic_layers *layers, uint32_t cloud, conic_layers_cloud **made) {
  *made = conic_memory_allocate(layers->context, bytes_of(layers, cloud), 1);
  if (!*made)
    return CONIC_ERROR_MEMORY;
  conic_layers_cloud_place(header_of(layers, cloud), &layers->entries[cloud], choice_of(layers, cloud),
                           (char *)*made + HEAD_BYTES, *made);
  return CONIC_OK;
}

static conic_status allocate_blocks(conic_layers *layers, arrivals *a) {
  size_t n_new = 0;
  for (size_t i = 0; i < a->n; i++) {
    arrival *one = &a->all[i];
    if (one->answer.status != CONIC_OK)
      continue;
    size_t n_bytes = bytes_of(layers, one->answer.id);
    if (layers->entries[one->answer.id].n_samples / CONIC_HIERARCHY_POINTS_A_BYTE > one->answer.n_bytes) {
      one->wrong = "its bytes are too few for so many points";
      continue;
    }
    n_new += n_bytes;
    make_room_for_bytes(layers, n_new);
    conic_status status = conic_layers_store_allocate(layers, one->answer.id, &one->cloud);
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

static conic_status take_arrivals(conic_layers *layers, arrivals *a, conic_layers_loading *loading) {
  conic_status status = allocate_blocks(layers, a);
  if (a->n > 0 && !a->all[a->n - 1].answer.reason) /* which holds until the next call */
    conic_ranges_go_on(layers->ranges);
  if (status == CONIC_OK)
    conic_parallel_for(layers->context, a->n, decode_task, a);
  for (size_t i = 0; i < a->n; i++) {
    arrival *one = &a->all[i];
    if (status == CONIC_OK && one->cloud && !one->wrong)
      status = keep_cloud(layers, one);
    else if (status == CONIC_OK)
      status = take_failure(layers, one, loading);
    conic_memory_release(layers->context, one->cloud);
    if (one->answer.bytes)
      conic_ranges_release(layers->ranges, &one->answer);
  }
  return status;
}

/* A .lpc's index was checked; another hierarchy may point anywhere. */
static conic_status ask_for_cloud(conic_layers *layers, uint32_t cloud, conic_layers_loading *loading) {
  conic_range range = range_of_cloud(layers, cloud);
  range.priority = loading->ranks ? loading->ranks[cloud] : cloud;
  arrival here = {.answer = {.id = cloud},
                  .cloud = layers->octree ? conic_layers_octree_take_first(layers, cloud) : NULL};
  if (here.cloud) {
    make_room_for_bytes(layers, bytes_of(layers, cloud));
    return keep_cloud(layers, &here);
  }
  if (conic_ranges_holds(layers->ranges, &range))
    return conic_ranges_request(layers->ranges, &range);
  const arrival lost = {
      .answer = {.id = cloud, .status = CONIC_ERROR_INPUT, .reason = "its bytes lie outside the file"}};
  return take_failure(layers, &lost, loading);
}

/* Waits for what was asked for. What has come when the time is up is taken. */
static conic_status take_all(conic_layers *layers, size_t n_asked, conic_layers_loading *loading) {
  arrivals a = {.layers = layers};
  for (a.n = 1; conic_ranges_pending(layers->ranges) > 0;) {
    double left = loading->until_s - conic_seconds_now();
    if (!(left > 0.0) && (a.n == 0 || !layers->is_remote))
      break;
    collect_clouds(layers, left < 0.1 ? left : 0.1, &a);
    conic_status status = take_arrivals(layers, &a, loading);
    double fraction = 1.0 - (double)conic_ranges_pending(layers->ranges) / (double)n_asked;
    if (status == CONIC_OK && layers->is_remote)
      status = conic_progress(layers->context, "fetch", fraction);
    if (status != CONIC_OK)
      return status;
  }
  for (size_t i = 0; i < loading->n; i++)
    loading->n_missing += layers->store.slots[loading->clouds[i]].is_wanted;
  return CONIC_OK;
}

/* Ends what is under way. */
static void forget_asked(conic_layers *layers) {
  conic_ranges_cancel(layers->ranges);
  for (uint32_t i = 0; i < conic_layers_all(layers) && layers->store.n_asked > 0; i++) {
    layers->store.n_asked -= layers->store.slots[i].is_asked;
    layers->store.slots[i].is_asked = 0;
  }
}

/* Takes what was asked for ahead and has come; where little of the rest is wanted now, gives that up. */
static conic_status take_ahead(conic_layers *layers, const conic_layers_loading *loading) {
  conic_layers_loading none = {.until_s = 0.0};
  arrivals a = {.layers = layers};
  conic_status status = CONIC_OK;
  uint64_t n_wanted = 0;
  do {
    collect_clouds(layers, 0.0, &a);
    status = take_arrivals(layers, &a, &none);
  } while (a.n > 0 && status == CONIC_OK);
  for (size_t i = 0; i < loading->n; i++)
    n_wanted += layers->store.slots[loading->clouds[i]].is_asked;
  if (2 * n_wanted < layers->store.n_asked)
    forget_asked(layers);
  return status;
}

conic_status conic_layers_store_ask_ahead(conic_layers *layers, const uint32_t *clouds, size_t n) {
  conic_layers_store *store = &layers->store;
  size_t n_fit = conic_layers_store_fit(layers, clouds, n, conic_layers_cache_bytes(layers));
  conic_status status = CONIC_OK;
  if (layers->octree) /* whose pages come in between */
    return CONIC_OK;
  for (size_t i = 0; i < n_fit && status == CONIC_OK; i++) {
    conic_layers_slot *slot = &store->slots[clouds[i]];
    if (slot->cloud) { /* is to stay */
      unlink_slot(store, clouds[i]);
      link_newest(store, clouds[i]);
    } else if (!slot->is_asked) {
      status = request(layers, clouds[i]);
      slot->is_asked = status == CONIC_OK;
      store->n_asked += slot->is_asked;
    }
  }
  conic_ranges_go_on(layers->ranges);
  return status;
}

conic_status conic_layers_store_load(conic_layers *layers, conic_layers_loading *loading) {
  conic_status status = layers->store.n_asked > 0 ? take_ahead(layers, loading) : CONIC_OK;
  loading->n_missing = loading->n_damaged = 0;
  for (size_t i = 0; i < loading->n; i++)
    if (layers->store.slots[loading->clouds[i]].cloud) {
      layers->store.slots[loading->clouds[i]].n_pins++;
      unlink_slot(&layers->store, loading->clouds[i]);
      link_newest(&layers->store, loading->clouds[i]);
    }
  for (size_t i = 0; i < loading->n && status == CONIC_OK; i++)
    if (!conic_layers_has_cloud(layers, loading->clouds[i])) {
      layers->store.slots[loading->clouds[i]].is_wanted = 1;
      if (!layers->store.slots[loading->clouds[i]].is_asked)
        status = ask_for_cloud(layers, loading->clouds[i], loading);
    }
  if (status == CONIC_OK)
    status = take_all(layers, conic_ranges_pending(layers->ranges), loading);
  for (size_t i = 0; i < loading->n; i++)
    layers->store.slots[loading->clouds[i]].is_wanted = 0;
  forget_asked(layers);
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

void conic_layers_store_renumber(conic_layers *layers, const uint32_t *becomes, conic_layers_slot *slots) {
  conic_layers_store *store = &layers->store;
  uint32_t *const ends[] = {&store->newest, &store->oldest};
  for (uint32_t i = store->oldest; i != CONIC_NO_CLOUD; i = store->slots[i].newer) {
    conic_layers_slot *slot = &slots[becomes[i]];
    *slot = store->slots[i];
    slot->newer = slot->newer == CONIC_NO_CLOUD ? CONIC_NO_CLOUD : becomes[slot->newer];
    slot->older = slot->older == CONIC_NO_CLOUD ? CONIC_NO_CLOUD : becomes[slot->older];
  }
  for (int i = 0; i < 2; i++)
    *ends[i] = *ends[i] == CONIC_NO_CLOUD ? CONIC_NO_CLOUD : becomes[*ends[i]];
  conic_memory_release(layers->context, store->slots);
  store->slots = slots;
}
