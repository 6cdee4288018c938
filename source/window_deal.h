/* The windows of a picture, dealt out to processes of which each knows only where its own splats are. */
#ifndef CONIC_WINDOW_DEAL_H
#define CONIC_WINDOW_DEAL_H

#include "core/splats/shares.h"
#include "raster/project/projected.h"
#include "raster/view/part.h"

typedef struct conic_dealing {
  const conic_team *team;
  const conic_box *boxes; /* of this process's splats, in samples: what they may cover */
  size_t n_splats;
  const conic_window *list; /* the windows that are drawn, in pixels; all processes have the same */
  size_t n;
  int samples;     /* N × N a pixel */
  int margin;      /* boxes may be short by so many samples */
  int is_in_order; /* windows are wanted one after the other, so everybody gets some of the first ones */
} conic_dealing;

/* Collective: owners[i] becomes the process that is to draw window i; the first is process 0's. Each process gets about
 * as much to do. Errors: MEMORY, CANCELLED. */
conic_status conic_windows_deal(conic_context *context, const conic_dealing *dealing, int *owners);

/* Lists the splats that meet windows of each process, in their order: for process k from begin[k] to before
 * begin[k + 1], of which the caller has room for one more than there are processes. On success the caller releases
 * *list. Errors: MEMORY. */
conic_status conic_windows_list_splats(conic_context *context, const conic_dealing *dealing, const int *owners,
                                       size_t *begin, uint32_t **list);

#endif
