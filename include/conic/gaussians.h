/* Gaussian scenes: what 3D and 2D Gaussian splatting trains, as its files hold it.
 *
 * A Gaussian: a mean, standard deviations along three axes (two of a 2D Gaussian, whose plane is that of the first two
 * axes), a rotation, an opacity and spherical harmonics, the colour by direction. What files keep as logarithm or logit
 * is linear here. Nothing is put right: what cannot be drawn (NaN, a zero rotation …) is there as the file has it, and
 * conic_gaussians_find_defects counts it. Structure of arrays, but for the harmonics. */
#ifndef CONIC_GAUSSIANS_H
#define CONIC_GAUSSIANS_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"
#include "conic/model.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CONIC_MAX_SH_DEGREE = 4 };

/* The formats of Gaussian scenes (docs/reference/gaussian-files.md). */
typedef enum conic_gaussian_kind {
  CONIC_GAUSSIANS_PLY = 0,
  CONIC_GAUSSIANS_COMPRESSED_PLY = 1,
  CONIC_GAUSSIANS_SPLAT = 2,
  CONIC_GAUSSIANS_SPZ = 3,
  CONIC_GAUSSIANS_SOG = 4, /* a folder with meta.json, or a zip */
  CONIC_GAUSSIANS_GLTF = 5,
  CONIC_GAUSSIANS_GLB = 6
} conic_gaussian_kind;
enum { CONIC_N_GAUSSIAN_KINDS = 7 };

/* "ply", "compressed-ply", "splat", "spz", "sog", "gltf", "glb"; null for a number that is no kind. */
CONIC_API const char *conic_gaussian_kind_name(conic_gaussian_kind kind);

typedef struct conic_gaussians {
  size_t count;
  double origin[3];   /* the mean of Gaussian i is origin + position[.][i], formed in double */
  float *position[3]; /* never null */
  float *scale[3];    /* standard deviations in world units; scale[2] is null in a set of 2D Gaussians */
  float *rotation[4]; /* quaternions w, x, y, z as the file has them, of any length: whoever draws normalises them */
  float *opacity;     /* 0 to 1 */

  /* Harmonics: of Gaussian i those of all orders, lowest first, each red, green, blue, (sh_degree + 1)² × 3 numbers
   * from sh[i × (sh_degree + 1)² × 3] on. The colour is max(0, ½ + Σ sh·Y), Y the real harmonics of 3DGS (Y₀ =
   * 0.28209…; of degree 1 −y, z, −x times 0.4886…). Either floats or, by CONIC_GAUSSIANS_HALF, binary16. */
  int sh_degree; /* 0 to CONIC_MAX_SH_DEGREE */
  float *sh;
  uint16_t *sh_half;

  /* What scale and opacity were made of where the file keeps ln s and logit o; only by CONIC_GAUSSIANS_SOURCE. */
  float *log_scale[3];
  float *logit_opacity;

  conic_gaussian_kind kind;
  char frame[4];      /* where x, y and z point: three letters of r l, u d, f b ("rdf": right, down, front) */
  int is_antialiased; /* trained with Mip-Splatting's screen filter */
  int is_linear;      /* colours are linear, not sRGB */
  int n_left_out;     /* columns of the file, or the like, that have no place here */
  int reserved_int;
  uint64_t reserved[4];
} conic_gaussians;

/* What a set has besides, as bits. */
typedef enum conic_gaussians_field {
  CONIC_GAUSSIANS_2D = 1,    /* two scales */
  CONIC_GAUSSIANS_HALF = 2,  /* sh_half in place of sh */
  CONIC_GAUSSIANS_SOURCE = 4 /* log_scale and logit_opacity */
} conic_gaussians_field;

/* Arrays of undefined contents; frame "rdf", origin zero. On failure *gaussians is empty. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_gaussians_allocate(conic_context *context, size_t count, int sh_degree, unsigned fields,
                                                conic_gaussians *gaussians);
CONIC_API unsigned conic_gaussians_fields(const conic_gaussians *gaussians);
/* Releases the arrays and leaves an empty set; a set of zero bytes is allowed. */
CONIC_API void conic_gaussians_release(conic_context *context, conic_gaussians *gaussians);

typedef struct conic_gaussians_read_options {
  size_t size;        /* sizeof(conic_gaussians_read_options), set by the init function */
  int keeps_source;   /* log_scale and logit_opacity, so that they can be written again to the bit */
  int half_harmonics; /* sh_half: half the memory, and 11 bits of each number */
  int most_sh_degree; /* higher degrees are left out */
  int is_splat;       /* what does not begin as any other format is a .splat, whatever its name */
} conic_gaussians_read_options;

/* Floats, all degrees, no source. */
CONIC_API void conic_gaussians_read_options_init_sized(conic_gaussians_read_options *options, size_t size);
#define conic_gaussians_read_options_init(options) conic_gaussians_read_options_init_sized(options, sizeof *(options))

/* Whether a file, or a folder, holds a Gaussian scene: by content, a .splat by its name. */
CONIC_API int conic_gaussians_is_file(conic_context *context, const char *path);

