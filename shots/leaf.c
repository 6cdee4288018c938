/* The last stage: the source draws, alone or with other processes. */
#include "shots/windows.h"

conic_status conic_stage_leaf(const conic_shot_stage *stage, const conic_look *look, conic_image *image,
                              conic_render_statistics *statistics) {
  conic_shot_work *work = stage->work;
  if (work->units == CONIC_UNITS_WINDOWS)
    return conic_windows_draw_together(work, look, image, statistics);
  return conic_source_draw(work->surfaces, work->renderer, look->camera, look->render, look->view, image, statistics);
}
