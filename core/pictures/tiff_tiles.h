/* Pictures of any size as TIFF files in tiles, written tile after tile: TIFF 6.0, or BigTIFF where more than 4 GB may
 * come of it, with the tags of GeoTIFF (OGC 19-008r4) where it is known which part of the earth is seen. */
#ifndef CONIC_TIFF_TILES_H
#define CONIC_TIFF_TILES_H

#include <stdint.h>

#include "core/pictures/georeference.h"

enum { CONIC_TIFF_TILE = 256 }; /* the edge of a tile in pixels */

typedef struct conic_tiff_layout {
  uint64_t width, height; /* 1 to 2³¹ - 1 */
  int is_elevation;       /* a pixel is a float; else R, G, B, A, a byte each, sRGB-encoded, not premultiplied */
  double nodata;          /* of elevations: where nothing is */
  double pixel;           /* a pixel's edge in world units */
  double corner[2];       /* x and y of the picture's upper left corner; x grows to the right, y upwards */
  const conic_georeference *reference; /* which world that is; null, or empty: not known */
  const char *description;             /* how it was made; null: not said. It stays until the file is finished */
} conic_tiff_layout;

typedef struct conic_tiff conic_tiff;

/* Bytes of a pixel. */
size_t conic_tiff_pixel_bytes(const conic_tiff_layout *layout);

/* Starts a file that appears under its name when it is whole. On success the caller owns *tiff and ends it with finish
 * or abandon. Errors: ARGUMENT (standard output, or no such size), MEMORY, IO. */
conic_status conic_tiff_open(conic_context *context, const char *path, const conic_tiff_layout *layout,
                             conic_tiff **tiff);
/* The next tile, row after row of tiles from the top, each from the left: CONIC_TIFF_TILE rows of as many pixels, those
 * outside of the picture with anything in them. `pixels` are undefined afterwards. Errors: MEMORY, IO. */
conic_status conic_tiff_append(conic_tiff *tiff, void *pixels);
/* After the last tile. Releases the writer, on failure too. Errors: IO. */
conic_status conic_tiff_finish(conic_tiff *tiff);
/* Drops all of it; null is allowed. */
void conic_tiff_abandon(conic_tiff *tiff);

#endif
