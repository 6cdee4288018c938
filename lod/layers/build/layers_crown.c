#include "lod/layers/build/layers_crown.h"

#include <string.h>

#include "core/base/memory.h"
#include "lod/layers/build/layers_parcel.h"
#include "lod/layers/build/layers_waiting.h"

/* Nodes that are sent at a time. */
enum { NODES_A_PARCEL = 1024 };

/* A branch that waits to be joined, and whose it is; null in others' processes, and of one who has failed. */
typedef struct crown_branch {
  int rank;
  conic_layers_branch *branch;
} crown_branch;

typedef struct crown {
  const conic_layers_shares *shares;
  const conic_team *team;
  conic_layers_worker *worker;
  conic_layers_shelf *shelf; /* of it the nodes that are packed here, in their order */
  conic_layers_waiting *waiting;
  size_t n;
  crown_branch *stack; /* everybody has the same but for the branches */
  conic_status status;
} crown;

static void fail_crown(crown *c, conic_status status) {
  if (c->status == CONIC_OK)
    c->status = status;
}

/* Sends the last but what is joined here: nothing where there has been a failure, which then is the receiver's too. */
static void send_branch(crown *c, int to, conic_layers_branch *branch) {
  unsigned char *bytes = NULL;
  size_t n_bytes = 0;
  if (branch)
    fail_crown(c, conic_layers_parcel_pack(branch, &bytes, &n_bytes));
  c->team->send(c->team->data, to, bytes, c->status == CONIC_OK ? n_bytes : 0);
  conic_memory_release(c->shares->context, bytes);
  conic_layers_branch_destroy(branch);
}

static conic_layers_branch *receive_branch(crown *c, int from) {
  conic_layers_branch *branch = NULL;
  size_t n_bytes;
  void *bytes = c->team->receive(c->team->data, from, &n_bytes);
  if (n_bytes == 0)
    fail_crown(c, CONIC_ERROR_CANCELLED);
  else
    fail_crown(c, conic_layers_parcel_unpack(c->waiting, bytes, n_bytes, &branch));
  c->team->release(c->team->data, bytes);
  return branch;
}

static conic_status put_own_away(crown *c) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < c->n && status == CONIC_OK; i++)
    if (c->stack[i].branch)
      status = conic_layers_put_away(&c->stack[i].branch, 1);
  return status;
}

/* The last two become one, with the first one's owner. */
static void join_last(crown *c) {
  crown_branch *first = &c->stack[c->n - 2], *second = &c->stack[c->n - 1];
  int own = c->team->index;
  c->n--;
  if (first->rank != own) {
    if (second->rank == own)
      send_branch(c, first->rank, second->branch);
    return;
  }
  conic_layers_branch *joined = NULL;
  conic_layers_branch *children[2] = {first->branch,
                                      second->rank == own ? second->branch : receive_branch(c, second->rank)};
  if (c->status == CONIC_OK)
    fail_crown(c, conic_layers_join(c->worker, children, 1, c->shelf, &joined));
  else
    for (int i = 0; i < 2; i++)
      conic_layers_branch_destroy(children[i]);
  first->branch = joined;
  if (c->status == CONIC_OK)
    fail_crown(c, put_own_away(c));
}

/* Everybody goes through all of it in the same order, and does what is its own: so nobody waits in a circle. */
static void join_all(crown *c, conic_layers_branch **limbs, size_t *n_own) {
  size_t n_taken = 0;
  for (size_t i = 0; i < c->shares->n_limbs; i++) {
    const conic_layers_limb *limb = &c->shares->limbs[i];
    int is_own = limb->rank == c->team->index && n_taken < *n_own;
    c->stack[c->n++] = (crown_branch){limb->rank, is_own ? limbs[n_taken++] : NULL};
    for (unsigned k = 0; k < limb->n_joins; k++)
      join_last(c);
  }
  *n_own = 0;
  if (c->stack[0].branch && c->status == CONIC_OK)
    fail_crown(c, conic_layers_finish_root(c->worker, c->stack[0].branch, c->shelf));
  conic_layers_branch_destroy(c->stack[0].branch);
  if (c->status == CONIC_OK)
    fail_crown(c, conic_layers_shelf_flush(c->shelf));
}

/* Of one of the processes' nodes the next: of its limbs, or of what it has joined. */
typedef struct node_run {
  const conic_layers_forest *forest; /* null: of the shelf */
  uint64_t at;
} node_run;

static conic_status read_nodes(const crown *c, const node_run *run, conic_layers_entry *nodes, size_t n) {
  if (run->forest)
    return conic_spool_read(&run->forest->nodes, run->at * sizeof *nodes, nodes, n * sizeof *nodes);
  memcpy(nodes, c->shelf->nodes + run->at, n * sizeof *nodes);
  return CONIC_OK;
}

/* Moves some of a process's nodes to the first one's list. A failure leaves them as they are, and is told at the end.
 */
