/* One picture in windows, each of them to the bits of the whole: for several processes, of which none draws all. */
#ifndef CONIC_SOURCE_PARTS_H
#define CONIC_SOURCE_PARTS_H

#include "conic/source.h"
#include "raster/view/part.h"

/* Whether it can: what is drawn of splats in memory, by the processor. */
int conic_source_has_windows(const conic_source *source, const conic_renderer *renderer);

typedef struct conic_source_windows {
  conic_source *source;
  conic_renderer *renderer;
  conic_camera camera;
  conic_render_options render; /* settled */
  int samples;
  int band_rows; /* no window lies in two bands of so many rows */
} conic_source_windows;

/* Chooses what the camera sees, which stays chosen until the source's next picture. Errors: as conic_source_draw;
 * UNSUPPORTED where it has no windows. */
conic_status conic_source_windows_begin(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *render, const conic_source_view *view,
                                        conic_source_windows *windows);

/* Draws the window's pixels into an image of its size. It begins at multiples of CONIC_WINDOW_STEP pixels, in rows from
 * where its band begins. Of `statistics`, fragments and pixels are the window's, all else the band's. Errors: as
 * conic_source_draw. */
conic_status conic_source_windows_draw(const conic_source_windows *windows, const conic_window *window,
                                       conic_image *image, conic_render_statistics *statistics);

/* Makes of the sum of all windows' statistics those of the picture. Errors: MEMORY, CANCELLED. */
conic_status conic_source_windows_count(const conic_source_windows *windows, conic_render_statistics *statistics);

/* How much work each of the windows is, about: of its splats, and of its pixels. */
void conic_source_windows_weigh(const conic_source_windows *windows, const conic_window *list, size_t n,
                                double *weights);

#endif
