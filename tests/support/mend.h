/* Makes the sums in a file's bytes right, where all that its header tells of is there: tests and fuzzing would
 * otherwise see no further than the sums. */
#pragma once

#include <string.h>

#include "core/base/byte_order.h"
#include "lod/blends/levels_format.h"
#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/hybrid/model/hybrid_layout.h"
#include "lod/layers/format/layers_format.h"

static inline void mend_layers(unsigned char *bytes, size_t n_bytes) {
  enum { N_CLOUDS = 24, INDEX_SUM = 176, N_ATTRIBUTES = 192, SUM = CONIC_LAYERS_HEADER_BYTES - 8 };
  enum { ENTRY_OFFSET = 8, ENTRY_SUM = 16, ENTRY_SIZE = 32 };
  if (n_bytes < CONIC_LAYERS_HEADER_BYTES)
    return;
  uint64_t n_clouds = conic_load_32(bytes + N_CLOUDS),
           table = (uint64_t)conic_load_32(bytes + N_ATTRIBUTES) * CONIC_LAYERS_ATTRIBUTE_BYTES;
  if (table + n_clouds * CONIC_LAYERS_ENTRY_BYTES > n_bytes - CONIC_LAYERS_HEADER_BYTES)
    return;
  unsigned char *index = bytes + CONIC_LAYERS_HEADER_BYTES;
  for (size_t i = 0; i < n_clouds; i++) {
    unsigned char *entry = index + table + i * CONIC_LAYERS_ENTRY_BYTES;
    uint64_t offset = conic_load_64(entry + ENTRY_OFFSET), n = conic_load_32(entry + ENTRY_SIZE);
    if (offset <= n_bytes && n <= n_bytes - offset)
      conic_store_64(entry + ENTRY_SUM, conic_checksum(bytes + offset, (size_t)n));
  }
  conic_store_64(bytes + INDEX_SUM, conic_checksum(index, (size_t)(table + n_clouds * CONIC_LAYERS_ENTRY_BYTES)));
  conic_store_64(bytes + SUM, conic_checksum(bytes, SUM));
}

/* Of a .lpc of Gaussians. */
static inline void mend_levels(unsigned char *bytes, size_t n_bytes) {
  enum { INDEX_AT = 136, INDEX_SUM = 144, SUM = CONIC_FILE_HEADER_BYTES - 8, ENTRY_SUM = 8, ENTRY_SIZE = 16 };
  if (n_bytes < CONIC_FILE_HEADER_BYTES)
    return;
  const uint64_t index = conic_load_64(bytes + INDEX_AT);
  if (index <= n_bytes) {
    for (size_t at = (size_t)index; at + CONIC_LEVELS_ENTRY_BYTES <= n_bytes; at += CONIC_LEVELS_ENTRY_BYTES) {
      const uint64_t offset = conic_load_64(bytes + at), n = conic_load_32(bytes + at + ENTRY_SIZE);
      if (offset <= n_bytes && n <= n_bytes - offset)
        conic_store_64(bytes + at + ENTRY_SUM, conic_checksum(bytes + offset, (size_t)n));
    }
    conic_store_64(bytes + INDEX_SUM, conic_checksum(bytes + index, (size_t)(n_bytes - index)));
  }
  conic_store_64(bytes + SUM, conic_checksum(bytes, SUM));
}

/* The sums of chunks, as far as it can be told where they are. */
static inline void mend_chunks(conic_hybrid *h, const conic_file_layout *l, unsigned char *bytes) {
  conic_file_turn_arrays(l, bytes);
  conic_chy_attach(bytes, h);
  if (!conic_hybrid_structure(h))
    for (uint32_t i = 0; i < conic_hybrid_count_chunks(h); i++) {
      conic_hybrid_place place = conic_hybrid_chunk_place(h, i);
      if (place.n_bytes && place.at <= h->n_data && place.n_bytes <= h->n_data - place.at)
        conic_hybrid_seal_chunk(bytes + l->n_bytes + place.at, (size_t)place.n_bytes);
    }
  conic_file_turn_arrays(l, bytes);
}

static inline void mend_hybrid(unsigned char *bytes, size_t n_bytes) {
  conic_hybrid h;
  conic_file_layout l = {0};
  memset(&h, 0, sizeof h);
  conic_file_fields_read(conic_chy_kind.fields, conic_chy_kind.n_fields, bytes + sizeof conic_chy_kind.magic, &h);
  if (!conic_chy_kind.fault(&h))
    l = conic_chy_lay_out(&h);
  int is_whole = l.n_bytes > 0 && l.n_bytes + h.n_data == n_bytes;
  if (is_whole) {
    mend_chunks(&h, &l, bytes);
    h.body_sum = conic_file_sum_bytes(NULL, &l, bytes);
  }
  conic_file_mend_header(&conic_chy_kind, is_whole ? &h : NULL, bytes);
}
