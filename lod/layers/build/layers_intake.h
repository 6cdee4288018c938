/* The samples that a layered cloud is built from, as they come: put aside until their box and spacing are known. */
#ifndef CONIC_LAYERS_INTAKE_H
#define CONIC_LAYERS_INTAKE_H

#include "conic/splats.h"
#include "core/base/team.h"
#include "core/files/spool.h"
#include "lod/layers/build/layers_payload.h"
#include "lod/layers/format/layers_code.h"
#include "lod/octree/octree_code.h"

/* A sample before its place on the grid is known; in a row, its own bytes follow each. */
typedef struct conic_layers_raw {
  float position[3]; /* from the origin of its block */
  uint8_t normal[2];
  uint16_t size;
  uint8_t color[3];
  uint8_t is_bare; /* CONIC_LAYERS_BARE, or _SEEN where `normal` leads to the scanner; else 0 */
} conic_layers_raw;

static inline const conic_layers_raw *conic_layers_raw_at(const unsigned char *raws, size_t stride, size_t i) {
  return (const conic_layers_raw *)(const void *)(raws + i * stride);
}

enum { CONIC_LAYERS_BLOCK = 32768, CONIC_LAYERS_SOME = 8192 };

/* Samples that share an origin, as they are put aside. */
typedef struct conic_layers_block {
  double origin[3];
  uint64_t count;
} conic_layers_block;

typedef struct conic_layers_intake {
  conic_context *context;
  conic_spool spool;
  conic_code_scale scale; /* for the colours' codes */
  float cutoff;
  int is_full;
  conic_layers_payload payload;
  size_t extra_bytes, raw_bytes; /* that follow each sample, and how far samples are apart */
  unsigned char *pending;        /* a block's */
  int has_started, has_colors;
  uint64_t n_in, n_samples, n_nan, n_bare, n_unseen, n_bright;
  double low[3], high[3];            /* of the finite positions, in world units */
  double some[CONIC_LAYERS_SOME][3]; /* of every stride-th sample, the position */
  uint64_t stride;
  size_t n_some;
  uint64_t n_own; /* samples of its own; n_samples and all that is said of them are of the whole team since it united */

  /* Of several processes, each of which takes in a part of the samples in a row. Null: one takes all. */
  const conic_team *team;
  int has_met;         /* it is known what the first batch of all has */
  conic_spool columns; /* the values by name, as they came: n_values doubles a sample */
} conic_layers_intake;

/* `path`: where the result goes; it must outlive the intake. `is_full`: all that splats have is kept. `team`: which
 * takes in the samples together; null: one process does. */
conic_status conic_layers_intake_begin(conic_context *context, const char *path, size_t memory_bytes, float cutoff,
                                       int is_full, const conic_team *team, conic_layers_intake *intake);
void conic_layers_intake_end(conic_layers_intake *intake);

/* Sees to it that what all samples have is what the first batch of all processes has, which this one is unless the
 * process before has another; null: there is none. `has_failed`: say so to those after. Nothing is done the second
 * time. Errors: MEMORY, CANCELLED (a process before failed). */
conic_status conic_layers_intake_meet(conic_layers_intake *intake, const conic_splats *batch, int has_failed);

/* Collective, once all is taken in; also by a process whose `status` is a failure, which everybody gets then: what is
 * known of the samples is known of those of all. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_intake_unite(conic_layers_intake *intake, conic_status status);

/* The first batch says what all samples have. Errors: MEMORY. */
conic_status conic_layers_intake_start(conic_layers_intake *intake, const conic_splats *batch);

/* Errors: ARGUMENT, MEMORY, IO, CANCELLED. */
conic_status conic_layers_intake_append(conic_layers_intake *intake, const conic_splats *batch);

/* Reads the block at *offset, moves that on, and says whether there was one; `samples` has room for a block. Errors:
 * IO. */
conic_status conic_layers_intake_read(const conic_layers_intake *intake, uint64_t *offset, conic_layers_block *block,
                                      unsigned char *samples, int *is_there);

/* The median sampling distance: √(area a sample), from the eight nearest to some. 0 where there are no two apart.
 * Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_intake_spacing(conic_layers_intake *intake, double *spacing);

#endif
