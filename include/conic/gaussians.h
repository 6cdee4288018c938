/* Gaussian scenes: what 3D and 2D Gaussian splatting trains, as its files hold it.
 *
 * A Gaussian has a mean, standard deviations along its axes (three; two for a 2D Gaussian, which lies in the plane of
 * the first two axes), a rotation, an opacity, and spherical harmonics that give the colour by direction. Logarithms
 * and logits of files are linear here. Nothing is repaired: values that cannot be drawn (NaN, a zero rotation …) stay
 * as the file has them, and conic_gaussians_find_defects counts them. Structure of arrays, except for the harmonics. */
#ifndef CONIC_GAUSSIANS_H
#define CONIC_GAUSSIANS_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"
#include "conic/model.h"

CONIC_BEGIN_C

enum { CONIC_MAX_SH_DEGREE = 4 };

/* The formats of Gaussian scenes (docs/reference/gaussian-files.md). */
typedef enum conic_gaussian_kind {
  CONIC_GAUSSIANS_PLY = 0,
  CONIC_GAUSSIANS_COMPRESSED_PLY = 1,
  CONIC_GAUSSIANS_SPLAT = 2,
  CONIC_GAUSSIANS_SPZ = 3,
  CONIC_GAUSSIANS_SOG = 4, /* a folder with meta.json, or a zip */
  CONIC_GAUSSIANS_GLTF = 5,
  CONIC_GAUSSIANS_GLB = 6,
  CONIC_GAUSSIANS_KSPLAT = 7 /* read, and not written */
} conic_gaussian_kind;
enum { CONIC_N_GAUSSIAN_KINDS = 7 }; /* that are written */

/* "ply", "compressed-ply", "splat", "spz", "sog", "gltf", "glb", "ksplat"; null for a number that is no kind. */
CONIC_API const char *conic_gaussian_kind_name(conic_gaussian_kind kind);

typedef struct conic_gaussians {
  size_t count;
  double origin[3];   /* the mean of Gaussian i is origin + position[.][i], formed in double */
  float *position[3]; /* never null */
  float *scale[3];    /* standard deviations in world units; scale[2] is null in a set of 2D Gaussians */
  float *rotation[4]; /* quaternions w, x, y, z as the file has them, of any length: whoever draws normalises them */
  float *opacity;     /* 0 to 1 */

  /* Harmonics of all orders, lowest first, each red, green, blue: Gaussian i has (sh_degree + 1)² × 3 numbers from sh[i
   * × (sh_degree + 1)² × 3] on. The colour is max(0, ½ + Σ sh·Y), where Y are the real harmonics of 3DGS (Y₀ =
   * 0.28209…; of degree 1 −y, z, −x times 0.4886…). They are floats or, with CONIC_GAUSSIANS_HALF, binary16. */
  int sh_degree; /* 0 to CONIC_MAX_SH_DEGREE */
  float *sh;
  uint16_t *sh_half;

  /* ln s and logit o, where the file keeps these and CONIC_GAUSSIANS_SOURCE asked for them. */
  float *log_scale[3];
  float *logit_opacity;

  conic_gaussian_kind kind;
  char frame[4];      /* where x, y and z point, in three letters of r l, u d, f b ("rdf": right, down, front) */
  int is_antialiased; /* trained with Mip-Splatting's screen filter */
  int is_linear;      /* colours are linear, not sRGB */
  int n_left_out;     /* columns of the file, or similar values, that this struct cannot hold */
  float up[3];        /* the direction up, of any length, where the file says more of it than its frame; else 0 */
  uint64_t reserved[3];
} conic_gaussians;

/* Which optional arrays a set has, as bits. */
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
  int is_splat;       /* a file that begins like no other format is a .splat, whatever its name */
} conic_gaussians_read_options;

/* Floats, all degrees, no source. */
CONIC_API void conic_gaussians_read_options_init_sized(conic_gaussians_read_options *options, size_t size);
#define conic_gaussians_read_options_init(options) conic_gaussians_read_options_init_sized(options, sizeof *(options))

/* Whether a file, or a folder, holds a Gaussian scene. The content tells, for a .splat the name. */
CONIC_API int conic_gaussians_is_file(conic_context *context, const char *path);

/* Reads a scene; "-" is standard input. Coordinates stay those of the file; `frame` names their frame. On success the
 * caller owns *gaussians; on failure it is empty. Null options are the defaults. Errors: ARGUMENT, INPUT, MEMORY,
 * CANCELLED, UNSUPPORTED (zlib, zstd or libwebp is not there). */
CONIC_API conic_status conic_gaussians_read(conic_context *context, const char *path,
                                            const conic_gaussians_read_options *options, conic_gaussians *gaussians);

