/* From tile lists to pixels, without a double: the program of every device. Plain C's own text says whether a splat
 * covers a pixel and how it is shaded; gather.cl uses it a pixel a work-item, lanes.cl mirrors it a tile a work-item.
 */
#define double ulong /* of conic_view: never looked at */
#include "opencl/bins.cl"

#include "raster/tiles/coverage.h"
#include "raster/tiles/shade.c"

#include "opencl/gather.cl"
#include "opencl/lanes.cl"
