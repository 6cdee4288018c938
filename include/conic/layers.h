/* Layered point clouds: any number of samples in a file (.lpc), which is built once in bounded memory. A picture reads
 * only the clouds that it can show (docs/reference/layers.md, docs/reference/format-lpc.md). */
#ifndef CONIC_LAYERS_H
#define CONIC_LAYERS_H

#include "conic/splats.h"

CONIC_BEGIN_C

typedef struct conic_layers_options {
  size_t size;           /* sizeof(conic_layers_options), set by the init function */
  uint32_t cloud_size;   /* M: samples of most clouds, about; 64 to 32768 */
  uint64_t memory_bytes; /* what building may take, without temporary files; the file does not depend on it */
  double quantum;        /* step of the positions: a length, or in sampling distances if the next flag is set */
  int quantum_in_spacings;
  float cutoff;  /* F_g of the kernel that will draw */
  int keeps_all; /* ellipses, opacities and clip lines are kept, too, with fine steps */
  /* To go on with a file that there is (conic_layers_continue): steps count from this corner, and their length is
   * `quantum`. Where samples lie below the corner, steps count from one that is whole steps away. Normals have no
   * side. */
  int has_corner, is_unoriented;
  double corner[3];
  double up[3];  /* the direction that points up, of any length; zero: unknown */
  uint32_t epsg; /* the code of the coordinate system; 0: unknown */
} conic_layers_options;

/* Clouds of 2048 samples, 1 GiB, half a sampling distance, cutoff 1.5. */
CONIC_API void conic_layers_options_init_sized(conic_layers_options *options, size_t size);
#define conic_layers_options_init(options) conic_layers_options_init_sized(options, sizeof *(options))

/* A file that is being built. */
typedef struct conic_layers_builder conic_layers_builder;

typedef struct conic_layers_statistics {
  uint64_t n_in, n_samples;   /* samples handed in, and kept */
  uint64_t n_nan;             /* samples left out: positions that are not finite */
  uint64_t n_zero;            /* samples kept with a normal or size from the neighbours, for they had none */
  uint64_t n_clouds, n_bytes; /* of the file */
  int n_levels;
  double spacing, quantum; /* the sampling distance, and the step of the positions */
  double read_seconds, work_seconds, write_seconds;
  uint64_t reserved[8];
} conic_layers_statistics;

/* Starts to build PATH, which appears under its name only when it is whole. Temporary files have no name, lie in the
 * folder of PATH and take up to 60 bytes a sample. On success the caller owns *builder and ends it with finish or
 * abandon. Null `options` are the defaults. Errors: ARGUMENT, MEMORY, IO, UNSUPPORTED (built without zstd). */
CONIC_API conic_status conic_layers_builder_open(conic_context *context, const char *path,
                                                 const conic_layers_options *options, conic_layers_builder **builder);
/* Hands over a batch, of any size; it is copied. All batches have colours or none has. A sample is a position, a normal
 * (the batch's, or t_u × t_v) and a size: its outline's, or from the neighbours where it has no axes. With `keeps_all`
 * it is an ellipse with its opacity and clip lines. The values that the first batch has by name are kept. Errors:
 * ARGUMENT, MEMORY, IO, CANCELLED. */
CONIC_API conic_status conic_layers_builder_append(conic_layers_builder *builder, const conic_splats *batch);
/* Builds and writes the file, and releases the builder, on failure too. The file depends on the samples in their order,
 * cloud_size and quantum alone: not on threads or memory. `statistics` may be null. Errors: INPUT (nothing to draw),
 * MEMORY, IO, CANCELLED. */
CONIC_API conic_status conic_layers_builder_finish(conic_layers_builder *builder, conic_layers_statistics *statistics);
/* Drops all of it; null is allowed. */
CONIC_API void conic_layers_builder_abandon(conic_layers_builder *builder);

/* Whether a file that can be read begins like a .lpc. */
CONIC_API int conic_layers_is_file(const char *path);

/* Whether a file that can be read is the first of another kind's hierarchy of points: a COPC, an ept.json, or the
 * metadata.json of Potree 2; or a folder with one of the latter two. conic_layers_open opens these, too. */
CONIC_API int conic_layers_is_hierarchy(const char *path);

typedef struct conic_layers_info {
  uint64_t n_samples, n_clouds, n_bytes;
  int n_levels;
  uint32_t cloud_size, most_samples; /* asked for; and of the largest cloud */
  int has_colors, is_unoriented;
  double minimum[3], maximum[3]; /* of the finite centres that it was built from */
  double spacing, quantum;       /* the sampling distance, and the step of the positions */
  double position_error;         /* no sample was moved farther */
  double splat_radius;           /* median outline of the samples at full resolution */
  double near_z;                 /* as conic_default_near of what it was built from */
  /* Bits a sample. */
  double bits_position, bits_normal, bits_color, bits_index;
  double bits_more; /* sizes, opacities, clip lines and values */
  double up[3];     /* unit: the direction that points up; zero: it is not known */
  uint64_t reserved[4];
} conic_layers_info;

/* Reads and checks header and index. Errors: INPUT, MEMORY. */
CONIC_API conic_status conic_layers_describe(conic_context *context, const char *path, conic_layers_info *info);

/* What is wrong in a file: how many clouds break their bounds. */
typedef struct conic_layers_defects {
  uint64_t clouds;   /* the bytes are not those that were written, or make no cloud */
  uint64_t coverage; /* a sample of its place is farther from the drawn ones than its covering radius */
  uint64_t spheres;  /* a sample reaches out of the sphere */
  uint64_t cones;    /* a normal is outside the cone */
  uint64_t reserved[8];
} conic_layers_defects;

/* Decodes every cloud and looks at every sample of every node. Errors: INPUT (header or index are damaged), MEMORY,
 * UNSUPPORTED, CANCELLED. */
CONIC_API conic_status conic_layers_check(conic_context *context, const char *path, conic_layers_defects *defects);

CONIC_END_C
#endif
