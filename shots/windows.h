/* One picture by several processes, in windows. */
#pragma once

#include "shots/stage.h"
#include "source/source_parts.h"

/* What windows are drawn of; other planes are made of these later. */
#define CONIC_WINDOWS_PLANES                                                                                           \
  (CONIC_DRAWN_PLANES | 1u << CONIC_PLANE_CLUSTER | (CONIC_GAUSSIAN_PLANES & ~(1u << CONIC_PLANE_DOUBT)))

/* What a process has counted of the windows that it drew; zero at first. */
typedef struct conic_window_counts {
  uint64_t n_windows;
  conic_render_statistics statistics;
} conic_window_counts;

/* Collective: where the source deals out windows, who draws each of the list, which the caller releases through the
 * context's memory, also after a failure, which all then know; else null. */
conic_status conic_shot_windows_deal(const conic_shot_work *work, conic_source_windows *windows,
                                     const conic_window *list, size_t n, int is_in_order, int **owners);

void conic_windows_count(const conic_source_windows *windows, const conic_render_statistics *drawn,
                         conic_window_counts *counts);
/* Collective, once all windows are drawn: the first process's counts become the picture's. */
conic_status conic_windows_sum(const conic_shot_work *work, conic_source_windows *windows, conic_window_counts *counts);

/* Collective: conic_source_draw, after which the first process has the picture and the statistics, to the bits of one
 * process. The others' image may be without planes, and stays as it is. */
conic_status conic_windows_draw_together(const conic_shot_work *work, const conic_look *look, conic_image *image,
                                         conic_render_statistics *statistics);
