#include "lod/layers/build/layers_chunks.h"

#include <stdatomic.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/threads.h"
#include "lod/layers/build/layers_crown.h"
#include "lod/layers/build/layers_record.h"
#include "lod/layers/build/layers_waiting.h"
#include "lod/layers/format/layers_axes.h"

/* A part holds no more samples than this, so that progress is seen; and no more than the fraction of all of them that
 * keeps all threads busy. */
enum { MOST_IN_PART = 1 << 19, PARTS_A_THREAD = 8 };

/* Buckets in a row whose samples are one cell's, and how often what has grown of them and what waits before it are
 * joined then: trees come as a sum in reverse Polish notation does. */
typedef struct chunk {
  size_t first, end;
  uint64_t n_samples;
  unsigned n_joins; /* within its part */
} chunk;

/* Chunks in a row that one worker grows and joins to one tree. */
typedef struct layers_part {
  size_t first, end;
  uint64_t n_samples;
  unsigned n_joins; /* with other parts */
  int ends_limb;
  conic_layers_branch *branch;
  conic_layers_entry *nodes;
  size_t n_nodes;
  conic_status status;
} layers_part;

/* Branches that wait to be joined. */
typedef struct stack {
  conic_layers_branch **branches;
  size_t n, room;
} stack;

/* What one thread at a time works with. */
typedef struct hand {
  conic_layers_worker *worker;
  conic_layers_shelf shelf;
  unsigned char *samples, *scratch; /* of a chunk */
  stack waiting;
  uint64_t *outlines; /* counted before the part that grows; null: nothing is kept */
  uint64_t part_bytes[CONIC_LAYERS_MOST_ATTRIBUTES];
} hand;

typedef struct growing {
  const conic_layers_plan *plan;
  const conic_layers_buckets *buckets;
  const conic_layers_shares *shares;
  const conic_layers_growth *growth;
  conic_layers_forest *forest;
  conic_layers_waiting waiting;
  uint64_t n_samples; /* in the buckets */
  uint64_t most_in_part;
  size_t n_chunks, chunk_room, n_parts, part_room;
  chunk *chunks;
  layers_part *parts;
  hand *hands;
  stack crown;
  size_t n_limbs;
  uint64_t *limb_ends; /* how many nodes there are when a limb has grown */
  size_t end_part;     /* of those that grow now */
  atomic_size_t next_part;
  atomic_int is_stopped;
  uint64_t n_grown;
} growing;

void conic_layers_forest_end(conic_layers_forest *forest) {
  conic_spool_end(&forest->nodes);
  conic_pile_end(&forest->clouds);
}

static conic_status add_chunk(growing *g, size_t first, size_t end, uint64_t n_samples) {
  conic_status status = conic_memory_reserve(g->plan->context, &g->chunks, g->n_chunks, g->n_chunks + 1, &g->chunk_room,
                                             sizeof *g->chunks);
  if (status == CONIC_OK)
    g->chunks[g->n_chunks++] = (chunk){.first = first, .end = end, .n_samples = n_samples};
  return status;
}

/* The first of some buckets in a row that is past the middle of the place they share; of those that coincide, the first
 * of the second half. */
static size_t split_buckets(const conic_layers_bucket *buckets, size_t first, size_t end) {
  uint64_t differing = buckets[first].key ^ buckets[end - 1].key;
  if (!differing)
    return first + (end - first) / 2;
  uint64_t bit = UINT64_C(1) << (63 - __builtin_clzll(differing));
  size_t at = first;
  while (!(buckets[at].key & bit))
    at++;
  return at;
}

static uint64_t samples_in_buckets(const growing *g, size_t first, size_t end) {
  uint64_t n_samples = 0;
  for (size_t i = first; i < end; i++)
    n_samples += g->buckets->buckets[i].count;
  return n_samples;
}

/* Whether some buckets in a row are to be parted: there are too many samples, or what has grown before. */
static int is_too_much(const growing *g, size_t first, size_t end, uint64_t most) {
  int has_kept = 0;
  for (size_t i = first; i < end && !has_kept; i++)
    has_kept = g->buckets->buckets[i].kept != NULL;
  return end - first > 1 && (has_kept || samples_in_buckets(g, first, end) > most);
}

