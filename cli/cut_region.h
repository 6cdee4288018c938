/* The part of the world that conic cut keeps. */
#pragma once

#include "conic/splats.h"

typedef struct cli_cut_region {
  double low[3], high[3];   /* infinite: no bound */
  double (*corners)[2];     /* of the polygons in x and y; null: none */
  size_t n_corners, n_ends; /* ends[i]: one past the last corner of polygon i */
  size_t *ends;
} cli_cut_region;

void cli_cut_region_init(cli_cut_region *region);
void cli_cut_region_release(conic_context *context, cli_cut_region *region);

/* A box for cli_option.parse: "X0,Y0,Z0,X1,Y1,Z1", or "X0,Y0,X1,Y1" for all heights. `cookie` is a cli_cut_region. */
int cli_cut_parse_box(const char *text, void *cookie);

/* Reads polygons: lines of x and y, and an empty line between two polygons; # begins a comment. What lies in an odd
 * number of them is kept. The region's box becomes no larger than theirs. Errors: INPUT, MEMORY. */
conic_status cli_cut_read_polygons(conic_context *context, const char *path, cli_cut_region *region);

/* Makes a set of those splats of a batch that lie in the region, clip lines, values by name and all. On failure it is
 * empty. Errors: MEMORY. */
conic_status cli_cut_take(conic_context *context, const cli_cut_region *region, const conic_splats *batch,
                          conic_splats *kept);
