/* Bytes kept from run to run, in files that are whole or not there: written beside and renamed, and with a checksum,
 * since a driver that is given half a binary may do anything. */
#pragma once

#include "core/base/base.h"

/* "FOLDER/NAME-HASH.bin"; empty where that is too long. */
void conic_cache_path(const char *folder, const char *name, uint64_t hash, char *path, size_t room);

/* Reads what was written under the path, into memory that the caller releases. 0 where it is not there or not whole. */
int conic_cache_read(conic_context *context, const char *path, unsigned char **bytes, size_t *n_bytes);

/* Writes it, and makes the path's folders. What fails is told as information only. */
void conic_cache_write(conic_context *context, const char *path, const unsigned char *bytes, size_t n_bytes);