/* The largest places of the tree that hold no more samples than a chunk may; a leaf is never parted. */
static conic_status list_chunks(growing *g, size_t first, size_t end) {
  uint64_t n_samples = samples_in_buckets(g, first, end);
  if (!is_too_much(g, first, end, g->growth->most))
    return add_chunk(g, first, end, n_samples);
  size_t middle = split_buckets(g->buckets->buckets, first, end);
  conic_status status = list_chunks(g, first, middle);
  if (status == CONIC_OK)
    status = list_chunks(g, middle, end);
  if (status == CONIC_OK)
    g->chunks[g->n_chunks - 1].n_joins++;
  return status;
}

static conic_status list_parts(growing *g, size_t first, size_t end) {
  uint64_t n_samples = samples_in_buckets(g, first, end);
  if (is_too_much(g, first, end, g->most_in_part)) {
    size_t middle = split_buckets(g->buckets->buckets, first, end);
    conic_status status = list_parts(g, first, middle);
    if (status == CONIC_OK)
      status = list_parts(g, middle, end);
    if (status == CONIC_OK)
      g->parts[g->n_parts - 1].n_joins++;
    return status;
  }
  size_t first_chunk = g->n_chunks;
  conic_status status =
      conic_memory_reserve(g->plan->context, &g->parts, g->n_parts, g->n_parts + 1, &g->part_room, sizeof *g->parts);
  if (status == CONIC_OK)
    status = list_chunks(g, first, end);
  if (status == CONIC_OK)
    g->parts[g->n_parts++] = (layers_part){.first = first_chunk, .end = g->n_chunks, .n_samples = n_samples};
  return status;
}

/* Adds a branch, which the stack takes over, and joins it as often as it is due. */
static conic_status push_branch(growing *g, const hand *with, stack *s, conic_layers_branch *branch, unsigned n_joins,
                                int is_alone, conic_layers_shelf *shelf) {
  conic_status status = conic_memory_reserve(g->plan->context, &s->branches, s->n, s->n + 1, &s->room, sizeof(void *));
  if (status != CONIC_OK) {
    conic_layers_branch_destroy(branch);
    return status;
  }
  s->branches[s->n++] = branch;
  status = conic_layers_put_away(s->branches, s->n);
  for (; n_joins > 0 && status == CONIC_OK; n_joins--) {
    s->n -= 2;
    status = conic_layers_join(with->worker, &s->branches[s->n], is_alone, shelf, &branch);
    if (status != CONIC_OK)
      break;
    s->branches[s->n++] = branch;
    status = conic_layers_put_away(s->branches, s->n);
  }
  return status;
}

/* What has grown before. */
static conic_status read_kept(growing *g, const conic_layers_kept_branch *kept, hand *h, conic_layers_branch **branch) {
  unsigned char *bytes;
  size_t n_bytes;
  conic_status status = conic_layers_kept_read(g->growth->kept, kept, &bytes, &n_bytes);
  if (status == CONIC_OK) {
    status = conic_layers_record_unpack(h->worker, bytes, n_bytes, kept, &h->shelf, branch);
    if (status == CONIC_ERROR_INPUT)
      conic_fail(g->plan->context, status, "%s: cannot go on: it has another content than it had a while ago",
                 g->growth->kept->folder);
  }
  conic_memory_release(g->plan->context, bytes);
  return status;
}

/* Whether the part has all samples of a place: of those that coincide it may have a half. */
static int is_whole_place(const growing *g, const layers_part *p) {
  const conic_layers_bucket *buckets = g->buckets->buckets;
  size_t first = g->chunks[p->first].first, end = g->chunks[p->end - 1].end;
  return (first == 0 || buckets[first - 1].key != buckets[first].key) &&
         (end == g->buckets->n || buckets[end - 1].key != buckets[end].key);
}

/* Of what has grown. */
static conic_status keep_grown_part(growing *g, const layers_part *p, hand *h) {
  uint64_t differing = p->branch->first_key ^ p->branch->last_key;
  unsigned n_bits = differing ? 64u - (unsigned)__builtin_clzll(differing) : 0u;
  const conic_layers_kept_branch place = {p->branch->first_key >> n_bits << n_bits, p->branch->n_place, n_bits};
  conic_layers_grown grown = {.branch = p->branch, .nodes = p->nodes, .n_nodes = p->n_nodes, .outlines = h->outlines};
  unsigned char *bytes;
  size_t n_bytes;
  for (size_t i = 0; i < CONIC_LAYERS_OUTLINES; i++)
    h->outlines[i] = conic_layers_worker_outlines(h->worker)[i] - h->outlines[i];
  for (int k = 0; k < CONIC_LAYERS_MOST_ATTRIBUTES; k++)
    grown.part_bytes[k] = h->shelf.part_bytes[k] - h->part_bytes[k];
  conic_status status = conic_layers_record_pack(g->plan, &grown, &g->forest->clouds, &bytes, &n_bytes);
  if (status == CONIC_OK)
    status = conic_layers_kept_add(g->growth->kept, &place, bytes, n_bytes);
  conic_memory_release(g->plan->context, bytes);
  return status;
}

