/* The decoded clouds of a file that are in memory: those last used, up to a bound. */
#pragma once

#include "conic/layers_draw.h"
#include "lod/layers/format/layers_decode.h"

typedef struct conic_layers_slot {
  conic_layers_cloud *cloud; /* with its arrays in one block; null: it is not in memory */
  uint32_t newer, older;     /* neighbours by last use: clouds, or CONIC_NO_CLOUD */
  uint16_t n_pins;           /* it must stay */
  uint8_t is_doubted;        /* its bytes were wrong once */
  uint8_t is_asked;          /* ahead of need, and not yet there */
  uint8_t is_wanted;         /* now */
} conic_layers_slot;

#define CONIC_NO_CLOUD UINT32_MAX

typedef struct conic_layers_store {
  conic_layers_slot *slots; /* a cloud */
  uint32_t newest, oldest;
  uint64_t n_bytes;                /* of all blocks */
  uint64_t n_read;                 /* clouds decoded so far */
  uint64_t n_asked;                /* ahead of need, and not yet there */
  uint64_t n_ahead;                /* clouds that came so far because they had been asked for ahead */
  conic_layers_decoder **decoders; /* a thread; null until it is first needed */
} conic_layers_store;

/* Errors: MEMORY, UNSUPPORTED. */
conic_status conic_layers_store_open(conic_layers *layers);
void conic_layers_store_close(conic_layers *layers);

typedef struct conic_layers_loading {
  const uint32_t *clouds; /* ascending */
  size_t n;
  const uint64_t *ranks; /* a cloud of the file: the least is wanted first; null: in the file's order */
  double until_s;        /* by conic_seconds_now; infinite: as long as it takes */
  int may_miss;          /* what does not come is left out, */
  int tolerates_damage;  /* and so is what is wrong, after a warning */
  uint64_t n_missing;    /* set: so many were left out */
  uint64_t n_damaged;    /* set: so many of these were wrong */
} conic_layers_loading;

/* Brings clouds into memory, where they stay until conic_layers_store_unpin. On failure none is held. Errors: INPUT
 * (damaged), IO, MEMORY, CANCELLED. */
conic_status conic_layers_store_load(conic_layers *layers, conic_layers_loading *loading);
void conic_layers_store_unpin(conic_layers *layers, const conic_layers_loading *loading);

/* Takes memory for a cloud that is yet to be unpacked. Errors: MEMORY. */
conic_status conic_layers_store_allocate(const conic_layers *layers, uint32_t cloud, conic_layers_cloud **made);

/* Gives clouds other numbers: number i becomes becomes[i]. The store takes over `slots`, which are zeroed. No cloud may
 * be pinned. */
void conic_layers_store_renumber(conic_layers *layers, const uint32_t *becomes, conic_layers_slot *slots);

/* Asks for clouds that will be wanted, ascending, as many as the cache holds, and lets them come while the caller
 * draws. Errors: MEMORY. */
conic_status conic_layers_store_ask_ahead(conic_layers *layers, const uint32_t *clouds, size_t n);

/* How many of the first clouds of a list may be in memory together, within so many bytes; at least 1. */
size_t conic_layers_store_fit(const conic_layers *layers, const uint32_t *clouds, size_t n, uint64_t n_bytes);
