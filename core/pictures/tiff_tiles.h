/* Pictures of any size as tiled TIFF files, written tile by tile: TIFF 6.0, or BigTIFF where the file may exceed 4 GB;
 * with the tags of GeoTIFF (OGC 19-008r4) where the coordinate system is known. */
#pragma once

#include "core/pictures/georeference.h"

enum { CONIC_TIFF_TILE = 256 }; /* the edge of a tile in pixels */

typedef struct conic_tiff_layout {
  uint64_t width, height; /* 1 to 2³¹ - 1 */
  int is_elevation;       /* a pixel is a float; else R, G, B, A, a byte each, sRGB-encoded, not premultiplied */
  double nodata;          /* of elevations: the value where nothing is */
  double dpi;             /* above 0: it is a sheet of paper, with so many pixels an inch, and nowhere in the world */
  double pixel;           /* a pixel's edge in world units */
  double corner[2];       /* x and y of the picture's upper left corner; x grows to the right, y upwards */
  const conic_georeference *reference; /* the coordinate system; null, or empty: not known */
  const char *description;             /* how it was made; null: not said. It stays until the file is finished */
} conic_tiff_layout;

typedef struct conic_tiff conic_tiff;

/* Bytes of a pixel. */
size_t conic_tiff_pixel_bytes(const conic_tiff_layout *layout);

/* Starts a file that appears under its name when it is whole. On success the caller owns *tiff and ends it with
 * conic_tiff_end. Errors: ARGUMENT (standard output, or no such size), MEMORY, IO. */
conic_status conic_tiff_open(conic_context *context, const char *path, const conic_tiff_layout *layout,
                             conic_tiff **tiff);
/* Appends the next tile; tiles come in rows from the top, each row from the left. A tile is CONIC_TIFF_TILE rows of as
 * many pixels; pixels outside of the picture may be anything. `pixels` are undefined afterwards. Errors: MEMORY, IO. */
conic_status conic_tiff_append(conic_tiff *tiff, void *pixels);
/* Completes the file after the last tile, or drops it if the status is not OK. Releases the writer, which may be null,
 * and returns the status. Errors: IO. */
conic_status conic_tiff_end(conic_tiff *tiff, conic_status status);
