/* The adaptive models of LASzip's arithmetic coding, and their memory.
 *
 * The coding is Said's (Introduction to Arithmetic Coding, HPL-2004-76): a model counts symbols and takes its
 * probabilities, of 15 bits, from the counts every now and then. A model begins when it is first used, so that unused
 * models cost nothing. */
#pragma once

#include "core/base/base.h"

enum { CONIC_LAZ_PROBABILITY_BITS = 15, CONIC_LAZ_BIT_PROBABILITY_BITS = 13, CONIC_LAZ_SMALL_MODEL = 16 };

/* Memory in blocks, released all at once. */
typedef struct conic_laz_arena {
  conic_context *context;
  unsigned char **blocks;
  size_t n_blocks, room; /* existing blocks, and the room of their list */
  size_t i_block, used;  /* the block that is being filled, and how far */
  int is_out;            /* memory ran out */
} conic_laz_arena;

void conic_laz_arena_rewind(conic_laz_arena *arena);
void conic_laz_arena_release(conic_laz_arena *arena);

/* Takes n numbers of 16 bits, undefined, at most CONIC_LAZ_ARENA_MOST; null where there is no memory. */
enum { CONIC_LAZ_ARENA_MOST = 4096 };

/* A model of n symbols, 2 to 1024. All zero: not begun. */
typedef struct conic_laz_model {
  uint16_t *bound; /* n + 1: the sum of the probabilities before each symbol, and one last bound above all */
  uint16_t *count; /* n */
  uint8_t *table;  /* for more than CONIC_LAZ_SMALL_MODEL symbols: where to start searching in `bound`; halved for more
                      than 256 */
  uint32_t n, total, cycle, until_update;
} conic_laz_model;

/* The bits of probability between two places of the table: so few that hardly any bound lies between. */
static inline unsigned conic_laz_table_shift(unsigned n) {
  return n <= 64 ? 6 : 5;
}

/* Begins with equal probabilities; returns 0 where there is no memory. */
int conic_laz_model_begin(conic_laz_model *model, conic_laz_arena *arena, unsigned n);

/* To be called when `until_update` is 0. */
void conic_laz_model_update(conic_laz_model *model);

/* A model of two symbols. All zero: not begun. */
typedef struct conic_laz_bit_model {
  uint32_t zeros, total, probability, cycle, until_update;
} conic_laz_bit_model;

void conic_laz_bit_model_begin(conic_laz_bit_model *model);
void conic_laz_bit_model_update(conic_laz_bit_model *model);
