/* The OBJ reader. */
#ifndef CONIC_OBJ_H
#define CONIC_OBJ_H

#include "conic/model.h"
#include "core/files/input.h"

/* Reads a model from the start of the file. On failure *model is for the caller to release. Errors: INPUT, MEMORY,
 * CANCELLED. */
conic_status conic_obj_read(conic_input *input, const conic_read_options *options, conic_model *model);

#endif
