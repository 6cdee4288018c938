/* A device that is ready to draw: its queue, its programs' entries, its memory. */
#pragma once

#include "gaussians/draw/gaussian_device.h"
#include "opencl/queue.h"
#include "raster/frame/backend.h"

/* What a program can be entered by (OpenCL calls it a kernel): those of setup.cl, of raster.cl, of triangles.cl and of
 * gaussians.cl; of VISIBILITY and what follows, the kind that suits the device. */
typedef enum conic_entry_name {
  CONIC_ENTRY_PROJECT,
  CONIC_ENTRY_PROJECT_LANES,
  CONIC_ENTRY_SCAN_SUMS,
  CONIC_ENTRY_SCAN_TOPS,
  CONIC_ENTRY_SCAN_PLACES,
  CONIC_ENTRY_COMPACT,
  CONIC_ENTRY_COUNT_TILES,
  CONIC_ENTRY_PLACE_CHUNKS,
  CONIC_ENTRY_FILL_TILES,
  CONIC_ENTRY_VISIBILITY,
  CONIC_ENTRY_ACCUMULATE,
  CONIC_ENTRY_NEAREST,
  CONIC_ENTRY_TRIANGLES,
  CONIC_ENTRY_ADD_TRIANGLES,
  CONIC_ENTRY_GAUSSIANS,
  CONIC_N_ENTRY_NAMES
} conic_entry_name;

/* Of a splat set: position, tangent_u, tangent_v, colour, opacity. */
enum { CONIC_N_COLUMNS = 13 };

typedef enum conic_buffer_name {
  CONIC_BUFFER_VIEW,
  CONIC_BUFFER_PROFILE, /* its table */
  CONIC_BUFFER_FRAME,
  CONIC_BUFFER_COLUMNS,
  CONIC_BUFFER_CLIPS = CONIC_BUFFER_COLUMNS + CONIC_N_COLUMNS,
  CONIC_BUFFER_FOOTPRINTS,
  CONIC_BUFFER_BOXES,
  CONIC_BUFFER_SURFACES,
  CONIC_BUFFER_RAYS,
  CONIC_BUFFER_CLIP_RECORDS,
  CONIC_BUFFER_N_DRAWN, /* an item of set-up */
  CONIC_BUFFER_COUNTS,  /* CONIC_DEVICE_CULLED … */
  CONIC_BUFFER_PLACES,  /* where each item's drawn splats begin in `order` */
  CONIC_BUFFER_SCAN_SUMS,
  CONIC_BUFFER_ORDER,       /* the drawn splats' records, in file order */
  CONIC_BUFFER_TILE_COUNTS, /* [chunk][tile] */
  CONIC_BUFFER_TILE_TOTALS,
  CONIC_BUFFER_TILE_BEGIN,
  CONIC_BUFFER_REFERENCES,
  CONIC_BUFFER_SELECTED,    /* where a tile's references of one row of blocks are copied to; by tiles only */
  CONIC_BUFFER_THRESHOLDS,  /* [block][pixel] */
  CONIC_BUFFER_SUMS,        /* [block][CONIC_SUM_WEIGHT …][pixel] */
  CONIC_BUFFER_N_FRAGMENTS, /* a tile */
  CONIC_BUFFER_N_COVERED,   /* a tile */
  CONIC_BUFFER_DIRECTIONS_X,
  CONIC_BUFFER_DIRECTIONS_Y,
  CONIC_BUFFER_TRIANGLE_IZ,        /* [block][pixel]: of the nearest triangle; 0: there is none */
  CONIC_BUFFER_TRIANGLE_NEAREST,   /* likewise: its record */
  CONIC_BUFFER_TRIANGLE_FRAGMENTS, /* a tile: in two words */
  CONIC_BUFFER_TRIANGLE_CHUNKS,
  CONIC_BUFFER_TRIANGLE_MATERIALS, /* and textures */
  CONIC_BUFFER_PLANES,
  /* Of the frame's triangles and their set: */
  CONIC_BUFFER_TRIANGLE_RECORDS = CONIC_BUFFER_PLANES + CONIC_N_DRAWN_PLANES,
  CONIC_BUFFER_TRIANGLE_ENTRIES,
  CONIC_BUFFER_TRIANGLE_TILES,
  CONIC_BUFFER_TRIANGLE_PIECES,
  CONIC_BUFFER_TRIANGLE_CORNERS,
  CONIC_BUFFER_TRIANGLE_NORMAL_CORNERS,
  CONIC_BUFFER_TRIANGLE_TEXTURE_CORNERS,
  CONIC_BUFFER_TRIANGLE_MATERIAL,
  CONIC_BUFFER_TRIANGLE_POSITIONS,
  CONIC_BUFFER_TRIANGLE_COLORS = CONIC_BUFFER_TRIANGLE_POSITIONS + 3,
  CONIC_BUFFER_TRIANGLE_NORMALS = CONIC_BUFFER_TRIANGLE_COLORS + 3,
  CONIC_BUFFER_TRIANGLE_COORDINATES = CONIC_BUFFER_TRIANGLE_NORMALS + 3,
  /* Of a picture of Gaussians: */
  CONIC_BUFFER_GAUSSIAN_PICTURE = CONIC_BUFFER_TRIANGLE_COORDINATES + 2,
  CONIC_BUFFER_GAUSSIAN_TILE_BEGIN,
  CONIC_BUFFER_GAUSSIAN_ENTRIES,
  CONIC_BUFFER_GAUSSIAN_FOOTPRINTS,
  CONIC_BUFFER_GAUSSIAN_RAYS,
  CONIC_BUFFER_GAUSSIAN_NORMALS,
  CONIC_BUFFER_GAUSSIAN_ROOM,
  CONIC_BUFFER_GAUSSIAN_PLANES, /* nine, as conic_gaussian_planes has them */
  CONIC_N_BUFFER_NAMES = CONIC_BUFFER_GAUSSIAN_PLANES + 9
} conic_buffer_name;

