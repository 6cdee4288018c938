/* Material files (MTL) beside an OBJ: each material's diffuse colour, its alpha, and the pictures of both. */
#pragma once

#include "conic/triangles.h"
#include "core/splats/faces.h"

/* Fills in the materials of `names` that the file at `path` has, and skips others. Pictures are looked for in the
 * file's folder; a missing one is a warning. Errors: INPUT, UNSUPPORTED, MEMORY, CANCELLED. */
conic_status conic_material_file_read(conic_context *context, const char *path, const conic_texts *names,
                                      conic_material *materials);
