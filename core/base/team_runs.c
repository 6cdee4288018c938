#include "core/base/team_runs.h"

#include "core/base/base.h"
#include "core/base/context_struct.h"

/* Each process gets so many blocks of items, spread over the whole loop, because neighbouring items take about the same
 * time. So many bytes of their values are exchanged at a time. */
enum { BLOCKS_A_PROCESS = 32, EXCHANGED_BYTES = 64 << 20 };

const conic_team *conic_context_join(conic_context *context, const conic_team *team) {
  const conic_team *before = context->team;
  context->team = team && team->count > 1 ? team : NULL;
  return before;
}

conic_status conic_context_part(conic_context *context, conic_status status) {
  return conic_team_agree(conic_context_join(context, NULL), status);
}

/* After any process failed, none calls collective functions any more. */
static conic_status agree_on(conic_context *context, conic_status status) {
  status = conic_team_agree(context->team, status);
  if (status != CONIC_OK)
    conic_context_join(context, NULL);
  return status;
}

/* Process i % count does block i. */
typedef struct team_blocks {
  const conic_team *team;
  const conic_team_loop *loop;
  size_t block_items, n_blocks;
} team_blocks;

static size_t lesser_count(size_t a, size_t b) {
  return a < b ? a : b;
}

static size_t block_begin(const team_blocks *blocks, size_t i_block) {
  return lesser_count(i_block * blocks->block_items, blocks->loop->n_items);
}

static team_blocks divide_loop(const conic_team *team, const conic_team_loop *loop) {
  size_t n_wanted = (size_t)team->count * BLOCKS_A_PROCESS;
  team_blocks blocks = {team, loop, (loop->n_items + n_wanted - 1) / n_wanted, 0};
  blocks.block_items += blocks.block_items == 0;
  blocks.n_blocks = (loop->n_items + blocks.block_items - 1) / blocks.block_items;
  return blocks;
}

/* --- the work --- */

static void do_own_item(void *data, size_t i_item, int i_thread) {
  const team_blocks *blocks = data;
  size_t row = i_item / blocks->block_items, i_block = row * (size_t)blocks->team->count + (size_t)blocks->team->index;
  conic_task_do(blocks->loop->task, blocks->loop->data, block_begin(blocks, i_block) + i_item % blocks->block_items,
                i_thread);
}

static size_t count_own_items(const team_blocks *blocks) {
  size_t n = 0;
  for (size_t i = (size_t)blocks->team->index; i < blocks->n_blocks; i += (size_t)blocks->team->count)
    n += block_begin(blocks, i + 1) - block_begin(blocks, i);
  return n;
}

/* --- the exchange --- */

static size_t first_value(const team_blocks *blocks, size_t i_block) {
  const conic_team_loop *loop = blocks->loop;
  size_t i_item = block_begin(blocks, i_block);
  return loop->first_of ? loop->first_of(loop->data, i_item) : lesser_count(i_item * loop->n_an_item, loop->n_values);
}

static void copy_column(const conic_team_column *column, size_t begin, size_t n, char *bytes, int is_back) {
  size_t n_bytes = column->value_bytes;
  for (size_t i = 0, n_run = column->places ? 1 : n; i < n; i += n_run) {
    char *value = (char *)column->values + (column->places ? column->places[begin + i] : begin + i) * n_bytes;
    memcpy(is_back ? value : bytes + i * n_bytes, is_back ? bytes + i * n_bytes : value, n_run * n_bytes);
  }
}

/* Copies a block's values out of the columns, or back into them, unless `bytes` is null; returns their size. */
static size_t copy_block_values(const team_blocks *blocks, size_t i_block, char *bytes, int is_back) {
  const conic_team_loop *loop = blocks->loop;
  size_t n_bytes = 0;
  for (int i = 0; i < CONIC_TEAM_COLUMNS; i++) {
    const conic_team_column *column = &loop->columns[i];
    if (!column->values)
      continue;
    size_t begin = column->is_by_item ? block_begin(blocks, i_block) : first_value(blocks, i_block);
    size_t n = (column->is_by_item ? block_begin(blocks, i_block + 1) : first_value(blocks, i_block + 1)) - begin;
    if (bytes)
      copy_column(column, begin, n, bytes + n_bytes, is_back);
    n_bytes += n * column->value_bytes;
  }
  return n_bytes;
}