/* Which splats the buffers of columns and clip lines hold, whole, from one picture to the next. */
typedef struct conic_splats_on_device {
  uint64_t version; /* 0: none */
  size_t count, n_clips;
  const float *columns[CONIC_N_COLUMNS];
  const conic_clip *clips;
} conic_splats_on_device;

typedef struct conic_opencl {
  conic_backend backend; /* first: what the renderer has */
  conic_gaussian_device gaussian_device;
  conic_context *context;
  conic_opencl_device device;
  conic_opencl_work work; /* tiles or pixels */
  int tile;               /* a tile's edge in pixels */
  int projects_on_host;
  size_t part_splats; /* 0: by the device's memory */
  int keeps_sums;     /* for who wants to look at them */
  conic_queue queue;
  cl_device_id id;
  char *cache_folder; /* null: built programs are kept nowhere */
  cl_program setup, raster, triangles, gaussians;
  cl_kernel entries[CONIC_N_ENTRY_NAMES];
  conic_buffer buffers[CONIC_N_BUFFER_NAMES];
  conic_splats_on_device kept;
} conic_opencl;

/* Opens the device that the options ask for. On success the caller ends *opened with conic_opencl_close. Errors: as
 * conic_opencl_renderer_create. */
conic_status conic_opencl_open(conic_context *context, const conic_opencl_options *options, conic_opencl **opened);
void conic_opencl_close(conic_opencl *opencl);

/* Builds what splats need, if nobody needed it before. Errors: UNSUPPORTED, MEMORY. */
conic_status conic_opencl_need_splats(conic_opencl *opencl);
/* Likewise of triangles. Errors: UNSUPPORTED (also where the device has no double precision), MEMORY. */
conic_status conic_opencl_need_triangles(conic_opencl *opencl);
/* Likewise of Gaussians, which need no double precision. */
conic_status conic_opencl_need_gaussians(conic_opencl *opencl);

/* The slot of the Gaussians' device. */
conic_status conic_opencl_composite(conic_gaussian_device *device, const conic_gaussian_composition *composition);
