/* Which way the samples of a layered point cloud face, in 1024 sets. A set whose samples in a place all face away is
 * left out at once. */
#ifndef CONIC_LAYERS_FACING_H
#define CONIC_LAYERS_FACING_H

#include "lod/layers/draw/layers_view.h"
#include "lod/layers/format/layers_decode.h"

/* The cone of each set: unit axis, and cosine and sine of half its opening. */
typedef struct conic_layers_facings {
  float axis[3][CONIC_LAYERS_FACINGS], cosine[CONIC_LAYERS_FACINGS], sine[CONIC_LAYERS_FACINGS];
} conic_layers_facings;

/* For each set, whether its samples face away wherever they lie in a place. */
typedef struct conic_layers_turned {
  uint32_t bits[CONIC_LAYERS_FACINGS / 32];
  int is_any;
} conic_layers_turned;

void conic_layers_facings_init(conic_layers_facings *facings);

void conic_layers_find_turned(const conic_layers_facings *facings, const conic_layers_view *view,
                              const conic_layers_entry *entry, conic_layers_turned *turned);

static inline int conic_layers_is_turned(const conic_layers_turned *turned, uint16_t facing) {
  return (int)(turned->bits[facing >> 5] >> (facing & 31) & 1);
}

#endif