static conic_status grow_chunk(growing *g, const chunk *c, hand *h) {
  conic_layers_branch *branch;
  unsigned char *sorted;
  const conic_layers_kept_branch *kept = g->buckets->buckets[c->first].kept;
  if (kept) {
    conic_status read = read_kept(g, kept, h, &branch);
    return read == CONIC_OK ? push_branch(g, h, &h->waiting, branch, c->n_joins, 0, &h->shelf) : read;
  }
  conic_status status = conic_layers_buckets_load(g->buckets, c->first, c->end, h->samples, h->scratch, &sorted);
  if (status == CONIC_OK)
    status = conic_layers_grow(h->worker, sorted, (size_t)c->n_samples, &h->shelf, &branch);
  return status == CONIC_OK ? push_branch(g, h, &h->waiting, branch, c->n_joins, 0, &h->shelf) : status;
}

static conic_status grow_part(growing *g, layers_part *p, hand *h) {
  conic_status status = CONIC_OK;
  int is_kept = h->outlines && !g->buckets->buckets[g->chunks[p->first].first].kept && is_whole_place(g, p);
  if (is_kept) {
    memcpy(h->outlines, conic_layers_worker_outlines(h->worker), CONIC_LAYERS_OUTLINES * sizeof *h->outlines);
    memcpy(h->part_bytes, h->shelf.part_bytes, sizeof h->part_bytes);
  }
  for (size_t i = p->first; i < p->end && status == CONIC_OK; i++)
    status = grow_chunk(g, &g->chunks[i], h);
  if (status == CONIC_OK)
    status = conic_layers_shelf_flush(&h->shelf);
  if (status != CONIC_OK)
    return status;
  p->branch = h->waiting.branches[--h->waiting.n];
  p->n_nodes = h->shelf.n_nodes;
  p->nodes = conic_memory_allocate(g->plan->context, p->n_nodes, sizeof *p->nodes);
  if (!p->nodes)
    return CONIC_ERROR_MEMORY;
  if (p->n_nodes > 0)
    memcpy(p->nodes, h->shelf.nodes, p->n_nodes * sizeof *p->nodes);
  h->shelf.n_nodes = h->shelf.n_put = 0;
  return is_kept ? keep_grown_part(g, p, h) : CONIC_OK;
}

/* Of the parts that grow now, one after the other. The calling thread tells of the progress before each of its own. */
static void grow_parts(void *data, size_t i_hand, int i_thread) {
  growing *g = data;
  for (;;) {
    size_t i = atomic_fetch_add(&g->next_part, 1);
    if (i >= g->end_part || atomic_load(&g->is_stopped))
      return;
    layers_part *p = &g->parts[i];
    p->status = CONIC_OK;
    if (i_thread == 0)
      p->status = conic_progress(g->plan->context, "build", (double)g->n_grown / (double)g->n_samples);
    if (p->status == CONIC_OK)
      p->status = grow_part(g, p, &g->hands[i_hand]);
    if (p->status != CONIC_OK)
      atomic_store(&g->is_stopped, 1);
  }
}

static conic_status put_nodes(growing *g, const conic_layers_entry *nodes, size_t n) {
  return conic_spool_append(&g->forest->nodes, nodes, n * sizeof *nodes);
}

