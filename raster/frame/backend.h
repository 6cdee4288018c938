/* What draws in the place of a renderer's own loops: another device. The renderer checks and prepares, the backend does
 * all the rest. */
#pragma once

#include "raster/tiles/finish.h"

typedef struct conic_backend conic_backend;

struct conic_backend {
  /* Draws the frame and fills in what it has counted and timed: of the statistics all but near, epsilon and the
   * frame's time. `triangles` (null: none) are begun, and kept from frame to frame; the backend cuts them into tiles of
   * its own and prepares them. Errors: MEMORY, UNSUPPORTED, CANCELLED. */
  conic_status (*draw)(conic_backend *backend, const conic_view *view, const conic_splats *splats,
                       struct conic_triangle_frame *triangles, const conic_finish *finish, conic_image *image,
                       conic_render_statistics *statistics);
  void (*destroy)(conic_backend *backend);
};

/* Gives the renderer a backend, which it owns from then on. */
void conic_renderer_take(conic_renderer *renderer, conic_backend *backend);
/* Null: none. */
conic_backend *conic_renderer_backend(const conic_renderer *renderer);
