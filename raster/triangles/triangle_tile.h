/* A tile's triangles: which is the nearest at each pixel, and what that does to the splats' passes. */
#pragma once

#include "raster/tiles/finish.h"
#include "raster/triangles/triangle_pixel.h"

/* Points the band to the tile's row; null where no triangle is in it. */
void conic_triangle_tile_row(const conic_triangle_frame *frame, conic_triangle_tile *tile, int i_row, conic_band *band);

/* The tile whose first pixel is (x, y), to draw in. */
conic_triangle_canvas conic_triangle_canvas_of(const conic_triangle_frame *frame, int x, int y,
                                               conic_triangle_tile *tile);

/* Finds the pixels where a block's triangle is the heaviest or the nearest that is seen. This comes before the
 * triangles are added to the block's sums. */
void conic_triangle_rank_block(const conic_band *band, int block);

/* Fetches what the look of a row's visible triangles is read from, where they are many. */
void conic_triangle_fetch_row(const conic_band *band);

/* Of pixel l of the block. */
void conic_triangle_see_pixel(const conic_band *band, const conic_finish *finish, const conic_tile_rays *rays,
                              int block, int l, conic_triangle_sight *sight);

/* Adds it to the pixel's sums, all but the colour where it is still without its texture. */
void conic_triangle_add_sight(const conic_triangle_sight *sight, int l, conic_block_sums *sums);

/* The slots `draw`, `hide` and `add` in plain C; and what stands for `hide` where the nearest wins alone. */
void conic_triangles_draw(const conic_triangle_frame *frame, size_t i_tile, int x, int y, conic_triangle_tile *tile);
void conic_triangles_hide(conic_band *band, const conic_tile_rays *rays);
void conic_triangles_win(conic_band *band);
void conic_triangles_add(conic_band *band, const conic_finish *finish, const conic_tile_rays *rays);