/* The Gaussians as splats, as conic_model_read makes them from a .ply: ellipses along the two longer axes (a 2D
 * Gaussian's own), with the opacity and the colour of degree 0, which is linear. On success the caller owns *splats; on
 * failure it is empty. Errors: ARGUMENT, MEMORY. */
CONIC_API conic_status conic_gaussians_to_splats(conic_context *context, const conic_gaussians *gaussians,
                                                 conic_splats *splats);

/* conic_model_read that also reads Gaussian scenes of all formats, as splats; up is that of their frame. Errors: as
 * conic_model_read and conic_gaussians_read. */
CONIC_API conic_status conic_gaussians_read_model(conic_context *context, const char *path,
                                                  const conic_read_options *options, conic_model *model);

typedef struct conic_gaussians_write_options {
  size_t size;              /* sizeof(conic_gaussians_write_options), set by the init function */
  conic_gaussian_kind kind; /* conic_gaussians_find_kind finds it */
  int sh_bits[2];           /* .spz: bits of degree 1, and of the degrees above, 1 to 8 */
  int spz_version;          /* 3 (gzip) or 4 (zstd) */
  int most_sh_degree;       /* higher degrees are left out */
} conic_gaussians_write_options;

/* The kind PLY; 8 bits, version 4, all degrees. */
CONIC_API void conic_gaussians_write_options_init_sized(conic_gaussians_write_options *options, size_t size);
#define conic_gaussians_write_options_init(options) conic_gaussians_write_options_init_sized(options, sizeof *(options))

/* Finds the kind that a name's ending stands for (.compressed.ply before .ply); returns 0 where there is none. */
CONIC_API int conic_gaussians_find_kind(const char *path, conic_gaussian_kind *kind);

/* The frame that files of a kind are meant to have; the highest degree of harmonics that they can hold. */
CONIC_API const char *conic_gaussian_kind_frame(conic_gaussian_kind kind);
CONIC_API int conic_gaussian_kind_sh_degree(conic_gaussian_kind kind);

/* Writes a scene in its own coordinates and order. Values that the kind cannot hold are left out or rounded. The file
 * appears under its name only when it is whole. Errors: ARGUMENT, MEMORY, IO, CANCELLED, UNSUPPORTED, INPUT (the
 * coordinates do not fit). */
CONIC_API conic_status conic_gaussians_write(conic_context *context, const char *path, const conic_gaussians *gaussians,
                                             const conic_gaussians_write_options *options);

/* Turns a scene into another frame, harmonics too. Between rdf, rub and luf only signs change, so that turning back
 * restores the bits. Errors: ARGUMENT (no frame, or a mirrored one). */
CONIC_API conic_status conic_gaussians_turn(conic_context *context, conic_gaussians *gaussians, const char *frame);

/* Orders the Gaussians along a curve that keeps neighbours together (Morton's), as files in chunks need it. Errors:
 * MEMORY (the set can then only be released). */
CONIC_API conic_status conic_gaussians_sort(conic_context *context, conic_gaussians *gaussians);

/* The box of the finite means. Returns how many are finite; where none is, the box is zero. */
CONIC_API size_t conic_gaussians_bounds(const conic_gaussians *gaussians, double minimum[3], double maximum[3]);

/* How many Gaussians cannot be drawn, by reason; a Gaussian may count several times. */
typedef struct conic_gaussians_defects {
  size_t positions; /* not finite */
  size_t scales;    /* negative or not finite */
  size_t rotations; /* zero or not finite */
  size_t opacities; /* not within 0 to 1 */
  size_t harmonics; /* not finite */
  uint64_t reserved[3];
} conic_gaussians_defects;

CONIC_API void conic_gaussians_find_defects(const conic_gaussians *gaussians, conic_gaussians_defects *defects);

/* The greatest differences between two sets of one order. Two NaN do not differ; NaN and a number differ by
 * infinity. */
typedef struct conic_gaussians_differences {
  double position;     /* in world units */
  double scale;        /* relative to the larger */
  double rotation_deg; /* between the axes; signs of quaternions, and lengths, do not matter */
  double opacity;
  double color;     /* of degree 0, as displayed: 0.28209… times the coefficients' */
  double harmonics; /* coefficients above degree 0; those that one set lacks count as 0 */
  int is_same;      /* all numbers and all other members are the same, including quaternions and the values kept from
                       files */
  int reserved_int;
  uint64_t reserved[3];
} conic_gaussians_differences;

/* Errors: ARGUMENT (their counts differ). */
CONIC_API conic_status conic_gaussians_compare(conic_context *context, const conic_gaussians *a,
                                               const conic_gaussians *b, conic_gaussians_differences *differences);

CONIC_END_C
#endif
