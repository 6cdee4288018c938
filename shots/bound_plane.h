/* The plane bound: how far each pixel is from that of the picture that leaves nothing out and merges nothing. */
#pragma once

#include "shots/stage.h"

/* Draws the picture without an error and a budget, where the plane is wanted; the caller releases it. Errors:
 * UNSUPPORTED (not all of it fits into memory), and those of drawing. */
conic_status conic_bound_plane_begin(const conic_shot_stage *first, const conic_look *look, const conic_image *image,
                                     conic_image *whole);

/* Fills in the plane, once the picture is drawn, and returns the greatest of it. */
double conic_bound_plane_find(const conic_image *whole, const conic_image *image);
