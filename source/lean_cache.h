/* A folder that keeps what was built of splats and triangles, by what these hold. */
#pragma once

#include "conic/triangles.h"
#include "core/files/sha256.h"

enum { CONIC_LEAN_CACHE_PATH = 4096 };

/* All files together are no larger; the oldest go. */
#define CONIC_LEAN_CACHE_BYTES (UINT64_C(4) << 30)

/* The file for what is built of the drawing's sets with a cutoff: FOLDER/KEY.ENDING, where KEY is a hash of all that
 * decides it. The folder is made if it is missing. Errors: IO. */
conic_status conic_lean_cache_path(conic_context *context, const char *folder, const conic_drawing *of, float cutoff,
                                   const char *ending, char path[CONIC_LEAN_CACHE_PATH]);

/* What reads such a file, which is no input; nothing is said where it fails. */
typedef conic_status conic_lean_cache_reader(conic_context *context, const char *path, void **built);
conic_status conic_lean_cache_read(conic_context *context, const char *path, conic_lean_cache_reader *read,
                                   void **built);

/* Writes such a file by `write`, and leaves no more than the bytes above. Where that fails, as on a full disk, there is
 * a warning: the picture does not need the file. Errors: MEMORY, CANCELLED. */
typedef conic_status conic_lean_cache_writer(void *built, const char *path);
conic_status conic_lean_cache_write(conic_context *context, const char *folder, const char *path,
                                    conic_lean_cache_writer *write, void *built);
