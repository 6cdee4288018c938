/* From a cloud's bytes to its samples. */
#pragma once

#include "conic/coloring.h"
#include "core/splats/point_filter.h"
#include "lod/layers/format/layers_axes.h"
#include "lod/layers/format/layers_format.h"

/* The samples of a cloud, ascending by key, so that those in the place of a node below are a range
 * (conic_layers_range). All arrays lie in one block. */
typedef struct conic_layers_cloud {
  size_t count;
  uint64_t *keys;
  float *position[3];         /* from the header's origin */
  float *normal[3];           /* unit; zero, but not in a .lpc: it faces the eye */
  float *color[3];            /* linear; null where the file has none */
  uint16_t *facing;           /* of each normal, conic_layers_facing; null where the file has ellipses, or is no .lpc */
  float *outline;             /* null where the file has none */
  float *axis[6];             /* where the file has ellipses: t_u and t_v */
  float *opacity;             /* likewise, and null where all are 1 */
  float *dot;                 /* likewise, and null where none is one */
  conic_layers_lines *lines;  /* likewise */
  unsigned char *is_left_out; /* with a filter: a sample that does not pass */
  double *values;             /* one kept value of all samples after the other; null: none is kept */
  float median_outline;       /* of another hierarchy's cloud: the lower median; more than 0 */
} conic_layers_cloud;

/* Normals in sets that lie together, by their two codes. */
enum { CONIC_LAYERS_FACING_SIDE = 32, CONIC_LAYERS_FACINGS = CONIC_LAYERS_FACING_SIDE * CONIC_LAYERS_FACING_SIDE };

static inline uint16_t conic_layers_facing(const uint8_t code[2]) {
  return (uint16_t)((code[0] >> 3) * CONIC_LAYERS_FACING_SIDE + (code[1] >> 3));
}

/* In place of an attribute: the position's x; y and z are one and two below. */
enum { CONIC_LAYERS_BY_X = -2 };

/* What is made of the values that samples have by name. */
typedef struct conic_layers_choice {
  int colored_by; /* an attribute; −1: the colours are the file's */
  conic_coloring coloring;
  conic_filter *filter;                       /* null: all samples pass */
  int filtered_by[CONIC_FILTER_MOST_NAMES];   /* attributes */
  uint32_t n_kept;                            /* values that are handed on with the samples */
  uint8_t kept[CONIC_LAYERS_MOST_ATTRIBUTES]; /* their attributes */
} conic_layers_choice;

/* How many bytes a cloud's samples take; and lays them out in a block of so many, aligned to 64, and returns the same.
 */
size_t conic_layers_cloud_bytes(const conic_layers_header *header, const conic_layers_entry *entry,
                                const conic_layers_choice *choice);
size_t conic_layers_cloud_place(const conic_layers_header *header, const conic_layers_entry *entry,
                                const conic_layers_choice *choice, void *block, conic_layers_cloud *cloud);

/* Decodes clouds, one after the other; each thread has its own. */
typedef struct conic_layers_decoder conic_layers_decoder;

/* `header` is copied; `choice`, which may be null, has to outlive the decoder. Errors: MEMORY, UNSUPPORTED (built
 * without zstd). */
conic_status conic_layers_decoder_create(conic_context *context, const conic_layers_header *header,
                                         const conic_layers_choice *choice, conic_layers_decoder **decoder);
void conic_layers_decoder_destroy(conic_layers_decoder *decoder);

/* Decodes the entry->n_bytes bytes into `cloud`, which conic_layers_cloud_place has laid out. Checks the sum and
 * everything else before it is used. Returns null, or what is wrong with the bytes. The same bytes give the same bits
 * everywhere. */
const char *conic_layers_decode(conic_layers_decoder *decoder, const conic_layers_entry *entry,
                                const unsigned char *bytes, conic_layers_cloud *cloud);

/* The samples of `cloud` in the place of the node `below`: from *first to before *end. */
void conic_layers_range(const conic_layers_header *header, const conic_layers_cloud *cloud,
                        const conic_layers_entry *below, size_t *first, size_t *end);
