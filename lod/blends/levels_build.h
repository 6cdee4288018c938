/* Makes a .lpc of Gaussians in levels, of any number of scenes, in bounded memory. */
#pragma once

#include "lod/blends/levels_format.h"

typedef struct conic_levels_builder conic_levels_builder;

typedef struct conic_levels_statistics {
  uint64_t n, n_merged, n_clouds, n_bytes;
  int n_levels;
} conic_levels_statistics;

/* Of memory_bytes, the file does not depend. On success the caller owns *builder. Errors: ARGUMENT, MEMORY, IO,
 * UNSUPPORTED (built without zstd). */
conic_status conic_levels_builder_open(conic_context *context, const char *path, uint32_t cloud_size,
                                       uint64_t memory_bytes, conic_levels_builder **builder);

/* Appends a scene, which it may turn into the first one's frame. Errors: INPUT (2D Gaussians; other colours or a higher
 * degree than the first has; too many), ARGUMENT (the frames mirror each other), MEMORY, IO. */
conic_status conic_levels_builder_append(conic_levels_builder *builder, const char *name, conic_gaussians *scene);

/* Builds and writes the file, and releases the builder, on failure too. Errors: INPUT (nothing to draw), MEMORY, IO,
 * CANCELLED. */
conic_status conic_levels_builder_finish(conic_levels_builder *builder, conic_levels_statistics *statistics);
/* Drops all of it; null is allowed. */
void conic_levels_builder_abandon(conic_levels_builder *builder);
