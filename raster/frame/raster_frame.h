/* A frame on its way through the stages: what is drawn is set up and sorted into tiles once, and then any of these are
 * drawn. */
#pragma once

#include "raster/frame/backend.h"
#include "raster/frame/drawing.h"
#include "raster/frame/tile.h"
#include "raster/view/part.h"

struct conic_renderer {
  conic_context *context;
  conic_backend *backend; /* null: the loops here */
  conic_kept_memory footprints, surfaces, rays, clips, chunks, chunk_begin, tile_begin, tile_counts, entries, sorters,
      scratch, times, lengths, others, tile_order, bands;
  conic_triangle_frame triangles;
  unsigned slips;      /* raster/view/slips.h */
  size_t most_records; /* conic_renderer_bound_records; 0: the default */
};

/* What lies in the renderer's memory stays until its next frame. */
typedef struct conic_raster_frame {
  conic_renderer *renderer;
  const conic_splats *splats;
  conic_view view;
  conic_projected projected;
  conic_bins bins;
  conic_finish finish;
  conic_finish_lights lights;
  conic_isa isa;
  conic_raster_loops loops;
  conic_image *image;
  conic_part part;                       /* the pixels that the tiles are of */
  int is_part;                           /* they are not the whole picture */
  int band_bits;                         /* of a picture in bands: how high one is, as a binary logarithm */
  size_t n_tiles_before, n_tiles_of_all; /* of all bands; 0: there are none */
  conic_chunk *others;                   /* a thread: what is not counted */
  float *hiding;                         /* in the place of an image; else null */
  char *sorters, *scratch;               /* of chunks and of tiles, a thread */
  size_t sorter_bytes, scratch_bytes;
  conic_triangle_frame *triangles;   /* null: there are none */
  conic_stage_ticks *times;          /* a thread: what shares the wall-clock out */
  uint64_t *n_fragments, *n_covered; /* a tile */
  conic_window drawn_tiles;          /* in tiles: those that are drawn */
  size_t n_drawn_tiles;
  uint32_t *tile_order; /* null: all, as they lie */
  atomic_size_t n_triangle_fragments;
  atomic_size_t n_tiles_done;
  atomic_int is_cancelled;
} conic_raster_frame;

/* Fills in what the frame is drawn by, where `renderer`, `splats`, `part` and `hiding` are set. `options` stay until it
 * is drawn. Errors: as conic_render. */
conic_status conic_raster_frame_begin(conic_raster_frame *frame, const conic_whole_drawing *drawing,
                                      const conic_camera *camera, const conic_render_options *options);

/* The pass of hiding is of the plane Z alone. Errors: ARGUMENT. */
conic_status conic_raster_frame_take_passes(const conic_raster_frame *frame, unsigned planes,
                                            conic_render_options *options);

/* Projects what is drawn and sorts it into tiles, for a picture of these planes; adds to the times what that took.
 * Errors: MEMORY, ARGUMENT. */
conic_status conic_raster_frame_set_up(conic_raster_frame *frame, unsigned planes, conic_render_milliseconds *ms);

/* Draws the tiles of a window, which begins and ends with tiles or the picture; the image begins where the part says.
 * Adds to the times and to what is counted of pixels. Errors: MEMORY, CANCELLED. */
conic_status conic_raster_frame_draw(conic_raster_frame *frame, const conic_window *window, conic_image *image,
                                     conic_render_statistics *statistics);

/* The sum of the threads' ticks, which begin anew. */
conic_stage_ticks conic_raster_frame_ticks(conic_raster_frame *frame);

/* Sets what became of all that is drawn, and by what settings. */
void conic_raster_frame_count(const conic_raster_frame *frame, conic_render_statistics *statistics);

/* Notes which bands of 2^band_bits rows the splats of the chunk meet, which is alone in `projected`. */
void conic_chunk_find_bands(int band_bits, conic_projected *projected, conic_chunk *chunk);

/* Drops the records of a chunk that do not meet the window. The boxes of the others are cut off at the window's ends,
 * and then count from where it begins. The chunk is alone in `projected`. */
void conic_chunk_keep_window(const conic_window *window, conic_projected *projected, conic_chunk *chunk);

/* Adds to `sum` the counts of those splats from `begin` to before `end` that `is_counted` leaves to another window.
 * `chunk` has been projected from these splats. */
void conic_chunk_count_others(const conic_view *view, const conic_splats *splats, size_t begin, size_t end,
                              const unsigned char *is_counted, const conic_projected *projected,
                              const conic_chunk *chunk, conic_chunk *sum);
