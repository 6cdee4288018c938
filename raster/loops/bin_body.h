/* Keys, the sorting of records and the selection of a band's in lanes. Included by raster_loops_body.h. */
#include "core/lanes/lanes_store.h"
#include "raster/tiles/bins.h"

/* conic_key_of. */
CONIC_INLINE void keys_in(const conic_box *boxes, size_t n, int tile_bits, int n_tiles_x, int by_pixels,
                          uint32_t *tiles, uint32_t *words, uint32_t *beyond) {
  const uint32_t in_tile = (1u << tile_bits) - 1;
  const int unit_bits = by_pixels ? 0 : 2;
  const index_lanes zero = lanes_of_index(0), last_unit = lanes_of_index(in_tile >> unit_bits);
  size_t i = 0;
  for (; i + CONIC_LANES <= n; i += CONIC_LANES) {
    index_lanes columns, rows;
    lanes_load_pairs((const uint32_t *)(const void *)&boxes[i], &columns, &rows);
    index_lanes x_begin = columns & 0xffff, x_last = (columns >> 16) - 1;
    index_lanes y_begin = rows & 0xffff, y_last = (rows >> 16) - 1;
    index_lanes n_x = (x_last >> tile_bits) - (x_begin >> tile_bits);
    index_lanes n_y = (y_last >> tile_bits) - (y_begin >> tile_bits);
    index_lanes column = (x_last & in_tile) >> unit_bits, row = (y_last & in_tile) >> unit_bits;
    lanes_mask is_wide = lanes_has_bits(n_x, ~0u), is_high = lanes_has_bits(n_y, ~0u);
    lanes_mask has_more = lanes_has_bits(n_x >> 1 | n_y >> 1, ~0u);
    index_lanes first_row = (y_begin & in_tile) >> unit_bits, last_row = lanes_select_indices(is_high, last_unit, row);
    index_lanes met =
        by_pixels ? first_row | last_row << 8 : (lanes_of_index(2) << last_row) - (lanes_of_index(1) << first_row);
    index_lanes far = lanes_select_indices(is_wide, lanes_of_index(CONIC_BEYOND_X), zero) |
                      lanes_select_indices(is_high, lanes_of_index(CONIC_BEYOND_Y), zero) |
                      lanes_select_indices(has_more, lanes_of_index(CONIC_BEYOND_MORE), zero);
    lanes_store_indices(tiles + i, (y_begin >> tile_bits) * (uint32_t)n_tiles_x + (x_begin >> tile_bits));
    lanes_store_indices(words + i, (x_begin & in_tile) >> unit_bits |
                                       lanes_select_indices(is_wide, last_unit, column) << 8 | met << 16);
    lanes_store_indices(beyond + i, lanes_select_indices(lanes_has_bits(far, ~0u), far | column | row << 8, zero));
  }
  for (; i < n; i++) {
    conic_key key = conic_key_of(&boxes[i], tile_bits, n_tiles_x, by_pixels);
    tiles[i] = key.tile;
    words[i] = key.word;
    beyond[i] = key.beyond;
  }
}

static void keys(const conic_box *boxes, size_t n, int tile_bits, int n_tiles_x, int by_pixels, uint32_t *tiles,
                 uint32_t *words, uint32_t *beyond) {
  if (by_pixels)
    keys_in(boxes, n, tile_bits, n_tiles_x, 1, tiles, words, beyond);
  else
    keys_in(boxes, n, tile_bits, n_tiles_x, 0, tiles, words, beyond);
}

CONIC_INLINE void stream_record(void *to, const void *from, size_t bytes) {
  lanes_stream(to, from, bytes);
}

#include "raster/loops/sort_body.h"

static size_t select_references(const conic_tile_entry *references, size_t n, uint32_t mask, uint32_t *footprints,
                                uint32_t *words) {
  size_t i = 0, n_selected = 0;
  for (; i + CONIC_LANES <= n; i += CONIC_LANES) {
    index_lanes footprint, word;
    lanes_load_pairs(&references[i].footprint, &footprint, &word);
    lanes_mask has = lanes_has_bits(word, mask);
    lanes_append(words + n_selected, has, word);
    n_selected += lanes_append(footprints + n_selected, has, footprint);
  }
  for (; i < n; i++) {
    footprints[n_selected] = references[i].footprint;
    words[n_selected] = references[i].word;
    n_selected += (references[i].word & mask) != 0;
  }
  return n_selected;
}
