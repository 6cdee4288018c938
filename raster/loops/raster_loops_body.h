/* The renderer's loops in lanes; included by one file an instruction set. */
#include "raster/loops/bin_body.h"
#include "raster/loops/nearest_body.h"
#include "raster/loops/pass_body.h"
#include "raster/loops/project_body.h"
#include "raster/loops/raster_loops.h"
#include "raster/loops/reach_body.h"
#include "raster/loops/resolve_body.h"
#include "raster/loops/triangle_body.h"

CONIC_FILL_LOOPS(conic_raster_loops) {
  *loops = (conic_raster_loops){
      .project = {.project = project},
      .bins = {.keys = keys, .sort = sort, .select = select_references},
      .passes = {CONIC_LANES, visibility, accumulate, nearest, take_nearest},
      .resolve = {.resolve = resolve},
      .triangles = {triangle_vertices, triangles_draw, triangles_hide, triangles_add},
      .texture = {.at_places = texture_at_places},
      .reach = {bound_reach},
  };
}
