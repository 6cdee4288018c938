/* The reader of the formats that Assimp knows. */
#pragma once

#include "conic/model.h"
#include "core/assimp/assimp_process.h"
#include "core/files/input.h"

/* Whether the module that leads to Assimp is there. */
int conic_assimp_is_there(void);

/* Reads a model of a kind that conic_assimp_reads, from the start of the file. On failure *model is for the caller to
 * release. Errors: INPUT, UNSUPPORTED (Assimp is not there, or a texture's format), MEMORY, IO (no process),
 * CANCELLED. */
conic_status conic_assimp_read(conic_input *input, conic_model_kind kind, const conic_read_options *options,
                               conic_model *model);

/* Reads the model from the output of a process that has read the file. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_assimp_read_records(const conic_input *input, conic_assimp_process *process,
                                       const conic_read_options *options, conic_model *model);
