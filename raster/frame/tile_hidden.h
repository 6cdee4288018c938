/* Splats of a tile that are surely hidden, found before its passes. */
#ifndef CONIC_TILE_HIDDEN_H
#define CONIC_TILE_HIDDEN_H

#include "raster/frame/tile.h"

/* Takes the entries that change no pixel of the tile out of its scratch and its n_references, where so many surfaces
 * may lie behind each other that it is worth while. `band` is the tile's, before its first row. */
void conic_tile_leave_hidden_out(conic_tile *tile, const conic_raster_loops *loops, const conic_band *band);

#endif
