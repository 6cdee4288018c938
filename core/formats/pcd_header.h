/* The header of a PCD file: which fields its points have, and how they are stored. */
#pragma once

#include "core/formats/ply_header.h"
#include "core/formats/text_columns.h"

typedef enum conic_pcd_data { CONIC_PCD_NONE, CONIC_PCD_ASCII, CONIC_PCD_BINARY, CONIC_PCD_COMPRESSED } conic_pcd_data;

typedef struct conic_pcd_field {
  char letter; /* F, I or U */
  size_t n_bytes, count;
  conic_ply_type type; /* valid where is_known; numbers of 64 bits are not known */
  int is_known;
  size_t row_offset, i_value; /* where it begins in a row: in bytes, and in values */
} conic_pcd_field;

typedef struct conic_pcd_header {
  conic_text_columns names; /* the fields' names, and their meanings */
  conic_pcd_field fields[CONIC_TEXT_MOST_COLUMNS];
  int i_packed; /* the field that holds a whole colour; -1: none */
  size_t row_bytes, row_values;
  uint64_t width, height, n_points;
  int has_viewpoint; /* the viewpoint is not at the origin, or is turned */
  conic_pcd_data data;
} conic_pcd_header;

/* Reads to past the line with the kind of data. Errors: INPUT, CANCELLED. */
conic_status conic_pcd_header_read(conic_input *input, conic_pcd_header *header);