/* Copies the blocks of one process from `first` to before `end`. */
static size_t copy_blocks(const team_blocks *blocks, size_t first, size_t end, int index, char *bytes, int is_back) {
  size_t n_bytes = 0;
  for (size_t i = first + (size_t)index; i < end; i += (size_t)blocks->team->count)
    n_bytes += copy_block_values(blocks, i, bytes ? bytes + n_bytes : NULL, is_back);
  return n_bytes;
}

/* Where the blocks end that are exchanged together, from `first` on, which is process 0's. */
static size_t end_of_round(const team_blocks *blocks, size_t first) {
  size_t n_bytes = 0, end = first, count = (size_t)blocks->team->count;
  while (end < blocks->n_blocks && n_bytes < EXCHANGED_BYTES) {
    for (size_t i = end; i < lesser_count(end + count, blocks->n_blocks); i++)
      n_bytes += copy_block_values(blocks, i, NULL, 0);
    end += count;
  }
  return lesser_count(end, blocks->n_blocks);
}

/* The most bytes that this process sends at a time. */
static size_t most_own_bytes(const team_blocks *blocks) {
  size_t most = 0;
  for (size_t first = 0, end; first < blocks->n_blocks; first = end) {
    end = end_of_round(blocks, first);
    size_t n_bytes = copy_blocks(blocks, first, end, blocks->team->index, NULL, 0);
    most = n_bytes > most ? n_bytes : most;
  }
  return most;
}

static void exchange_values(const team_blocks *blocks, char *own) {
  const conic_team *team = blocks->team;
  size_t sizes[CONIC_MOST_IN_TEAM];
  for (size_t first = 0, end; first < blocks->n_blocks; first = end) {
    end = end_of_round(blocks, first);
    size_t n_own = copy_blocks(blocks, first, end, team->index, own, 0), at = 0;
    char *all = team->collect(team->data, own, n_own, sizes);
    for (int i = 0; i < team->count; at += sizes[i++])
      if (i != team->index)
        copy_blocks(blocks, first, end, i, all + at, 1);
    team->release(team->data, all);
  }
}

static conic_status do_loop(conic_context *context, const conic_team_loop *loop, size_t n_items, conic_task task,
                            void *data) {
  return loop->n_a_run
             ? conic_parallel_runs(context, loop->name, loop->from, loop->to, n_items, loop->n_a_run, task, data)
             : conic_parallel_told(context, loop->name, loop->from, loop->to, n_items, task, data);
}

conic_status conic_team_runs(conic_context *context, const conic_team_loop *loop) {
  const conic_team *team = context->team;
  if (!team)
    return do_loop(context, loop, loop->n_items, loop->task, loop->data);
  team_blocks blocks = divide_loop(team, loop);
  conic_moment start = conic_moment_now();
  char *own = NULL;
  conic_status status = agree_on(context, CONIC_OK);
  if (status != CONIC_OK)
    return status;
  status = do_loop(context, loop, count_own_items(&blocks), CONIC_TASK(do_own_item), &blocks);
  if (status == CONIC_OK && !(own = conic_memory_allocate(context, most_own_bytes(&blocks), 1)))
    status = CONIC_ERROR_MEMORY;
  status = agree_on(context, status);
  if (status == CONIC_OK)
    exchange_values(&blocks, own);
  conic_team_note(team, loop->name, start, loop->n_items);
  conic_memory_release(context, own);
  return status;
}

conic_status conic_team_total(conic_context *context, size_t *count) {
  size_t all[CONIC_MOST_IN_TEAM], total = 0;
  const conic_team *team = context->team;
  if (!team)
    return CONIC_OK;
  conic_status status = agree_on(context, CONIC_OK);
  if (status != CONIC_OK)
    return status;
  conic_team_collect(team, count, sizeof *count, all);
  for (int i = 0; i < team->count; i++)
    total += all[i];
  *count = total;
  return CONIC_OK;
}
