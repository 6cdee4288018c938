/* A .lpc of Gaussians in levels, from a file or a URL: what a picture shows is read by ranges, and no more. */
#pragma once

#include "conic/camera.h"
#include "conic/layers_draw.h"
#include "lod/blends/levels_format.h"
#include "lod/ranges/ranges.h"

/* A cloud in memory: its columns, and of each Gaussian whether the last cut went on below it. */
typedef struct conic_levels_loaded {
  uint32_t *columns;
  unsigned char *is_open;
} conic_levels_loaded;

typedef struct conic_levels {
  conic_context *context;
  char *name;
  conic_ranges *ranges;
  conic_zstd *zstd;
  conic_levels_header header;
  conic_levels_shape shape;
  conic_levels_entry *entries;
  conic_levels_loaded *clouds; /* by number; columns null: not in memory */
  uint64_t memory_bytes, n_read;
  double until_s; /* opening ends */
} conic_levels;

/* Opens a path or a URL: reads and checks header and index. Null `access` is the defaults. On success the caller owns
 * *levels. Errors: INPUT, IO, UNSUPPORTED, MEMORY, CANCELLED. */
conic_status conic_levels_open(conic_context *context, const char *name, const conic_layers_access *access,
                               conic_levels **levels);
/* Null is allowed. */
void conic_levels_close(conic_levels *levels);

/* Brings clouds into memory. Errors: INPUT (damaged), IO, MEMORY, CANCELLED. */
conic_status conic_levels_load(conic_levels *levels, const uint32_t *clouds, size_t n);
void conic_levels_drop(conic_levels *levels, uint32_t cloud);

/* So many are read whole for framing, as other scenes are; of more, what stands at the root tells where they are. */
enum { CONIC_LEVELS_MOST_WHOLE = 1 << 18 };

/* What is taken: the Gaussians of a cut; all as they came, whatever a camera sees, in any memory; or the root's. */
typedef enum conic_levels_part { CONIC_LEVELS_CUT, CONIC_LEVELS_ALL, CONIC_LEVELS_ROOT } conic_levels_part;

/* What is left of the light, by pixel of a picture that may be small: the depths from which it is no more than a half,
 * a quarter and so on; infinite: nowhere. */
enum { CONIC_VEIL_HALVES = 8 };
typedef struct conic_levels_veil {
  conic_camera camera; /* a pinhole where the picture's is */
  float *depths;
} conic_levels_veil;

typedef struct conic_levels_wish {
  conic_levels_part part;
  double error;    /* 0: all, or as the budget and memory allow */
  uint64_t budget; /* of all scenes together; 0: none */
  double dilation; /* px² that are added to variances, where what is added is not taken from the opacity */
  const conic_levels_veil *veil; /* null: all light is left everywhere */
} conic_levels_wish;

typedef struct conic_levels_cut {
  double error;         /* kept */
  uint64_t n, n_merged; /* drawn */
  int is_all, is_short; /* all that there is; is_short: the memory made it coarser than it was to be */
} conic_levels_cut;

/* One of the scenes of a picture. */
typedef struct conic_levels_scene {
  conic_levels *levels;
  conic_camera camera; /* as the file sees it */
  double unit;         /* a length there is so long in the veil's space */
  conic_gaussians set; /* what is chosen; the caller releases it */
  conic_levels_cut cut;
} conic_levels_scene;

/* How many Gaussians of n scenes together can be drawn in the memory that there is. */
uint64_t conic_levels_most(const conic_levels_scene *scenes, size_t n);

/* Chooses Gaussians of n scenes by one error, also where a budget or the memory sets it. Errors: as conic_levels_load,
 * and INPUT (the least that a picture can have of them is more than may be drawn). */
conic_status conic_levels_choose(conic_levels_scene *scenes, size_t n, const conic_levels_wish *wish);

/* Reads all of a file as a scene. Errors: as conic_levels_open. */
conic_status conic_levels_read(conic_context *context, const char *path, conic_gaussians *set);

/* Decodes every cloud, and counts those that are damaged, and those with a bound below that of what it stands for.
 * Errors: as conic_levels_open. */
conic_status conic_levels_check(conic_levels *levels, uint64_t *n_damaged, uint64_t *n_unbounded);
