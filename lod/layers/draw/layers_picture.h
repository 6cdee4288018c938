/* One picture of a layered point cloud, drawn at once or window by window, with the same bits. What is drawn is chosen
 * for all of the picture, and a window reads what it may show of that. */
#pragma once

#include "conic/layers_draw.h"
#include "raster/view/part.h"

typedef struct conic_layers_picture conic_layers_picture;

/* What windows took, beside what statistics count. */
typedef struct conic_layers_tally {
  uint64_t n_turned, n_clouds_read, n_bytes_received, n_bands;
} conic_layers_tally;

/* Chooses what is drawn. With occlusion, that also takes memory for how deep each pixel hides, beside an image of so
 * many bytes. Afterwards only layers and renderer must stay. Until the picture ends, the layers draw no other. Errors:
 * as conic_layers_draw. */
conic_status conic_layers_picture_begin(conic_layers *layers, conic_renderer *renderer, const conic_camera *camera,
                                        const conic_render_options *given, const conic_layers_draw_options *wanted,
                                        uint64_t image_bytes, conic_layers_picture **picture);
void conic_layers_picture_end(conic_layers_picture *d); /* null is allowed */

/* Draws a window's pixels into an image of its size. A window is all of the picture; or it lies in one of the bands in
 * which conic_render_samples draws it, and begins at a multiple of CONIC_WINDOW_STEP pixels there. Where windows make
 * up the picture, the sums of their statistics and tallies are the picture's; *tally grows. The layers leave
 * `other_bytes` of their memory free. Errors: as conic_layers_draw. */
conic_status conic_layers_picture_draw(conic_layers_picture *d, const conic_window *window, uint64_t other_bytes,
                                       conic_image *image, conic_render_statistics *statistics,
                                       conic_layers_tally *tally);

/* About how many splats each of the windows has. Windows do not overlap, and neither their first nor their last rows
 * ever decrease. */
void conic_layers_picture_weigh(const conic_layers_picture *d, const conic_window *list, size_t n, double *weights);

/* Tells what the picture took, by these sums. */
void conic_layers_picture_tell(conic_layers_picture *d, const conic_render_statistics *statistics,
                               const conic_layers_tally *tally, conic_layers_drawn *drawn);
