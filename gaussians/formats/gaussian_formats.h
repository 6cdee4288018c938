/* The formats of Gaussian scenes, a file or two each; conic_gaussians_read and _write choose among them. */
#pragma once

#include "core/base/byte_order.h"
#include "core/files/mapping.h"
#include "core/formats/ply_header.h"
#include "gaussians/scene/gaussian_set.h"

/* Whether a file is a Gaussian scene other than a .ply whose vertices have the numbers as columns. */
int conic_gaussians_is_packed(conic_context *context, const char *path);

/* --- reading: on failure *gaussians is for the caller to release --- */

/* Whether a PLY's vertices are Gaussians, plain or in PlayCanvas's chunks. */
int conic_ply_has_gaussians(const conic_ply_header *header);
int conic_ply_has_compressed_gaussians(const conic_ply_header *header);

/* From the header's end on. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_gaussian_ply_read(conic_input *input, const conic_ply_header *header,
                                     const conic_gaussians_read_options *options, conic_gaussians *gaussians);
conic_status conic_compressed_ply_read(conic_input *input, const conic_ply_header *header,
                                       const conic_gaussians_read_options *options, conic_gaussians *gaussians);

/* How Gaussians were trained, and which way is up: what the header's comments say of it. */
void conic_gaussians_take_comments(const conic_ply_header *header, conic_gaussians *gaussians);

/* Of the bytes of a whole file; `name` is for messages. Errors: INPUT, MEMORY, CANCELLED, UNSUPPORTED. */
typedef struct conic_gaussian_bytes {
  conic_context *context;
  const char *name; /* for messages */
  const char *path; /* of what else belongs to it; null: nothing can */
  const unsigned char *bytes;
  size_t n_bytes;
  const conic_gaussians_read_options *options;
} conic_gaussian_bytes;

conic_status conic_splat_file_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians);
conic_status conic_ksplat_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians);
conic_status conic_spz_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians);
conic_status conic_sog_levels_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians);
conic_status conic_sog_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians);
conic_status conic_gaussian_gltf_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians);

/* Arrays for `count` Gaussians of a file, as the options want them: of a degree up to theirs; with `fields` 2D, or
 * SOURCE where it has logarithms and the options want these kept. Errors: INPUT (too many), MEMORY. */
conic_status conic_gaussians_begin(conic_context *context, const char *name,
                                   const conic_gaussians_read_options *options, uint64_t count, int sh_degree,
                                   unsigned fields, conic_gaussians *gaussians);

/* "FILE: what is wrong (at byte N)". */
conic_status conic_gaussian_bytes_wrong(const conic_gaussian_bytes *file, size_t at, const char *what);
#ifdef __clang_analyzer__ /* which then knows that it fails */
#define conic_gaussian_bytes_wrong(file, at, what)                                                                     \
  ((void)(conic_gaussian_bytes_wrong)(file, at, what), CONIC_ERROR_INPUT)
#endif

/* Opens a file that it names, beside it or below. Errors: INPUT, MEMORY. */
conic_status conic_gaussian_bytes_open(const conic_gaussian_bytes *file, const char *name, char path[4096],
                                       conic_mapping *mapping);

/* --- writing: of a set that was checked --- */

typedef struct conic_gaussian_writer {
  conic_context *context;
  const char *path; /* for messages */
  FILE *to;
  const conic_gaussians *gaussians;
  const conic_gaussians_write_options *options;
  int sh_degree;     /* that is written: of the set's what the kind can hold */
  int lacks_normals; /* .ply: without nx, ny and nz, which are 0 */
} conic_gaussian_writer;

conic_status conic_gaussian_ply_write(const conic_gaussian_writer *writer);
conic_status conic_compressed_ply_write(const conic_gaussian_writer *writer);
conic_status conic_splat_file_write(const conic_gaussian_writer *writer);
conic_status conic_spz_write(const conic_gaussian_writer *writer);
conic_status conic_sog_write(const conic_gaussian_writer *writer);

/* What an .spz of version 3 packs as gzip, in a block that the caller releases, on failure too. Errors: as above. */
conic_status conic_spz_make_block(const conic_gaussian_writer *writer, unsigned char **block, size_t *n_block);
conic_status conic_gaussian_gltf_write(const conic_gaussian_writer *writer);

/* The comments of a PLY's header that conic_gaussians_take_comments takes; says_flat: that they are 2D. */
void conic_gaussian_writer_put_comments(const conic_gaussian_writer *writer, int says_flat);

/* Errors: IO. */
conic_status conic_gaussian_writer_put(const conic_gaussian_writer *writer, const void *bytes, size_t n_bytes);
/* Told now and then how much of the Gaussians is written. Errors: CANCELLED. */
conic_status conic_gaussian_writer_tell(const conic_gaussian_writer *writer, size_t i);

/* A value from 0 to 1 as a number of 0 to `most`, rounded to nearest; NaN is 0. */
static inline uint32_t conic_code_of_share(double share, uint32_t most) {
  double scaled = share * (double)most + 0.5;
  return scaled >= (double)most ? most : scaled >= 0.0 ? (uint32_t)scaled : 0;
}

/* A unit quaternion of Gaussian i, w x y z: 1, 0, 0, 0 where it has no direction. */
void conic_gaussians_unit_rotation(const conic_gaussians *gaussians, size_t i, double q[4]);

/* The component of a unit quaternion that is best left out where the other three are rounded by `rounded`: of the
 * largest, and those nearly as large, the one without which least is lost, so that what was rounded before stays as it
 * is. Gives q the sign that makes it positive. */
int conic_find_left_out(double q[4], double (*rounded)(double value));

/* Copies them; the options leave out what they would of a file. On failure *gaussians is empty. Errors: ARGUMENT,
 * MEMORY. */
conic_status conic_gaussians_copy_lent(conic_context *context, const char *name, const conic_gaussians *lent,
                                       const conic_gaussians_read_options *options, conic_gaussians *gaussians);
