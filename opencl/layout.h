/* What the host and the device's programs tell each other: read by both compilers. Beside it they share the records of
 * raster/project/projected.h and conic_view, whose layouts are the same in both. */
#pragma once

#include <stdint.h>

#include "raster/tiles/finish.h"

/* Tiles are the smaller the more work-items share one. Their edge in pixels goes to the programs as CONIC_DEVICE_TILE,
 * and its binary logarithm as CONIC_DEVICE_TILE_BITS, when they are built. */
enum { CONIC_TILE_BITS_OF_PIXELS = 4, CONIC_TILE_BITS_OF_TILES = 5 };

/* The edge of a group of work-items where each has a pixel. */
#define CONIC_DEVICE_GROUP 16

/* Splats that one work-item sets up on a CPU, and numbers that one adds up in a prefix sum. */
#define CONIC_SETUP_SPLATS 256
#define CONIC_SCAN_NUMBERS 1024

/* What of the splats that a device has is not position or tangents. */
#define CONIC_DEVICE_HAS_COLOR 1
#define CONIC_DEVICE_HAS_OPACITY 2

/* What set-up counts. */
enum {
  CONIC_DEVICE_CULLED,
  CONIC_DEVICE_SKIPPED,
  CONIC_DEVICE_FALLBACK,
  CONIC_DEVICE_RAYS,
  CONIC_DEVICE_LAPLACES, /* of the rays */
  CONIC_DEVICE_N_COUNTS
};

/* A footprint in a tile, and which of the tile's blocks its box meets: first and last column and row, four bits each.
 */
typedef struct conic_device_reference {
  uint32_t footprint;
  uint32_t blocks;
} conic_device_reference;

/* What a pixel has added up, between one part of the splats and the next; 16 pixels of a block side by side. In a
 * single pass (the nearest splat wins) the first names hold the nearest splat's fragment. */
enum {
  CONIC_SUM_WEIGHT,
  CONIC_SUM_COLOR,
  CONIC_SUM_NORMAL = CONIC_SUM_COLOR + 3,
  CONIC_SUM_HEAVIEST_WEIGHT = CONIC_SUM_NORMAL + 3,
  CONIC_SUM_NEAREST_IZ,
  CONIC_SUM_HEAVIEST_NORMAL,
  CONIC_SUM_Z = CONIC_SUM_HEAVIEST_NORMAL + 3,
  CONIC_SUM_ID,    /* uint32 */
  CONIC_SUM_COUNT, /* uint32 */
  CONIC_N_SUMS
};

/* A chunk of the frame's triangles: where its records and its entries in the tiles' lists begin. */
typedef struct conic_device_triangle_chunk {
  uint64_t first_record, first_entry;
} conic_device_triangle_chunk;

/* A texture: its levels' texels, and its materials' way to it, are told by how many bytes on from here they are. */
#define CONIC_DEVICE_TEXTURE_LEVELS 17

typedef struct conic_device_texture_level {
  int32_t width, height;
  uint64_t texels;
} conic_device_texture_level;

typedef struct conic_device_texture {
  int32_t wrap, n_levels;
  conic_device_texture_level levels[CONIC_DEVICE_TEXTURE_LEVELS];
} conic_device_texture;

typedef struct conic_device_material {
  float color[3];
  int32_t has_texture;
  uint64_t texture;
} conic_device_material;

/* What is done with a part of the splats where tiles are work-items, as bits. */
enum { CONIC_WALK_VISIBILITY = 1, CONIC_WALK_ACCUMULATE = 2 };

/* The frame as the raster's entries want it. */
typedef struct conic_device_frame {
  int32_t width, height;
  int32_t n_blocks_x; /* of all tiles, so that every tile has 4 × 4 of them */
  int32_t n_tiles_x, n_tiles_y;
  int32_t is_single_pass;
  int32_t is_first, is_last; /* of the parts in which the splats come */
  int32_t keeps_sums;        /* leaves them in memory, though the part is the last */
  int32_t walks;
  int32_t planes; /* that the image has, as bits 1 << conic_plane */
  int32_t shading;
  float world_from_cam[3][3];
  conic_finish_lights lights;
  float exposure;
  float background[4];
  /* Where triangles are drawn, too: they are there before the splats' first part, and the picture is theirs to finish.
   */
  int32_t has_triangles;
  int32_t has_splats; /* besides */
  uint32_t n_triangle_chunks, n_materials;
  uint32_t first_triangle_id;
  float triangle_epsilon;
} conic_device_frame;
