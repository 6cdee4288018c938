/* The pictures of a model's materials, without which the model can be drawn. */
#pragma once

#include "conic/texture.h"

/* The picture in a file, or in the bytes of one that lies within another; `name` is what messages of the file `model`
 * call it. A picture that cannot be read is a warning, and *texture stays null. Errors: MEMORY, CANCELLED, IO. */
conic_status conic_texture_file_read(conic_context *context, const char *model, const char *path, const char *name,
                                     conic_texture_wrap wrap, conic_texture **texture);
conic_status conic_texture_bytes_read(conic_context *context, const char *model, const void *bytes, size_t n_bytes,
                                      const char *name, conic_texture_wrap wrap, conic_texture **texture);
