/* Building one layered cloud by a team of processes, which all see the same disk. Each takes in a part of the samples,
 * and grows a part of the tree. The file is the same as one process makes of all samples, the first process's first. */
#pragma once

#include <stdio.h>

#include "conic/layers.h"
#include "core/base/team.h"

/* How a file is kept while it is built (layers_kept.h), so that building can go on after any end. */
typedef struct conic_layers_keeping {
  const char *key; /* 64 hex digits of all that decides the file's bytes; it must outlive the builder */
  int goes_on;     /* goes on with what is kept of that key; else that is forgotten */
  int may_begin;   /* begins where nothing is kept */
} conic_layers_keeping;

/* Some of the bytes that are kept. */
typedef struct conic_layers_kept_bytes {
  const void *bytes;
  size_t n_bytes;
} conic_layers_kept_bytes;

/* As conic_layers_builder_open, in every process of a team, which may be null. Each appends its own samples, and then
 * all finish. A process that has failed abandons the builder; the others then fail with CANCELLED when they finish. The
 * statistics are whole in the first process. `keeping` is the same in all; null: nothing is kept. Collective: where it
 * fails in one process, it does in all. Errors: also INPUT (what is kept is of another key, or not there). */
conic_status conic_layers_builder_open_team(conic_context *context, const char *path,
                                            const conic_layers_options *options, const conic_team *team,
                                            const conic_layers_keeping *keeping, conic_layers_builder **builder);

/* How many samples are in branches that were finished when it was opened. */
uint64_t conic_layers_builder_finished(const conic_layers_builder *builder);

/* Keeps what has been made of an input, by its number, beside the branches, if these are kept. Errors: MEMORY, IO. */
conic_status conic_layers_builder_keep(conic_layers_builder *builder, uint64_t input,
                                       const conic_layers_kept_bytes *pieces, size_t n_pieces);
/* Opens what is kept of an input for reading. Null: it is not there, or not so many bytes as they were written. */
FILE *conic_layers_builder_open_kept(const conic_layers_builder *builder, uint64_t input, uint64_t n_bytes);

/* Says whether all samples have colours: whether the team's first batch has. `batch` is the first one of this process.
 * It waits for the processes before. Errors: MEMORY, CANCELLED. */
conic_status conic_layers_builder_agree(conic_layers_builder *builder, const conic_splats *batch, int *has_colors);
