/* Models of what is lent. */
#ifndef CONIC_MODEL_LOAN_H
#define CONIC_MODEL_LOAN_H

#include "conic/model.h"

/* Whether splats or triangles are lent under a name. */
int conic_model_is_lent(const conic_context *context, const char *name);

/* Copies a lent set, as conic_model_read would read a PLY of it. *model is empty before; on failure the caller releases
 * it. Errors: ARGUMENT, INPUT (a face index, no such field), MEMORY. */
conic_status conic_model_copy_lent(conic_context *context, const char *name, const conic_read_options *options,
                                   conic_model *model);

#endif
