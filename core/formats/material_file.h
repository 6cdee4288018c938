/* Material files (MTL) beside an OBJ: of each material its diffuse colour, its alpha, and the pictures of both. */
#ifndef CONIC_MATERIAL_FILE_H
#define CONIC_MATERIAL_FILE_H

#include "conic/triangles.h"
#include "core/splats/faces.h"

/* Fills in those of the `names`' materials that the file at `path` has; what it says of others is passed over. Pictures
 * are looked for in the file's folder; one that is not there is a warning. Errors: INPUT, UNSUPPORTED, MEMORY,
 * CANCELLED. */
conic_status conic_material_file_read(conic_context *context, const char *path, const conic_texts *names,
                                      conic_material *materials);

#endif
