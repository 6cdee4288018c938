/* Where a tile is a work-item: its blocks of 16 pixels, each a vector, and what they add up. */

#include "opencl/lanes_words.cl"

/* The columns and rows of the pixels of the block whose first is at (x, y). */
static lanes columns_from(int x) {
  return (float)x + lanes_of_ints(lanes_columns());
}

static lanes rows_from(int y) {
  return (float)y + lanes_of_ints(lanes_rows());
}

/* The directions of a block's pixels. */
static void lanes_directions(__global const float *columns, __global const float *rows, int x, int y, lanes *dx,
                             lanes *dy) {
  float4 of_columns = vload4(0, columns + x), of_rows = vload4(0, rows + y); /* there are some of all whole tiles */
  *dx = (lanes)(of_columns.xxxx, of_columns.yyyy, of_columns.zzzz, of_columns.wwww);
  *dy = (lanes)(of_rows, of_rows, of_rows, of_rows);
}

#define CONIC_DEVICE_TILE_BLOCKS (CONIC_DEVICE_TILE / 4)
#define N_TILE_BLOCKS (CONIC_DEVICE_TILE_BLOCKS * CONIC_DEVICE_TILE_BLOCKS)

typedef struct lanes_tile {
  uint index;
  int x, y; /* its first pixel */
  uint first_block;
  int width, height;
} lanes_tile;

static lanes_tile lanes_tile_of(const conic_device_frame *frame) {
  lanes_tile t;
  t.index = (uint)get_global_id(0);
  t.x = (int)(t.index % (uint)frame->n_tiles_x) * CONIC_DEVICE_TILE;
  t.y = (int)(t.index / (uint)frame->n_tiles_x) * CONIC_DEVICE_TILE;
  t.first_block = (uint)(t.y / 4) * (uint)frame->n_blocks_x + (uint)(t.x / 4);
  t.width = frame->width;
  t.height = frame->height;
  return t;
}

/* Where block (column, row) of the tile lies in memory that is [block] of the whole image. */
static ulong lanes_block(const lanes_tile *t, const conic_device_frame *frame, uint block) {
  return t->first_block + (ulong)(block / CONIC_DEVICE_TILE_BLOCKS) * (ulong)frame->n_blocks_x +
         block % CONIC_DEVICE_TILE_BLOCKS;
}

/* Its first pixel. */
static int lanes_block_x(const lanes_tile *t, uint block) {
  return t->x + 4 * (int)(block % CONIC_DEVICE_TILE_BLOCKS);
}

static int lanes_block_y(const lanes_tile *t, uint block) {
  return t->y + 4 * (int)(block / CONIC_DEVICE_TILE_BLOCKS);
}

static uint sum_of_lanes(index_lanes values) {
  uint8 a = values.lo + values.hi;
  uint4 b = a.lo + a.hi;
  uint2 c = b.lo + b.hi;
  return c.x + c.y;
}

/* The sums of a block, by CONIC_SUM_WEIGHT …; and whose fragment was the heaviest or nearest of this part. */
typedef struct lanes_sums {
  lanes values[CONIC_N_SUMS];
  int16 taken; /* -1: none */
} lanes_sums;

/* The mean of a block's normals, and its length. */
static lanes lanes_mean_normal(const lanes_sums *s, lanes mean[3]) {
  lanes part = 1.0f / s->values[CONIC_SUM_WEIGHT];
  for (int axis = 0; axis < 3; axis++)
    mean[axis] = s->values[CONIC_SUM_NORMAL + axis] * part;
  return sqrt((mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2]);
}