/* Reads a scene; "-" is standard input. Coordinates stay those of the file, whose frame is told. On success the caller
 * owns *gaussians; on failure it is empty. Null options are the defaults. Errors: ARGUMENT, INPUT, MEMORY, CANCELLED,
 * UNSUPPORTED (zlib, zstd or libwebp is not there). */
CONIC_API conic_status conic_gaussians_read(conic_context *context, const char *path,
                                            const conic_gaussians_read_options *options, conic_gaussians *gaussians);

/* The Gaussians as splats, as conic_model_read makes them of a .ply: ellipses along the two longer axes (of a 2D
 * Gaussian, its own), with the opacity and the colour of degree 0, which is linear. On success the caller owns *splats;
 * on failure it is empty. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_gaussians_to_splats(conic_context *context, const conic_gaussians *gaussians,
                                                 conic_splats *splats);

/* conic_model_read, which also takes Gaussian scenes of all formats, as splats; up is that of their frame. Errors: as
 * conic_model_read and conic_gaussians_read. */
CONIC_API conic_status conic_gaussians_read_model(conic_context *context, const char *path,
                                                  const conic_read_options *options, conic_model *model);

typedef struct conic_gaussians_write_options {
  size_t size;              /* sizeof(conic_gaussians_write_options), set by the init function */
  conic_gaussian_kind kind; /* of conic_gaussians_find_kind */
  int sh_bits[2];           /* of .spz: of degree 1, and of those above, 1 to 8 */
  int spz_version;          /* 3 (gzip) or 4 (zstd) */
  int most_sh_degree;       /* higher degrees are left out */
} conic_gaussians_write_options;

/* The kind PLY; 8 bits, version 4, all degrees. */
CONIC_API void conic_gaussians_write_options_init_sized(conic_gaussians_write_options *options, size_t size);
#define conic_gaussians_write_options_init(options) conic_gaussians_write_options_init_sized(options, sizeof *(options))

/* The kind that a name stands for (.compressed.ply before .ply); 0 where it is none. */
CONIC_API int conic_gaussians_find_kind(const char *path, conic_gaussian_kind *kind);

/* The frame that files of a kind are meant to have, and the highest degree of harmonics that they can. */
CONIC_API const char *conic_gaussian_kind_frame(conic_gaussian_kind kind);
CONIC_API int conic_gaussian_kind_sh_degree(conic_gaussian_kind kind);

/* Writes a scene in its own coordinates and order; what the kind cannot hold is left out or rounded. The file appears
 * under its name only when it is whole. Errors: ARGUMENT, MEMORY, IO, CANCELLED, UNSUPPORTED, INPUT (the coordinates do
 * not fit). */
CONIC_API conic_status conic_gaussians_write(conic_context *context, const char *path, const conic_gaussians *gaussians,
                                             const conic_gaussians_write_options *options);

/* Turns a scene into another frame, harmonics too. Between rdf, rub and luf that changes signs alone, so that turning
 * back gives the same bits. Errors: ARGUMENT (no frame, or a mirrored one). */
CONIC_API conic_status conic_gaussians_turn(conic_context *context, conic_gaussians *gaussians, const char *frame);

/* Orders the Gaussians along a curve that keeps neighbours together (Morton's), as files in chunks need it. Errors:
 * MEMORY (the set is then of no use but to be released). */
CONIC_API conic_status conic_gaussians_sort(conic_context *context, conic_gaussians *gaussians);

/* The box of the finite means. Returns how many are finite; where none is, the box is zero. */
CONIC_API size_t conic_gaussians_bounds(const conic_gaussians *gaussians, double minimum[3], double maximum[3]);

/* What cannot be drawn, by reason; a Gaussian may count in several. */
typedef struct conic_gaussians_defects {
  size_t positions; /* not finite */
  size_t scales;    /* negative or not finite */
  size_t rotations; /* zero or not finite */
  size_t opacities; /* not within 0 to 1 */
  size_t harmonics; /* not finite */
  uint64_t reserved[3];
} conic_gaussians_defects;

CONIC_API void conic_gaussians_find_defects(const conic_gaussians *gaussians, conic_gaussians_defects *defects);

/* The greatest differences between two sets of one order. Two NaN do not differ, and a NaN and a number do by infinity.
 */
typedef struct conic_gaussians_differences {
  double position;     /* in world units */
  double scale;        /* relative to the larger */
  double rotation_deg; /* between the axes; signs of quaternions, and lengths, do not matter */
  double opacity;
  double color;     /* of degree 0, as displayed: 0.28209… times the coefficients' */
  double harmonics; /* coefficients above degree 0; those that one set lacks are 0 there */
  int is_same; /* all numbers are the same, of quaternions and of what was kept of files, too, and so is all else */
  int reserved_int;
  uint64_t reserved[3];
} conic_gaussians_differences;

/* Errors: ARGUMENT (their counts differ). */
CONIC_API conic_status conic_gaussians_compare(conic_context *context, const conic_gaussians *a,
                                               const conic_gaussians *b, conic_gaussians_differences *differences);

#ifdef __cplusplus
}
#endif
#endif
