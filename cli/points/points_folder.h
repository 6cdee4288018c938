/* A folder of files of points, as surveys come in, in place of all their names. */
#ifndef CONIC_POINTS_FOLDER_H
#define CONIC_POINTS_FOLDER_H

#include <stddef.h>

#include "conic/context.h"

/* Appends the path to `names`, each followed by a zero, or, of a folder that is no hierarchy, those of its files of
 * points, in the order of their names' bytes; the caller releases them. Errors: INPUT (there are none), MEMORY. */
conic_status cli_points_folder_list(conic_context *context, const char *path, char **names, size_t *n_bytes,
                                    size_t *room);

#endif
