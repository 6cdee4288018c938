/* Pictures as NumPy writes them: an array in an .npy, or several, by their names, in an .npz.
 *
 * A lone array is (H, W) or (H, W, 1) grey, (H, W, 3) colour or (H, W, 4) with alpha, premultiplied; leading axes of
 * one item are ignored, and (3, H, W) is read, too. In an .npz each array is a plane by its name, "rgba", "Z", "N" …;
 * "rgb", "image", "colors", "render" and "renders" are colours, too, and "A", "alpha" and "alphas" their alpha. Floats
 * are taken as they are, and bytes and words divided by the greatest code. */
#pragma once

#include "conic/image.h"

/* *most_code: 255 or 65535 where the colours are bytes or words, else 0. Errors: INPUT, UNSUPPORTED, MEMORY. */
conic_status conic_numpy_image_read(conic_context *context, const char *path, conic_image *image, unsigned *most_code);

/* Reads an .npy as that plane. An image without a size takes the array's; else the sizes must agree. Errors: as
 * there. */
conic_status conic_numpy_plane_read(conic_context *context, const char *path, conic_plane plane, conic_image *image);

/* A whole number as a file of floats holds it: -1 is CONIC_NO_ID; a float that is not whole gives a number that nothing
 * has. */
uint32_t conic_numpy_whole_number(double value);
