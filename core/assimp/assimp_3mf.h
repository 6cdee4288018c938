/* 3MF packages, put so that Assimp reads them. */
#pragma once

#include "core/base/base.h"

/* Makes of a package, which is released, one that is stored unpacked, whose parts by 3MF's production extension
 * (p:path) are objects of its one model. *bytes stay the caller's, on failure too. Errors: INPUT, UNSUPPORTED (zlib is
 * not there), MEMORY, IO (no temporary file). */
conic_status conic_3mf_unpack(conic_context *context, const char *name, unsigned char **bytes, size_t *n_bytes);
