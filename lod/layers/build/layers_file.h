/* From a grown tree to a file. */
#ifndef CONIC_LAYERS_FILE_H
#define CONIC_LAYERS_FILE_H

#include "lod/layers/build/layers_chunks.h"
#include "lod/layers/format/layers_format.h"

/* Writes the file; `header` says all that does not follow from the clouds, which is filled in. With a team it is
 * collective: the first process writes the index, and everybody the clouds that it has, all to one file under its
 * temporary name, so all have to see the same disk; the first one alone fills the header in. Errors: MEMORY, IO,
 * CANCELLED. */
conic_status conic_layers_write(conic_context *context, const char *path, const conic_team *team,
                                const conic_layers_forest *forest, conic_layers_header *header);

#endif
