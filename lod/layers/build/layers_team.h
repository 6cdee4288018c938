/* Building one layered cloud by several processes, which all see the same disk: each takes in a part of the samples,
 * and grows a part of the tree. The file is the one that one process makes of all samples, those of the first process
 * first. */
#ifndef CONIC_LAYERS_TEAM_H
#define CONIC_LAYERS_TEAM_H

#include <stdio.h>

#include "conic/layers.h"
#include "core/base/team.h"

/* What is kept beside the file while it is built (layers_kept.h), so that it can be gone on with after any end. */
typedef struct conic_layers_keeping {
  const char *key; /* 64 hex digits: of all that decides bytes of the file; it must outlive the builder */
  int goes_on;     /* with what is kept of that key; else it is forgotten */
  int may_begin;   /* where nothing is */
} conic_layers_keeping;

/* Some of the bytes that are kept. */
typedef struct conic_layers_kept_bytes {
  const void *bytes;
  size_t n_bytes;
} conic_layers_kept_bytes;

/* As conic_layers_builder_open, in every process of a team, which may be null. Each appends its own samples, and then
 * all finish. Whoever has failed abandons the builder, at which the others fail when they finish, with CANCELLED. The
 * statistics are whole in the first process. `keeping`, the same in all, may be null: nothing is kept. Collective:
 * where it fails in one process, it does in all. Errors: also INPUT (what is kept is of another key, or not there). */
conic_status conic_layers_builder_open_team(conic_context *context, const char *path,
                                            const conic_layers_options *options, const conic_team *team,
                                            const conic_layers_keeping *keeping, conic_layers_builder **builder);

/* How many samples are in branches that were finished when it was opened. */
uint64_t conic_layers_builder_finished(const conic_layers_builder *builder);

/* Keeps what has been made of an input, by its number, with the branches; nothing is done where these are not kept.
 * Errors: MEMORY, IO. */
conic_status conic_layers_builder_keep(conic_layers_builder *builder, uint64_t input,
                                       const conic_layers_kept_bytes *pieces, size_t n_pieces);
/* Opens what is kept of an input for reading, if it is so many bytes, as they were written; else null. */
FILE *conic_layers_builder_open_kept(const conic_layers_builder *builder, uint64_t input, uint64_t n_bytes);

/* Whether all samples have colours, as the first batch of all has them; `batch` is the first one of this process, and
 * may have to wait for the processes before. Errors: MEMORY, CANCELLED. */
conic_status conic_layers_builder_agree(conic_layers_builder *builder, const conic_splats *batch, int *has_colors);

#endif
