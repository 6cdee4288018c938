#include "core/laz/laz_models.h"

enum { BLOCK_NUMBERS = 1 << 15, MOST_TOTAL = 1 << 15, MOST_BITS = 1 << 13 };

void conic_laz_arena_rewind(conic_laz_arena *arena) {
  arena->i_block = arena->used = 0;
  arena->is_out = 0;
}

void conic_laz_arena_release(conic_laz_arena *arena) {
  for (size_t i = 0; i < arena->n_blocks; i++)
    conic_memory_release(arena->context, arena->blocks[i]);
  conic_memory_release(arena->context, arena->blocks);
  arena->blocks = NULL;
  arena->n_blocks = arena->room = 0;
}

static int add_block(conic_laz_arena *arena) {
  unsigned char *block = conic_memory_allocate(arena->context, BLOCK_NUMBERS, sizeof(uint16_t));
  arena->is_out |= !block || conic_memory_append(arena->context, &arena->blocks, &arena->n_blocks, &arena->room, &block,
                                                 sizeof block) != CONIC_OK;
  if (arena->is_out)
    conic_memory_release(arena->context, block);
  return !arena->is_out;
}

static uint16_t *laz_arena_take(conic_laz_arena *arena, size_t n) {
  if (arena->is_out)
    return NULL;
  if (n > BLOCK_NUMBERS - arena->used) {
    arena->i_block++;
    arena->used = 0;
  }
  if (arena->i_block >= arena->n_blocks && !add_block(arena))
    return NULL;
  uint16_t *numbers = (uint16_t *)(void *)arena->blocks[arena->i_block] + arena->used;
  arena->used += n;
  return numbers;
}

/* The last places are for quotients that the remainder of a length makes larger than all probabilities. */
static size_t count_places(unsigned n) {
  return n > CONIC_LAZ_SMALL_MODEL ? (1u << CONIC_LAZ_PROBABILITY_BITS >> conic_laz_table_shift(n)) + 2 : 0;
}

int conic_laz_model_begin(conic_laz_model *model, conic_laz_arena *arena, unsigned n) {
  size_t n_places = count_places(n);
  uint16_t *numbers = laz_arena_take(arena, 2 * (size_t)n + 1 + n_places / 2);
  if (!numbers)
    return 0;
  *model = (conic_laz_model){.bound = numbers,
                             .count = numbers + n + 1,
                             .table = n_places ? (uint8_t *)(numbers + 2 * (size_t)n + 1) : NULL,
                             .n = n,
                             .cycle = n};
  for (unsigned i = 0; i < n; i++)
    model->count[i] = 1;
  conic_laz_model_update(model);
  model->cycle = model->until_update = (n + 6) >> 1;
  return 1;
}

/* Halves the counts, so that old symbols matter less. */
static void halve_counts(conic_laz_model *model) {
  model->total = 0;
  for (unsigned i = 0; i < model->n; i++) {
    model->count[i] = (uint16_t)((model->count[i] + 1u) >> 1);
    model->total += model->count[i];
  }
}

/* Each place gets the last symbol whose bound is not above the place's beginning. */
static void fill_model_table(conic_laz_model *model) {
  unsigned shift = conic_laz_table_shift(model->n), below = (1u << shift) - 1, half = model->n > 256;
  size_t i_place = 0;
  for (unsigned i = 1; i < model->n; i++) {
    size_t end = (model->bound[i] + below) >> shift;
    memset(model->table + i_place, (int)((i - 1) >> half), end - i_place);
    i_place = end;
  }
  memset(model->table + i_place, (int)((model->n - 1) >> half), count_places(model->n) - i_place);
}

void conic_laz_model_update(conic_laz_model *model) {
  uint32_t sum = 0, longest = (model->n + 6) << 3;
  model->total += model->cycle;
  if (model->total > MOST_TOTAL)
    halve_counts(model);
  uint32_t scale = 0x80000000u / model->total; /* NOLINT(clang-analyzer-core.DivideZero): each counts 1 at least */
  for (unsigned i = 0; i < model->n; i++) {
    model->bound[i] = (uint16_t)(scale * sum >> (31 - CONIC_LAZ_PROBABILITY_BITS));
    sum += model->count[i];
  }
  model->bound[model->n] = UINT16_MAX;
  if (model->table)
    fill_model_table(model);
  model->cycle = 5 * model->cycle >> 2;
  model->cycle = model->cycle < longest ? model->cycle : longest;
  model->until_update = model->cycle;
}

void conic_laz_bit_model_begin(conic_laz_bit_model *model) {
  *model = (conic_laz_bit_model){1, 2, 1u << (CONIC_LAZ_BIT_PROBABILITY_BITS - 1), 4, 4};
}

void conic_laz_bit_model_update(conic_laz_bit_model *model) {
  model->total += model->cycle;
  if (model->total > MOST_BITS) {
    model->total = (model->total + 1) >> 1;
    model->zeros = (model->zeros + 1) >> 1;
    model->total += model->zeros == model->total;
  }
  model->probability = model->zeros * (0x80000000u / model->total) >> (31 - CONIC_LAZ_BIT_PROBABILITY_BITS);
  model->cycle = 5 * model->cycle >> 2;
  model->cycle = model->cycle < 64 ? model->cycle : 64;
  model->until_update = model->cycle;
}
