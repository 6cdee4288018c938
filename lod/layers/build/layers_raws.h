/* The samples that a layered cloud is built from, raw as they come: put aside until their box and spacing are known,
 * and then placed on the grid of the file. */
#pragma once

#include "core/coloring/value_limits.h"
#include "core/files/spool.h"
#include "core/splats/point_values.h"
#include "lod/layers/build/layers_node.h"
#include "lod/layers/format/layers_axes.h"
#include "lod/octree/octree_code.h"

/* What is counted of samples, and the least and the greatest of them. */
typedef struct conic_layers_facts {
  uint64_t n_in, n_samples, n_nan, n_bare, n_unseen, n_bright, n_translucent, n_dots, n_clips;
  double low[3], high[3];                                                   /* of finite positions, world units */
  float shortest, longest;                                                  /* axes or outlines that there are */
  double least[CONIC_MOST_POINT_VALUES], greatest[CONIC_MOST_POINT_VALUES]; /* of finite values by name */
} conic_layers_facts;

/* Those of no samples. */
void conic_layers_facts_init(conic_layers_facts *facts);

/* What goes into the cloud of a sample beside place, normal, colour and size: ellipses, opacities, clip lines, values
 * by name; and the table of attributes that says so. */
typedef struct conic_layers_payload {
  conic_context *context;
  conic_layers_schema schema;
  float cutoff;
  int axes, opacity, dot, clip; /* attributes; 0: it has none of it */
  conic_layers_facts facts;
  size_t n_values;
  uint32_t value[CONIC_MOST_POINT_VALUES];       /* attributes */
  const double *column[CONIC_MOST_POINT_VALUES]; /* of the batch; null: it has none */
  size_t n_column;                               /* so many of each */
  conic_value_sample *seen[CONIC_MOST_POINT_VALUES];
  size_t i_clip; /* of the batch, the next record */
} conic_layers_payload;

/* What the first batch has is what all samples get. Errors: MEMORY. */
conic_status conic_layers_payload_begin(conic_context *context, const conic_splats *batch, int is_full, float cutoff,
                                        conic_layers_payload *payload);
void conic_layers_payload_end(conic_layers_payload *payload);

/* Looks for the values in another batch. */
void conic_layers_payload_turn_to(conic_layers_payload *payload, const conic_splats *batch);

/* The clip lines of splat i of the batch, or null; splats come in their order. */
const conic_clip *conic_layers_payload_clip(conic_layers_payload *payload, const conic_splats *batch, size_t i);

/* Fills the bytes behind the head of a record from splat i of the batch; splats come in their order. */
void conic_layers_payload_take(conic_layers_payload *payload, const conic_splats *batch, size_t i, void *extra);

/* The values of splat i as the batch has them, n_values of them. */
void conic_layers_payload_row(const conic_layers_payload *payload, size_t i, double *row);

/* Once all samples have come: completes the table of attributes, and drops those that no sample has. `spacing`: about
 * as long will be the lengths that are not known yet. */
void conic_layers_payload_settle(conic_layers_payload *payload, double spacing);

/* A sample before its place on the grid is known. In a row, each is followed by its own bytes. */
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

typedef struct conic_layers_raws {
  conic_context *context;
  conic_spool spool;
  conic_code_scale scale; /* for the colours' codes */
  float cutoff;
  int is_full;
  conic_layers_payload payload; /* with the facts of all samples */
  size_t raw_bytes;             /* from one sample to the next */
  unsigned char *pending;       /* a block's */
  int has_started, has_colors;
  double some[CONIC_LAYERS_SOME][3]; /* the position of every stride-th sample */
  uint64_t stride;
  size_t n_some;
  uint64_t n_own;         /* samples that this process has taken in; the facts are the team's once they are combined */
  const conic_team *team; /* whose every process takes in a part of the samples; null: one takes all */
  int has_agreed;         /* it is known what the team's first batch has */
  conic_spool columns;    /* with a team: the values by name as they came, n_values doubles a sample */
} conic_layers_raws;

/* `path`: where the result goes; it must outlive the samples. `is_full`: all that splats have is kept. `team`: takes in
 * the samples together; null: one process does. */
void conic_layers_raws_begin(conic_context *context, const char *path, size_t memory_bytes, float cutoff, int is_full,
                             const conic_team *team, conic_layers_raws *raws);
void conic_layers_raws_end(conic_layers_raws *raws);

/* Makes this process's samples have what the team's first batch has. Processes ask one after the other, so it waits
 * for the one before. `batch` is the first of this process, and counts where no process before has one; null: there is
 * none. `has_failed` is told to the processes after. A second call does nothing. Errors: MEMORY, CANCELLED (a process
 * before failed). */
conic_status conic_layers_raws_agree(conic_layers_raws *raws, const conic_splats *batch, int has_failed);

/* Makes the facts those of the team's samples, and `some` some of them. Collective, once all is taken in, also for a
 * process whose `status` is a failure; then all get one. Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_raws_combine(conic_layers_raws *raws, conic_status status);

/* Makes all samples have what the batch has. Errors: MEMORY. */
conic_status conic_layers_raws_start(conic_layers_raws *raws, const conic_splats *batch);

/* Errors: ARGUMENT, MEMORY, IO, CANCELLED. */
conic_status conic_layers_raws_append(conic_layers_raws *raws, const conic_splats *batch);

/* Hands over all samples of this process, block by block in the order in which they came. `task`: that progress is of;
 * null: of none. Errors: MEMORY, IO, CANCELLED, the visitor's. */
typedef conic_status conic_layers_visit_block(void *data, const conic_layers_block *block, const unsigned char *raws);
conic_status conic_layers_raws_visit(const conic_layers_raws *raws, const char *task, conic_layers_visit_block *visit,
                                     void *data);

/* The median sampling distance, √(area a sample), from the eight nearest to some. 0 where there are no two apart.
 * Errors: MEMORY, IO, CANCELLED. */
conic_status conic_layers_raws_spacing(conic_layers_raws *raws, double *spacing);

/* Takes a sample, which is followed by its own bytes and valid during the call only. */
typedef conic_status conic_layers_take(void *to, const conic_layers_sample *sample);

/* Where samples come from: `run` hands them all over, and does so again when it is called again. */
typedef struct conic_layers_feed {
  conic_status (*run)(const void *from, conic_layers_take *take, void *to);
  const void *from;
  uint64_t n_samples;
} conic_layers_feed;

/* What came in, and the grid of the file. */
typedef struct conic_layers_grid {
  const conic_layers_raws *raws;
  double origin[3], quantum, last; /* the greatest step of an axis */
  size_t sample_bytes;
  const char *task;              /* that progress is of */
  const conic_layers_kept *kept; /* samples in its branches are left out */
} conic_layers_grid;

void conic_layers_grid_init(const conic_layers_raws *raws, const conic_layers_plan *plan, const double origin[3],
                            const conic_layers_kept *kept, const char *task, conic_layers_grid *grid);

/* The key of a place in world units, within rounding. */
uint64_t conic_layers_grid_key(const conic_layers_grid *grid, const double position[3]);

/* A feed's `run`, from a conic_layers_grid: samples on the grid, one by one in the order in which they came. Errors:
 * MEMORY, IO, CANCELLED, the receiver's. */
conic_status conic_layers_grid_run(const void *grid, conic_layers_take *take, void *to);
