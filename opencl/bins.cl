/* From projected splats to the tiles' lists, in file order throughout: prefix sums, and chunks that each count and fill
 * their own part of every list. */
#include "opencl/shared.h"

#include "opencl/layout.h"
#include "raster/project/projected.h"

/* Exclusive prefix sums in three steps: of each item's numbers, of those sums, and places within. */
__kernel void scan_sums(uint n, __global const uint *numbers, __global ulong *sums) {
  uint begin = (uint)get_global_id(0) * CONIC_SCAN_NUMBERS;
  ulong sum = 0;
  if (begin >= n)
    return;
  for (uint i = begin; i < n && i < begin + CONIC_SCAN_NUMBERS; i++)
    sum += numbers[i];
  sums[get_global_id(0)] = sum;
}

__kernel void scan_tops(uint n_sums, __global ulong *sums) {
  ulong total = 0;
  for (uint i = 0; i < n_sums; i++) {
    ulong sum = sums[i];
    sums[i] = total;
    total += sum;
  }
}

/* places[n] is the total. */
__kernel void scan_places(uint n, __global const uint *numbers, __global const ulong *sums, __global ulong *places) {
  uint begin = (uint)get_global_id(0) * CONIC_SCAN_NUMBERS;
  if (begin >= n)
    return;
  ulong place = sums[get_global_id(0)];
  for (uint i = begin; i < n && i < begin + CONIC_SCAN_NUMBERS; i++) {
    places[i] = place;
    place += numbers[i];
  }
  if (n - begin <= CONIC_SCAN_NUMBERS)
    places[n] = place;
}

/* The drawn splats' records, one after the other in file order, by where they are. */
__kernel void compact(uint n_items, uint splats_per_item, __global const uint *n_drawn, __global const ulong *places,
                      __global uint *order) {
  uint item = (uint)get_global_id(0);
  if (item >= n_items)
    return;
  uint n = n_drawn[item];
  __global uint *to = order + places[item];
  for (uint i = 0; i < n; i++)
    to[i] = item * splats_per_item + i;
}

/* The tiles that a box touches. */
typedef struct tile_range {
  int x_begin, x_end, y_begin, y_end;
} tile_range;

static tile_range tiles_of(const conic_box *box) {
  int shift = CONIC_DEVICE_TILE_BITS;
  tile_range range = {box->x_begin >> shift, ((box->x_end - 1) >> shift) + 1, box->y_begin >> shift,
                      ((box->y_end - 1) >> shift) + 1};
  return range;
}

/* counts is [chunk][tile]. */
__kernel void count_tiles(uint n_chunks, uint n_tiles, uint n_tiles_x, uint n, uint chunk_size,
                          __global const uint *order, __global const conic_box *boxes, __global uint *counts) {
  uint chunk = (uint)get_global_id(0), begin = chunk * chunk_size;
  if (chunk >= n_chunks)
    return;
  uint end = begin < n ? n - begin < chunk_size ? n : begin + chunk_size : begin;
  __global uint *own = counts + (ulong)chunk * n_tiles;
  for (uint i = 0; i < n_tiles; i++)
    own[i] = 0;
  for (uint i = begin; i < end; i++) {
    conic_box box = boxes[order[i]];
    tile_range range = tiles_of(&box);
    for (int y = range.y_begin; y < range.y_end; y++)
      for (int x = range.x_begin; x < range.x_end; x++)
        own[(uint)y * n_tiles_x + (uint)x]++;
  }
}

/* Counts become places within their tile's list; totals are the lists' lengths. */
__kernel void place_chunks(uint n_tiles, uint n_chunks, __global uint *counts, __global uint *totals) {
  uint tile = (uint)get_global_id(0), in_tile = 0;
  if (tile >= n_tiles)
    return;
  for (uint chunk = 0; chunk < n_chunks; chunk++) {
    __global uint *count = counts + (ulong)chunk * n_tiles + tile;
    uint of_chunk = *count;
    *count = in_tile;
    in_tile += of_chunk;
  }
  totals[tile] = in_tile;
}

/* The blocks of a tile, along one axis, that the pixels begin … end - 1 meet: the first, and 16 times the last. */
static uint blocks_met(int begin, int end, int tile_begin) {
  int first = begin > tile_begin ? begin - tile_begin : 0;
  int last = end - 1 < tile_begin + CONIC_DEVICE_TILE - 1 ? end - 1 - tile_begin : CONIC_DEVICE_TILE - 1;
  return (uint)(first / 4) | (uint)(last / 4) << 4;
}

__kernel void fill_tiles(uint n_chunks, uint n_tiles, uint n_tiles_x, uint n, uint chunk_size,
                         __global const uint *order, __global const conic_box *boxes, __global uint *counts,
                         __global const ulong *tile_begin, __global conic_device_reference *references) {
  uint chunk = (uint)get_global_id(0), begin = chunk * chunk_size;
  if (chunk >= n_chunks)
    return;
  uint end = begin < n ? n - begin < chunk_size ? n : begin + chunk_size : begin;
  __global uint *next = counts + (ulong)chunk * n_tiles;
  for (uint i = begin; i < end; i++) {
    conic_box box = boxes[order[i]];
    tile_range range = tiles_of(&box);
    for (int y = range.y_begin; y < range.y_end; y++)
      for (int x = range.x_begin; x < range.x_end; x++) {
        uint tile = (uint)y * n_tiles_x + (uint)x;
        conic_device_reference reference = {order[i],
                                            blocks_met(box.x_begin, box.x_end, x << CONIC_DEVICE_TILE_BITS) |
                                                blocks_met(box.y_begin, box.y_end, y << CONIC_DEVICE_TILE_BITS) << 8};
        references[tile_begin[tile] + next[tile]++] = reference;
      }
  }
}
