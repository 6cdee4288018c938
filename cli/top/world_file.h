/* World files: six lines beside a picture that say where on the ground it is. */
#ifndef CONIC_WORLD_FILE_H
#define CONIC_WORLD_FILE_H

#include "conic/context.h"

/* Writes PATH's world file: .tfw beside .tif, .pgw beside .png, and so on: the ending's first and last letter, and w.
 * `pixel` is a pixel's edge; the corner is x and y of the picture's upper left corner. Errors: MEMORY, IO. */
conic_status cli_world_file_write(conic_context *context, const char *path, double pixel, const double corner[2]);

#endif
