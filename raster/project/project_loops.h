/* The table of set-up (raster/loops/raster_loops.h). */
#pragma once

#include "raster/project/projected.h"

/* Appends the splats begin … end - 1 to the chunk, compacted,
 * in order. */
typedef struct conic_project_loops {
  void (*project)(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                  conic_projected *projected, conic_chunk *chunk);
} conic_project_loops;
