/* Drawing layered point clouds, from a file or a URL: a picture reads and draws only the clouds that it shows, in
 * bounded memory (docs/reference/layers.md). */
#ifndef CONIC_LAYERS_DRAW_H
#define CONIC_LAYERS_DRAW_H

#include "conic/coloring.h"
#include "conic/layers.h"
#include "conic/transparency.h"

CONIC_BEGIN_C

/* A file that is open for drawing: its index, and a cache of its clouds. One thread at a time. */
typedef struct conic_layers conic_layers;

/* How a file is read. Only memory_bytes and `seconds` also count for local files. */
typedef struct conic_layers_access {
  size_t size;            /* sizeof(conic_layers_access), set by the init function */
  uint64_t memory_bytes;  /* what drawing may take: a program of 14 MiB and 2 a thread, index, image, clouds, and the
                             splats drawn from them. At least an eighth is for the last two; 8 × 8 samples need more on
                             top. What does not fit goes to a file without a name in $TMPDIR, $TEMP or /var/tmp */
  double connect_seconds; /* a server that is not reached within so many is asked again */
  double stall_seconds;   /* a server that sends under 8 KiB/s for so long is asked again */
  int n_retries;          /* how often it is asked again, with growing pauses, before a cloud is given up */
  double pause_seconds;   /* the first pause */
  int n_connections;      /* at a time, 1 to 16 */
  double seconds;         /* opening fails so many after the call; 0: no limit */
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

/* Makes colours from a value that the samples have by name, and leaves out samples that `where` does not pass (as
 * conic_read_options has it); either may be null. With "auto", samples without colours get them from the intensity.
 * *done, which may be null, says what the colours mean. Call it before anything is drawn; it drops the clouds in the
 * cache. With a filter, a coarse place draws those of its samples that pass: each is within the error of itself at full
 * resolution, but samples that are hidden at full resolution may show. Errors: ARGUMENT, INPUT (the samples have no
 * such value), MEMORY. */
CONIC_API conic_status conic_layers_choose(conic_layers *layers, const conic_coloring_options *coloring,
                                           const char *where, conic_coloring *done);

/* "lpc", "copc", "ept" or "potree". */
CONIC_API const char *conic_layers_kind_name(const conic_layers *layers);

/* What a picture depends on as a whole. */
typedef struct conic_layers_scale {
  uint64_t n_samples, n_clouds;
  int n_levels;
  int has_colors;
  double minimum[3], maximum[3]; /* box of the finite centres, as conic_splats_bounds */
  double near_z;                 /* as conic_default_near of what it was built from */
  double splat_length;           /* for conic_render_options: of the samples at full resolution */
  double spacing;                /* median sampling distance */
  double up[3];                  /* unit: what points up; zero: the file does not say */
  uint64_t reserved[5];
} conic_layers_scale;

/* `cutoff` is F_g of the kernel that will draw. */
CONIC_API void conic_layers_measure(const conic_layers *layers, float cutoff, conic_layers_scale *scale);

typedef enum conic_occlusion {
  CONIC_OCCLUSION_AUTO = 0, /* where the index says that it pays */
  CONIC_OCCLUSION_ON = 1,
  CONIC_OCCLUSION_OFF = 2
} conic_occlusion;

typedef struct conic_layers_draw_options {
  size_t size;               /* sizeof(conic_layers_draw_options), set by the init function */
  double error_px;           /* the greatest error on the screen; 0: full resolution */
  uint64_t budget;           /* or, where not 0: the least error that this many splats can give; a coarsest cloud with
                                more is drawn by so many of it, evenly chosen */
  int most_levels;           /* no cloud below so many levels is drawn; 0: all are */
  conic_occlusion occlusion; /* leave out what is hidden; changes no bit of the image */
  int samples;               /* N × N a pixel, as conic_render_samples */
  int may_be_coarser;        /* what does not come, or not in time, is drawn coarser, without an error */
  double seconds;            /* with may_be_coarser: nothing is read later than so many after the call; 0: no limit */
  int tolerates_damage;      /* with may_be_coarser: damaged clouds are drawn coarser, too, and a warning names the
                                first of them */
  conic_transparency transparency; /* as in conic_render_transparent, where the samples keep their opacities. Hidden
                                      clouds are then read, too, and everything has to fit into memory at once */
  double chance;                   /* as in conic_render_transparent */
  int only_samples;                /* coarse places are drawn as some of their samples, not as stand-ins */
  int reserved_int;
} conic_layers_draw_options;

/* Full resolution, one sample, automatic occlusion. */
CONIC_API void conic_layers_draw_options_init_sized(conic_layers_draw_options *options, size_t size);
#define conic_layers_draw_options_init(options) conic_layers_draw_options_init_sized(options, sizeof *(options))

/* What a picture took. Places are cells of space that were chosen, each with the samples that all clouds have there. */
typedef struct conic_layers_drawn {
  double error_px;           /* asked for, or what the budget led to; infinite: less than the coarsest cloud was
                                drawn */
  double missing_error_px;   /* the greatest error of a place that is coarser than asked for; 0: no place is */
  uint64_t n_places;         /* in sight */
  uint64_t n_places_hidden;  /* of n_places, wholly hidden: nothing of them was drawn */
  uint64_t n_places_grazing; /* hidden except for splats seen nearly from their edge, which were drawn */
  uint64_t n_places_coarser; /* for want of clouds */
  uint64_t n_clouds;         /* drawn, in whole or in part */
  uint64_t n_clouds_grazing; /* of n_clouds: only such splats were drawn, in all its places */
  uint64_t n_clouds_culled;  /* out of sight, or hidden */
  uint64_t n_clouds_missing; /* could not be read, or not in time */
  uint64_t n_clouds_read;    /* and decoded; the others were in the cache */
  uint64_t n_splats_left;    /* of the drawn places: hidden, not drawn */
  uint64_t n_bytes_received; /* over the network, since the last picture or the opening */
  int n_bands;               /* in so many the picture was drawn */
  int n_levels;              /* of the deepest cloud drawn, plus 1 */
  uint64_t n_clouds_damaged; /* of n_clouds_missing: they came and were wrong */
  uint64_t n_splats_turned;  /* of the drawn places: facing away, culled before drawing */
  uint64_t reserved[6];
} conic_layers_drawn;

/* Draws into the planes that `image` has, as conic_render does; `id` is the number of the sample in the file (modulo
 * 2³²). near_z and splat_length, where 0 in `render`, are the file's. The picture depends on file, camera and options
 * alone: not on memory, cache, order of arrival, occlusion, or where the file lies. With may_be_coarser it also depends
 * on what arrives in time. `statistics` and `drawn` may be null. Errors: ARGUMENT, INPUT (damaged; a server that
 * answers wrongly), IO (network), UNSUPPORTED (bands on another device), MEMORY (also where transparency does not fit
 * into the access' memory_bytes), CANCELLED. */
CONIC_API conic_status conic_layers_draw(conic_layers *layers, conic_renderer *renderer, const conic_camera *camera,
                                         const conic_render_options *render, const conic_layers_draw_options *options,
                                         conic_image *image, conic_render_statistics *statistics,
                                         conic_layers_drawn *drawn);

/* All samples at full resolution, with axes for `cutoff`, in the order of the file. The caller releases *splats.
 * Errors: as conic_layers_draw. */
CONIC_API conic_status conic_layers_splats(conic_layers *layers, float cutoff, conic_splats *splats);

/* All points of a hierarchy of another kind than .lpc (conic_layers_is_hierarchy), as they are there, node by node:
 * with positions and, where it has them, colours. Errors: INPUT, IO, MEMORY, UNSUPPORTED (a .lpc), CANCELLED, the
 * receiver's. */
CONIC_API conic_status conic_layers_stream(conic_layers *layers, conic_batch_receiver *receive, void *cookie);

/* Reads all of such a hierarchy, and counts damaged nodes and pages; 0 for a .lpc. Errors: IO, MEMORY, CANCELLED. */
CONIC_API conic_status conic_layers_count_damaged(conic_layers *layers, uint64_t *n_damaged);

/* Which samples are read, and how finely. Places outside of the box are left out; places at its borders also bring
 * samples outside of it. A place is read no finer than its error has to be. */
typedef struct conic_layers_region {
  size_t size;            /* sizeof(conic_layers_region), set by the init function */
  double low[3], high[3]; /* in world units; infinite: no bound */
  double error;           /* in world units; 0: full resolution */
  const char *keep;       /* the values to read by name, "intensity, gps_time" or "all"; null: none */
} conic_layers_region;

/* No bounds, full resolution, no values. */
CONIC_API void conic_layers_region_init_sized(conic_layers_region *part, size_t size);
#define conic_layers_region_init(part) conic_layers_region_init_sized(part, sizeof *(part))

/* Reads the samples of a region, with axes for `cutoff`, batch by batch; each place's samples come after those of the
 * places before it. A null `part` is all of the file. Errors: ARGUMENT, INPUT (the samples have no such value), as
 * conic_layers_draw, and the receiver's. */
CONIC_API conic_status conic_layers_read_samples(conic_layers *layers, float cutoff, const conic_layers_region *part,
                                                 conic_batch_receiver *receive, void *cookie);

/* The i-th value that the samples have by name; returns 0 past the last. */
CONIC_API int conic_layers_value(const conic_layers *layers, size_t i, conic_model_field *field);

/* Sets `options` for a file that is built from these samples and others: these samples stay where they are on its grid,
 * and it keeps as much of each, and has their `up`. */
CONIC_API void conic_layers_continue(const conic_layers *layers, conic_layers_options *options);

/* A picture of how the samples are divided: `image` with the boxes of the places of a level, in a colour each, fainter
 * behind what is drawn. The root's level is 0; below 0 stands for the one with the most places, but 64 at most.
 * `image` was drawn with this camera, and has rgba and Z. On success the caller owns *map. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_layers_draw_boxes(conic_layers *layers, const conic_camera *camera, int level,
                                               const conic_image *image, conic_image *map);

CONIC_END_C
#endif