/* Joins a part that has grown to those before it. */
static conic_status collect_part(growing *g, layers_part *p) {
  hand *h = &g->hands[0];
  conic_layers_branch *branch = p->branch;
  conic_status status = put_nodes(g, p->nodes, p->n_nodes);
  conic_memory_release(g->plan->context, p->nodes);
  p->nodes = NULL;
  if (status != CONIC_OK)
    return status;
  p->branch = NULL;
  g->n_grown += p->n_samples;
  status = push_branch(g, h, &g->crown, branch, p->n_joins, 1, &h->shelf);
  if (status == CONIC_OK)
    status = conic_layers_shelf_flush(&h->shelf);
  if (status == CONIC_OK)
    status = put_nodes(g, h->shelf.nodes, h->shelf.n_nodes);
  h->shelf.n_nodes = h->shelf.n_put = 0;
  if (p->ends_limb)
    g->limb_ends[g->n_limbs++] = conic_spool_bytes(&g->forest->nodes) / sizeof *p->nodes;
  return status;
}

/* Some parts at a time, so that memory does not grow with what waits to be collected. */
static conic_status grow_all(growing *g) {
  conic_status status = CONIC_OK;
  size_t n_hands = (size_t)g->growth->n_workers, n_now = 4 * n_hands;
  for (size_t first = 0; first < g->n_parts && status == CONIC_OK; first = g->end_part) {
    g->end_part = g->n_parts - first < n_now ? g->n_parts : first + n_now;
    atomic_store(&g->next_part, first);
    conic_parallel_for(g->plan->context, n_hands, grow_parts, g);
    for (size_t i = first; i < g->end_part && atomic_load(&g->is_stopped) && status == CONIC_OK; i++)
      status = g->parts[i].status;
    for (size_t i = first; i < g->end_part && status == CONIC_OK; i++)
      status = collect_part(g, &g->parts[i]);
  }
  return status == CONIC_OK ? conic_progress(g->plan->context, "build", 1.0) : status;
}

/* What all workers have counted goes to the first one's. */
static void add_up(growing *g) {
  for (int i = 0; i < g->growth->n_workers; i++)
    for (int k = 0; k < CONIC_LAYERS_MOST_ATTRIBUTES; k++)
      g->forest->part_bytes[k] += g->hands[i].shelf.part_bytes[k];
  for (int i = 1; i < g->growth->n_workers; i++)
    conic_layers_worker_add_outlines(g->hands[0].worker, conic_layers_worker_outlines(g->hands[i].worker));
}

/* The lower median of all samples' outlines. */
static double median_outline(const growing *g) {
  const uint64_t *outlines = conic_layers_worker_outlines(g->hands[0].worker);
  uint64_t before = 0;
  uint16_t code = 0;
  for (uint32_t i = 0; i < CONIC_LAYERS_OUTLINES && before <= (g->plan->n_samples - 1) / 2; i++) {
    code = (uint16_t)i;
    before += outlines[i];
  }
  return (double)conic_layers_size_of(code);
}

/* The limbs of all, and then the root's own cloud. */
static conic_status finish_tree(growing *g, conic_status status) {
  hand *h = &g->hands[0];
  if (g->shares->team)
    return conic_layers_crown_join(g->shares, status, h->worker, &h->shelf, &g->waiting, g->crown.branches, &g->crown.n,
                                   g->limb_ends, g->forest);
  if (status == CONIC_OK)
    status = conic_layers_finish_root(h->worker, g->crown.branches[0], &h->shelf);
  if (status == CONIC_OK)
    status = conic_layers_shelf_flush(&h->shelf);
  return status == CONIC_OK ? put_nodes(g, h->shelf.nodes, h->shelf.n_nodes) : status;
}

static conic_status create_hands(growing *g) {
  conic_context *context = g->plan->context;
  conic_status status = CONIC_OK;
  uint64_t most = 0;
  for (size_t i = 0; i < g->n_chunks; i++)
    if (!g->buckets->buckets[g->chunks[i].first].kept)
      most = g->chunks[i].n_samples > most ? g->chunks[i].n_samples : most;
  g->hands = conic_memory_allocate_zeroed(context, (size_t)g->growth->n_workers, sizeof *g->hands);
  if (!g->hands)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < g->growth->n_workers && status == CONIC_OK; i++) {
    hand *h = &g->hands[i];
    h->shelf = (conic_layers_shelf){.context = context, .clouds = &g->forest->clouds};
    status = conic_layers_worker_create(g->plan, &g->waiting, &h->worker);
    h->samples = conic_memory_allocate(context, (size_t)most, g->plan->sample_bytes);
    h->scratch = conic_memory_allocate(context, (size_t)most, g->plan->sample_bytes);
    if (g->growth->kept->key)
      h->outlines = conic_memory_allocate(context, CONIC_LAYERS_OUTLINES, sizeof *h->outlines);
    if (!h->samples || !h->scratch || (g->growth->kept->key && !h->outlines))
      status = CONIC_ERROR_MEMORY;
  }
  return status;
}

