/* The renderer's kernels in lanes; included by one file an instruction set. */
#include "raster/kernels/bin_body.h"
#include "raster/kernels/nearest_body.h"
#include "raster/kernels/pass_body.h"
#include "raster/kernels/project_body.h"
#include "raster/kernels/raster_kernels.h"
#include "raster/kernels/resolve_body.h"
#include "raster/kernels/triangle_body.h"

CONIC_FILL_KERNELS(conic_raster_kernels) {
  *kernels = (conic_raster_kernels){
      .project = {.project = project},
      .bins = {.keys = keys, .sort = sort, .select = select_references},
      .passes = {CONIC_LANES, visibility, accumulate, nearest, take_nearest},
      .resolve = {.resolve = resolve},
      .triangles = {triangle_vertices, triangles_draw, triangles_hide, triangles_add},
      .texture = {.at_places = texture_at_places},
  };
}
