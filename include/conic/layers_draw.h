/* Drawing layered point clouds: of a file or a URL, a picture reads and draws no more clouds than it shows, in bounded
 * memory (docs/reference/layers.md). */
#ifndef CONIC_LAYERS_DRAW_H
#define CONIC_LAYERS_DRAW_H

#include <stddef.h>
#include <stdint.h>

#include "conic/camera.h"
#include "conic/context.h"
#include "conic/image.h"
#include "conic/layers.h"
#include "conic/render.h"
#include "conic/splats.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A file that is open for drawing: its index, and a cache of its clouds. One thread at a time. */
typedef struct conic_layers conic_layers;

/* How a file is read. All but the first and the last are of URLs alone. */
typedef struct conic_layers_access {
  size_t size;            /* sizeof(conic_layers_access), set by the init function */
  uint64_t memory_bytes;  /* what clouds, read and gathered, may take along with what is drawn of them; index, image and
                             the least that one row of tiles needs come on top */
  double connect_seconds; /* a server that is not reached within these is asked again */
  double stall_seconds;   /* so is one that sends under 1 KiB/s for so long */
  int n_retries;          /* so often, with growing pauses, before a cloud is given up */
  double pause_seconds;   /* the first pause */
  int n_connections;      /* at a time, 1 to 16 */
  double seconds;         /* opening fails after so many from the call; 0: no limit */
} conic_layers_access;

/* 512 MiB; 10 s, 15 s, 4 retries from 0.2 s on, 4 connections, no limit. */
CONIC_API void conic_layers_access_init_sized(conic_layers_access *access, size_t size);
#define conic_layers_access_init(access) conic_layers_access_init_sized(access, sizeof *(access))

/* Whether a name is an http:// or https:// URL. */
CONIC_API int conic_layers_is_url(const char *name);

/* Opens a path or a URL: reads and checks header and index. Null `access` is the defaults. On success the caller owns
 * *layers, which must not outlive the context. With a libcurl older than 7.84 the first URL has to be opened while no
 * other thread of the program uses libcurl. Errors: INPUT (it is damaged, or the server answers wrongly), IO (network,
 * server, time), UNSUPPORTED (built without zstd, or, for URLs, libcurl), MEMORY, CANCELLED. */
CONIC_API conic_status conic_layers_open(conic_context *context, const char *name, const conic_layers_access *access,
                                         conic_layers **layers);
/* Null is allowed. */
CONIC_API void conic_layers_close(conic_layers *layers);

/* What a picture depends on as a whole. */
typedef struct conic_layers_scale {
  uint64_t n_samples, n_clouds;
  int n_levels;
  int has_colors;
  double minimum[3], maximum[3]; /* box of the finite centres, as conic_splats_bounds */
  double near_z;                 /* as conic_default_near of what it was built from */
  double splat_length;           /* for conic_render_options: of the samples at full resolution */
  double spacing;                /* median sampling distance */
  uint64_t reserved[8];
} conic_layers_scale;

/* `cutoff` is F_g of the kernel that will draw. */
CONIC_API void conic_layers_measure(const conic_layers *layers, float cutoff, conic_layers_scale *scale);

typedef enum conic_occlusion {
  CONIC_OCCLUSION_AUTO = 0, /* where the index promises that it pays */
  CONIC_OCCLUSION_ON = 1,
  CONIC_OCCLUSION_OFF = 2
} conic_occlusion;

typedef struct conic_layers_draw_options {
  size_t size;               /* sizeof(conic_layers_draw_options), set by the init function */
  double error_px;           /* the greatest error on the screen; 0: full resolution */
  uint64_t budget;           /* or, where not 0: the least error that this many splats can give */
  int most_levels;           /* no cloud below so many levels is drawn; 0: all */
  conic_occlusion occlusion; /* leave out what is hidden; changes no bit of the image */
  int samples;               /* N × N a pixel, as conic_render_samples */
  int may_be_coarser;        /* what does not come, or not in time, is drawn coarser in place of an error */
  double seconds;            /* with that: no more is read after so many seconds from the call; 0: no limit */
  int tolerates_damage;      /* with that: so is what is damaged, and a warning names the first of it */
} conic_layers_draw_options;

/* Full resolution, one sample, automatic occlusion. */
CONIC_API void conic_layers_draw_options_init_sized(conic_layers_draw_options *options, size_t size);
#define conic_layers_draw_options_init(options) conic_layers_draw_options_init_sized(options, sizeof *(options))

/* What a picture took. Places are what was chosen: cells of space, each with the samples that all clouds have there. */
typedef struct conic_layers_drawn {
  double error_px;           /* asked for, or what the budget came to */
  double missing_error_px;   /* the greatest error of a place that is coarser than asked for; 0: none is */
  uint64_t n_places;         /* in sight */
  uint64_t n_places_hidden;  /* of these, wholly hidden: nothing of them was drawn */
  uint64_t n_places_grazing; /* hidden but for splats seen nearly from their edge, which alone were drawn */
  uint64_t n_places_coarser; /* for want of clouds */
  uint64_t n_clouds;         /* drawn of, in whole or in part */
  uint64_t n_clouds_grazing; /* of these, none but such splats of any of its places */
  uint64_t n_clouds_culled;  /* out of sight, or hidden */
  uint64_t n_clouds_missing; /* could not be read, or not in time */
  uint64_t n_clouds_read;    /* and decoded; the others were in the cache */
  uint64_t n_splats_left;    /* of the places, hidden and not drawn */
  uint64_t n_bytes_received; /* over the network, since the picture before or the opening */
  int n_bands;               /* the picture was drawn in so many */
  int n_levels;              /* of the deepest cloud drawn, plus 1 */
  uint64_t n_clouds_damaged; /* of those missing, what came and was wrong */
  uint64_t reserved[7];
} conic_layers_drawn;

/* Draws into the planes that `image` has, as conic_render does; `id` is the number of the sample in the file (modulo
 * 2³²). near_z and splat_length, where 0 in `render`, are the file's. The picture depends on file, camera and options
 * alone: not on memory, cache, order of arrival, occlusion, or where the file lies; with may_be_coarser, on what there
 * is in time, too. `statistics` and `drawn` may be null. Errors: ARGUMENT (a budget below the coarsest cloud, too),
 * INPUT (damaged; a server that answers wrongly), IO (network), UNSUPPORTED (bands on another device), MEMORY,
 * CANCELLED. */
CONIC_API conic_status conic_layers_draw(conic_layers *layers, conic_renderer *renderer, const conic_camera *camera,
                                         const conic_render_options *render, const conic_layers_draw_options *options,
                                         conic_image *image, conic_render_statistics *statistics,
                                         conic_layers_drawn *drawn);

/* All samples at full resolution, with axes for `cutoff`, in the order of the file. The caller releases *splats.
 * Errors: as conic_layers_draw. */
CONIC_API conic_status conic_layers_splats(conic_layers *layers, float cutoff, conic_splats *splats);

#ifdef __cplusplus
}
#endif
#endif