static void release_stack(conic_context *context, stack *s) {
  for (size_t i = 0; i < s->n; i++)
    conic_layers_branch_destroy(s->branches[i]);
  conic_memory_release(context, s->branches);
}

static void release_growing(growing *g) {
  conic_context *context = g->plan->context;
  for (size_t i = 0; i < g->n_parts; i++) {
    conic_layers_branch_destroy(g->parts[i].branch);
    conic_memory_release(context, g->parts[i].nodes);
  }
  for (int i = 0; i < g->growth->n_workers && g->hands; i++) {
    hand *h = &g->hands[i];
    release_stack(context, &h->waiting);
    conic_layers_worker_destroy(h->worker);
    conic_layers_shelf_release(&h->shelf);
    conic_memory_release(context, h->samples);
    conic_memory_release(context, h->scratch);
    conic_memory_release(context, h->outlines);
  }
  release_stack(context, &g->crown);
  conic_memory_release(context, g->hands);
  conic_memory_release(context, g->parts);
  conic_memory_release(context, g->chunks);
  conic_memory_release(context, g->limb_ends);
  conic_layers_waiting_end(&g->waiting);
}

/* Chunks and parts, of all buckets, limb by limb. */
static conic_status list_all_parts(growing *g) {
  const conic_layers_shares *shares = g->shares;
  const conic_layers_buckets *buckets = g->buckets;
  conic_status status = CONIC_OK;
  g->n_samples = samples_in_buckets(g, 0, buckets->n);
  uint64_t even = g->n_samples / (PARTS_A_THREAD * (uint64_t)g->growth->n_workers);
  g->most_in_part = even < MOST_IN_PART ? even : MOST_IN_PART;
  if (g->growth->kept->key || g->most_in_part < g->growth->most)
    g->most_in_part = g->growth->most;
  g->limb_ends = conic_memory_allocate(g->plan->context, shares->n_own, sizeof *g->limb_ends);
  if (!g->limb_ends)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0, first = 0, end = 0; i < shares->n_own && status == CONIC_OK; i++, first = end) {
    while (end < buckets->n && (i + 1 == shares->n_own || buckets->buckets[end].key < shares->own_keys[i + 1]))
      end++;
    status = list_parts(g, first, end);
    if (status == CONIC_OK)
      g->parts[g->n_parts - 1].ends_limb = 1;
  }
  return status;
}

conic_status conic_layers_forest_grow(const conic_layers_plan *plan, const conic_layers_buckets *buckets,
                                      const conic_layers_shares *shares, const conic_layers_growth *growth,
                                      conic_layers_forest *forest) {
  growing *g = conic_memory_allocate_zeroed(plan->context, 1, sizeof *g);
  memset(forest, 0, sizeof *forest);
  conic_status status = conic_team_agree(shares->team, g ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status != CONIC_OK) {
    conic_memory_release(plan->context, g);
    return status;
  }
  *g = (growing){.plan = plan, .buckets = buckets, .shares = shares, .growth = growth, .forest = forest};
  conic_spool_begin(plan->context, buckets->spool.path, growth->node_bytes, &forest->nodes);
  status = conic_pile_begin(plan->context, buckets->spool.path, &forest->clouds);
  if (status == CONIC_OK)
    status = conic_layers_waiting_begin(plan, buckets->spool.path, growth->waiting_bytes, &g->waiting);
  if (status == CONIC_OK)
    status = list_all_parts(g);
  if (status == CONIC_OK)
    status = create_hands(g);
  status = conic_team_agree(shares->team, status);
  if (status == CONIC_OK) {
    conic_moment start = conic_moment_now();
    status = grow_all(g);
    start = conic_team_note(shares->team, "grow", start, g->n_samples);
    status = finish_tree(g, status);
    add_up(g);
    if (status == CONIC_OK)
      status = conic_layers_crown_add_up(shares->team, g->hands[0].worker, forest);
    conic_team_note(shares->team, "crown", start, shares->n_limbs);
  }
  if (status == CONIC_OK)
    forest->outline = median_outline(g);
  release_growing(g);
  conic_memory_release(plan->context, g);
  return status;
}
