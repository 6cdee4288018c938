/* Parts of a frame: windows of its pixels, or only how deep it hides. All are of the whole picture's own arithmetic,
 * bit for bit. */
#pragma once

#include "conic/triangles.h"

/* Pixels from begin to before end. */
typedef struct conic_window {
  int x_begin, x_end, y_begin, y_end;
} conic_window;

/* What two have in common; begin is not before end where that is nothing. */
static inline conic_window conic_window_meet(const conic_window *a, const conic_window *b) {
  return (conic_window){a->x_begin > b->x_begin ? a->x_begin : b->x_begin, a->x_end < b->x_end ? a->x_end : b->x_end,
                        a->y_begin > b->y_begin ? a->y_begin : b->y_begin, a->y_end < b->y_end ? a->y_end : b->y_end};
}

/* Whether the renderer draws parts: the processor does, other devices do not. */
int conic_renderer_has_parts(const conic_renderer *renderer);

/* An error where it does not: UNSUPPORTED. */
conic_status conic_renderer_check_parts(const conic_renderer *renderer);

/* How many splats the first picture of a renderer may have until it is drawn in bands of rows, and how many records,
 * about, a band has then; 0: one and a half million. No bit depends on it. */
void conic_renderer_bound_records(conic_renderer *renderer, size_t most);

/* Gives back the memory that is kept from picture to picture. */
void conic_renderer_give_back(conic_renderer *renderer);

/* Windows begin at multiples of so many pixels, and end there or where the picture ends. */
enum { CONIC_WINDOW_STEP = 8 };

typedef struct conic_part {
  conic_window window;
  int first_column, first_row;     /* of the picture, where the image begins: it need hold no more than the window */
  const unsigned char *is_counted; /* a splat: 0 where another part counts it; null: all are counted */
} conic_part;

/* Draws the part of the picture that conic_render would draw, and leaves all around it alone. It serves pictures of
 * more splats than memory holds: each window is given the splats that may meet it, in their order. The fragments and
 * pixels in `statistics` are the window's. Its other counts are of the splats that are counted, in the whole picture.
 * The options have to give near_z and, with an automatic ε, splat_length, for no window knows the scene. Errors: as
 * conic_render; UNSUPPORTED on another device than the processor. */
conic_status conic_render_part(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                               const conic_render_options *options, const conic_part *part, conic_image *image,
                               conic_render_statistics *statistics);

/* A picture that is set up as a whole, once, and drawn window by window: for whoever draws only some of them. */
typedef struct conic_prepared conic_prepared;

/* Sets it up in the renderer's memory, where it stays until this draws something else; the drawing has to stay as long.
 * `planes`: those of the images that come. On success the caller owns *prepared. Errors: as conic_render; UNSUPPORTED
 * on another device than the processor. */
conic_status conic_prepare(conic_renderer *renderer, const conic_drawing *drawing, const conic_camera *camera,
                           const conic_render_options *options, unsigned planes, conic_prepared **prepared);

/* Draws a window into an image of its size. It begins at multiples of the options' tile, and ends there or where the
 * picture ends. Of `statistics`, fragments and covered pixels are the window's, all else the whole picture's; what
 * setting up took is in the times of the first. Errors: MEMORY, CANCELLED. */
conic_status conic_prepared_draw(conic_prepared *prepared, const conic_window *window, conic_image *image,
                                 conic_render_statistics *statistics);

/* Null is allowed. */
void conic_prepared_release(conic_prepared *prepared);

/* Raises hiding[y·width + x] to the inverse depth that the splats hide all beyond of at that pixel: the greatest
 * s_k·min(iz_k, iz_plane,k) of docs/reference/picture.md. No splat whose iz and iz_plane stay below it there is visible
 * in a picture that these splats are part of, nor hides, nor is the nearest. Errors: as conic_render_part. */
conic_status conic_render_hiding(conic_renderer *renderer, const conic_splats *splats, const conic_camera *camera,
                                 const conic_render_options *options, float *hiding);