static void pass_nodes(crown *c, int from, node_run *run, uint64_t n, conic_layers_entry *some, conic_spool *all) {
  int own = c->team->index;
  for (uint64_t left = n; left > 0 && (own == from || own == 0);) {
    size_t n_now = left < NODES_A_PARCEL ? (size_t)left : NODES_A_PARCEL, n_bytes = n_now * sizeof *some;
    if (own == from) {
      fail_crown(c, read_nodes(c, run, some, n_now));
      run->at += n_now;
      if (from != 0)
        c->team->send(c->team->data, 0, some, n_bytes);
    } else {
      void *received = c->team->receive(c->team->data, from, &n_bytes);
      memcpy(some, received, n_bytes);
      c->team->release(c->team->data, received);
    }
    for (size_t i = 0; i < n_now && own == 0; i++)
      some[i].offset |= (uint64_t)from << CONIC_LAYERS_RANK_SHIFT;
    if (own == 0)
      fail_crown(c, conic_spool_append(all, some, n_bytes));
    left -= n_now;
  }
}

/* How many nodes each limb has, in the order of all limbs. */
static conic_status tell_limb_sizes(const crown *c, const uint64_t *limb_ends, uint64_t *sizes) {
  const conic_layers_shares *shares = c->shares;
  size_t n = shares->n_limbs, n_own = 0;
  uint64_t *all = conic_memory_allocate(shares->context, (size_t)c->team->count * n, sizeof *all);
  conic_status status = conic_team_agree(c->team, all ? CONIC_OK : CONIC_ERROR_MEMORY);
  memset(sizes, 0, n * sizeof *sizes);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    if (shares->limbs[i].rank == c->team->index) {
      sizes[i] = limb_ends[n_own] - (n_own ? limb_ends[n_own - 1] : 0);
      n_own++;
    }
  if (status == CONIC_OK)
    conic_team_collect(c->team, sizes, n * sizeof *sizes, all);
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    sizes[i] = all[(size_t)shares->limbs[i].rank * n + i];
  conic_memory_release(shares->context, all);
  return status;
}

/* In the order of one shelf: what is below a pair comes before it. */
static void collect_nodes(crown *c, const uint64_t *limb_sizes, const conic_layers_forest *forest,
                          conic_layers_entry *some, conic_spool *all) {
  node_run own = {forest, 0}, joined = {NULL, 0};
  c->n = 0;
  for (size_t i = 0; i < c->shares->n_limbs; i++) {
    const conic_layers_limb *limb = &c->shares->limbs[i];
    pass_nodes(c, limb->rank, &own, limb_sizes[i], some, all);
    c->stack[c->n++].rank = limb->rank;
    for (unsigned k = 0; k < limb->n_joins; k++)
      pass_nodes(c, c->stack[--c->n - 1].rank, &joined, 2, some, all);
  }
  pass_nodes(c, c->stack[0].rank, &joined, 1, some, all);
}

static conic_status collect_all(crown *c, const uint64_t *limb_ends, conic_layers_forest *forest) {
  conic_context *context = c->shares->context;
  uint64_t *sizes = conic_memory_allocate(context, c->shares->n_limbs, sizeof *sizes);
  conic_layers_entry *some = conic_memory_allocate(context, NODES_A_PARCEL, sizeof *some);
  conic_spool all;
  conic_spool_begin(context, forest->nodes.path, forest->nodes.most_held, &all);
  c->status = conic_team_agree(c->team, sizes && some ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (c->status == CONIC_OK)
    c->status = tell_limb_sizes(c, limb_ends, sizes);
  if (c->status == CONIC_OK) {
    collect_nodes(c, sizes, forest, some, &all);
    conic_spool_end(&forest->nodes);
    forest->nodes = all;
    c->status = conic_team_agree(c->team, c->status);
  }
  conic_memory_release(context, sizes);
  conic_memory_release(context, some);
  return c->status;
}

conic_status conic_layers_crown_join(const conic_layers_shares *shares, conic_status status,
                                     conic_layers_worker *worker, conic_layers_shelf *shelf,
                                     struct conic_layers_waiting *waiting, conic_layers_branch **limbs, size_t *n,
                                     const uint64_t *limb_ends, conic_layers_forest *forest) {
  crown c = {.shares = shares, .team = shares->team, .worker = worker, .shelf = shelf, .waiting = waiting};
  c.stack = conic_memory_allocate_zeroed(shares->context, shares->n_limbs + 1, sizeof *c.stack);
  if (!c.stack && status == CONIC_OK)
    status = CONIC_ERROR_MEMORY;
  status = conic_team_agree(c.team, status);
  if (status == CONIC_OK) {
    join_all(&c, limbs, n);
    status = conic_team_agree(c.team, c.status);
  }
  if (status == CONIC_OK)
    status = collect_all(&c, limb_ends, forest);
  conic_memory_release(shares->context, c.stack);
  return status;
}

conic_status conic_layers_crown_add_up(const conic_team *team, conic_layers_worker *worker,
                                       conic_layers_forest *forest) {
  size_t n_bytes = CONIC_LAYERS_OUTLINES * sizeof(uint64_t), n_received;
  if (!team)
    return CONIC_OK;
  if (team->index > 0) {
    team->send(team->data, 0, conic_layers_worker_outlines(worker), n_bytes);
    team->send(team->data, 0, forest->part_bytes, sizeof forest->part_bytes);
    return CONIC_OK;
  }
  for (int from = 1; from < team->count; from++) {
    uint64_t *outlines = team->receive(team->data, from, &n_received);
    conic_layers_worker_add_outlines(worker, outlines);
    team->release(team->data, outlines);
    uint64_t *bytes = team->receive(team->data, from, &n_received);
    for (int k = 0; k < CONIC_LAYERS_MOST_ATTRIBUTES; k++)
      forest->part_bytes[k] += bytes[k];
    team->release(team->data, bytes);
  }
  return CONIC_OK;
}
