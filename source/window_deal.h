/* Deals the windows of a picture to processes that each know only the places of their own splats. */
#pragma once

#include "core/splats/shares.h"
#include "raster/project/projected.h"
#include "raster/view/part.h"

typedef struct conic_dealing {
  const conic_team *team;
  const conic_box *boxes; /* of this process's splats: the samples that they may cover */
  size_t n_splats;
  const conic_window *list; /* the windows to draw, in pixels; the same in all processes */
  size_t n;
  int samples;     /* N × N a pixel */
  int margin;      /* boxes may be too small by so many samples */
  int is_in_order; /* windows are needed one after the other, so every process gets some of the first ones */
} conic_dealing;

/* Collective: owners[i] becomes the process that draws window i; the first is process 0's. The processes get about the
 * same work. Errors: MEMORY, CANCELLED. */
conic_status conic_windows_deal(conic_context *context, const conic_dealing *dealing, int *owners);

/* Lists the splats that meet windows of each process, in their order: for process k from begin[k] to before begin[k +
 * 1]; `begin` has room for one more than there are processes. On success the caller releases *list. Errors: MEMORY. */
conic_status conic_windows_list_splats(conic_context *context, const conic_dealing *dealing, const int *owners,
                                       size_t *begin, uint32_t **list);
