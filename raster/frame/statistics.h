/* Statistics of pictures that are drawn in parts. */
#pragma once

#include "conic/render.h"

/* Adds what is counted by the pixel, and the times; all else becomes the part's. */
void conic_statistics_add_pixels(const conic_render_statistics *part, conic_render_statistics *sum);

/* Adds also what is counted by the splat and by the triangle. */
void conic_statistics_add(const conic_render_statistics *part, conic_render_statistics *sum);
