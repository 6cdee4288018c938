/* A folder of files of points, as surveys often are, given instead of all their names. */
#ifndef CONIC_POINTS_FOLDER_H
#define CONIC_POINTS_FOLDER_H

#include <stddef.h>

#include "conic/context.h"

/* Appends the path to `names`, with a zero at its end; for a folder that is no hierarchy, appends each of its files of
 * points, in the order of their names' bytes. The caller releases the names. Errors: INPUT (the folder has none),
 * MEMORY. */
conic_status cli_points_folder_list(conic_context *context, const char *path, char **names, size_t *n_bytes,
                                    size_t *room);

#endif
