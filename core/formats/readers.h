/* The readers of models. Each reads from the start of the file. With a delivery the points go there. On failure *model
 * is for the caller to release. Errors of all: INPUT, MEMORY, CANCELLED, the receiver's. */
#pragma once

#include "core/formats/model_part.h"
#include "core/formats/ply_source.h"

/* LAS: versions 1.0 to 1.5, point formats 0 to 10, as they are or packed (LAZ: core/laz).
 *
 * Positions are the file's integers times its scale. The origin is the first point's position in double, so that map
 * coordinates lose nothing. Colours are meant to have 16 bits, yet many programs store 8-bit codes: the values of the
 * whole file tell (core/splats/raw_colors.h). One other field of the points can be read as a scalar
 * (core/formats/las_fields.h). Other variable-length records, and everything after the points, are skipped. Wrong
 * counts of points and records are logged, and the existing ones are read. */
conic_status conic_las_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* Reads the shape from the header of a LAS at its start. Errors: INPUT, CANCELLED. */
conic_status conic_las_look(conic_input *input, conic_model_shape *shape);

/* OBJ; a delivery gets nothing. */
conic_status conic_obj_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* STL and OFF; a delivery gets nothing. */
conic_status conic_stl_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);
conic_status conic_off_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* PCD, the Point Cloud Library's format: ascii, binary and binary_compressed.
 *
 * Positions in single precision are kept as they are. Positions in double, and those of text, are measured from the
 * first finite one, the origin. A colour is packed (rgb, rgba) or three fields; its scale is told by the largest value
 * of the whole file (core/splats/raw_colors.h). The viewpoint is ignored. A file with fewer points than it declares is
 * read as far as it goes, with a warning. */
conic_status conic_pcd_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* Whether the first line that is no comment is one of a PCD header. */
int conic_pcd_is_likely(const char *bytes, size_t n);

/* Text with a point a line: XYZ, PTS, CSV and whatever else people call it. docs/reference/formats.md says what is
 * understood.
 *
 * The lines before the first point (names of columns, the number of points) and the first 256 points tell the dialect
 * and the columns (core/formats/text_columns.h). The rest is read line by line. A colour is sRGB-encoded; the largest
 * value of the whole file tells whether it is a fraction of 1, a code of 8 bits or one of 16
 * (core/splats/raw_colors.h). Positions are kept in double, from the first finite one as the origin. Errors, too:
 * ARGUMENT (the options' columns). */
conic_status conic_xyz_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* Whether text begins like such a file: with numbers, after comments and names of columns. */
int conic_xyz_is_likely(const char *bytes, size_t n);

/* E57 (ASTM E2807): all scans of one or more stations, each moved and turned by its pose, without points that were not
 * measured. Colours are delivered as codes of 16 bits. Errors, too: UNSUPPORTED. */
conic_status conic_e57_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* Whether a file with these first bytes is an E57. */
int conic_e57_is(const char *bytes, size_t n);

/* PTX: scans as text, each a grid of points as its scanner saw them. Each is moved and turned by its matrix; places of
 * the grid where nothing was measured are left out. */
conic_status conic_ptx_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* Whether the bytes begin like a PTX: two lines of one number each, then four of three numbers and four of four. */
int conic_ptx_is_likely(const char *bytes, size_t n);

/* PLY; with a delivery, faces are passed over. */
conic_status conic_ply_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* Reads the shape from the header of a PLY at its start. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_ply_look(conic_input *input, const conic_read_options *options, conic_model_shape *shape);

/* Reads a PLY's elements `face` and `tristrips`; the source is at the start of the element's rows. Errors: as above. */
conic_status conic_ply_read_faces(conic_ply_source *source, const conic_ply_header *header, uint64_t n_vertices,
                                  const conic_read_options *options, conic_builder *builder);

/* --- what is lent --- */

/* Whether splats or triangles are lent under a name. */
int conic_model_is_lent(const conic_context *context, const char *name);

/* Copies a lent set, as conic_model_read would read a PLY of it. *model is empty before; on failure the caller releases
 * it. Errors: ARGUMENT, INPUT (a face index, no such field), MEMORY. */
conic_status conic_model_copy_lent(conic_context *context, const char *name, const conic_read_options *options,
                                   conic_model *model);
