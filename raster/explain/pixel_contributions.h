/* The inside of a frame's contributions. */
#pragma once

#include "conic/contributions.h"
#include "raster/frame/drawing.h"
#include "raster/tiles/coverage.h"

/* Rows of the picture whose splats are listed together. */
enum { CONIC_CONTRIBUTION_BAND = 8 };

struct conic_contributions {
  conic_context *context;
  const conic_splats *splats;
  conic_render_options options;
  conic_view view;
  conic_projected projected;
  size_t *band_begin; /* band b's splats are references[band_begin[b] … band_begin[b + 1]), in the order of the set */
  uint32_t *references;     /* indices of footprints */
  conic_contribution *list; /* of the last pixel that was asked for */
  conic_kept_memory list_memory;
  conic_whole_drawing drawing;
  conic_triangle_frame triangles; /* where the drawing has some */
  conic_triangle_contribution *triangle_list;
  conic_kept_memory triangle_list_memory;
};

/* The viewer looks at the pixel along (ray[0], ray[1], 1). */
static inline void conic_contribution_ray(const conic_view *view, int x, int y, float ray[2]) {
  ray[0] = (float)(((double)x + 0.5 - view->cx) / view->fx);
  ray[1] = (float)(((double)y + 0.5 - view->cy) / view->fy);
}

/* By what a footprint hides others at a pixel that it covers. */
static inline float conic_contribution_hides(const conic_view *view, const conic_footprint *footprint,
                                             const conic_fragment *fragment, int x, int y) {
  float ray[2];
  conic_contribution_ray(view, x, y, ray);
  return conic_hiding_iz(footprint, fragment, ray[0], ray[1]);
}

/* The triangles at a pixel before it is known what splats hide them: the nearest alone is visible. Errors: MEMORY. */
conic_status conic_contribution_triangles(conic_contributions *contributions, int x, int y,
                                          const conic_triangle_contribution **nearest, size_t *n);

/* The nearest triangle at a pixel; with iz = 0 there is none. */
typedef struct conic_near_triangle {
  const conic_triangle_record *record;
  uint32_t triangle;
  float iz, hides;
} conic_near_triangle;

/* Finds those of a line of the picture, one a pixel. */
void conic_contribution_triangle_line(const conic_contributions *contributions, int y, conic_near_triangle *line);

/* The colour of a triangle at a pixel of its line. */
void conic_contribution_triangle_color(const conic_contributions *contributions, const conic_near_triangle *triangle,
                                       int x, int y, float color[3]);

/* The footprint at a pixel, which it covers: everything but the verdict. */
conic_contribution conic_contribution_of(const conic_contributions *contributions, uint32_t i_footprint, int x, int y,
                                         const conic_fragment *fragment);

/* The pixels that a footprint may cover: those of the blocks of 4 × 4 that its box meets, within the picture. */
typedef struct conic_reach {
  int x_begin, x_end, y_begin, y_end;
} conic_reach;

static inline conic_reach conic_reach_of(const conic_contributions *contributions, uint32_t i_footprint) {
  const conic_box *box = &contributions->projected.boxes[i_footprint];
  const conic_view *view = &contributions->view;
  conic_reach reach = {box->x_begin / 4 * 4, (box->x_end + 3) / 4 * 4, box->y_begin / 4 * 4, (box->y_end + 3) / 4 * 4};
  reach.x_end = reach.x_end < view->width ? reach.x_end : view->width;
  reach.y_end = reach.y_end < view->height ? reach.y_end : view->height;
  return reach;
}
