/* Which triangles the vertices of a mesh belong to. */
#pragma once

#include "conic/model.h"

/* The triangles of vertex i are triangles[starts[i] … starts[i + 1]), in the order of the file. */
typedef struct conic_incidence {
  size_t *starts;
  uint32_t *triangles;
} conic_incidence;

/* Lists the triangles by vertex. On success the caller releases it; on failure it is empty. Errors: ARGUMENT (more than
 * `most` triangles, an index out of range), MEMORY. */
conic_status conic_incidence_create(conic_context *context, const conic_model *model, size_t most,
                                    conic_incidence *incidence);
void conic_incidence_release(conic_context *context, conic_incidence *incidence);
