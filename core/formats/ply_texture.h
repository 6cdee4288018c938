/* Textures in PLY files, for readers that keep faces' other attributes. */
#pragma once

#include "core/formats/ply_source.h"
#include "core/splats/face_colors.h"

/* Where an element's rows tell about textures; -1: nowhere. */
typedef struct conic_ply_face_texture {
  conic_faces *faces;       /* null: skipped */
  int coordinates, picture; /* the list `texcoord`, and `texnumber` */
  size_t first, n_values;   /* of the current row: its first coordinate, and the list's length */
  int color[3];             /* red, green and blue of faces whose vertices have none */
  double values[3];         /* these, of the current row */
  conic_ply_type color_type;
  conic_face_colors colors;
} conic_ply_face_texture;

/* Whether faces have their own texture coordinates. */
int conic_ply_has_texture_corners(const conic_ply_header *header);

/* Gives the model faces, with the textures that the header names. Errors: INPUT, MEMORY. */
conic_status conic_ply_begin_textures(const conic_input *input, const conic_ply_header *header, conic_model *model);

/* Finds what is kept of an element for the model. */
void conic_ply_face_texture_find(const conic_ply_header *header, const conic_ply_element *element, conic_model *model,
                                 conic_ply_face_texture *texture);

void conic_ply_face_texture_begin_row(conic_ply_face_texture *texture);

/* Reads property i of the row if it concerns textures; else *is_read is 0. Errors: INPUT, MEMORY. */
conic_status conic_ply_face_texture_read(conic_ply_source *source, const conic_ply_property *properties, size_t i,
                                         conic_ply_face_texture *texture, int *is_read);

/* Notes the triangles of a row of `n_corners`, the model's from `first` on, a fan if it has coordinates. Errors: INPUT
 * (their number is not that of the corners), MEMORY. */
conic_status conic_ply_face_texture_end_row(const conic_ply_source *source, uint64_t n_corners, conic_model *model,
                                            size_t first, conic_ply_face_texture *texture);
