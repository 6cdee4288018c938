/* The header of a PLY file: which elements it holds, and how their values are stored. */
#pragma once

#include "core/files/input.h"
#include "core/splats/faces.h"

typedef enum conic_ply_format { CONIC_PLY_TEXT, CONIC_PLY_LITTLE_ENDIAN, CONIC_PLY_BIG_ENDIAN } conic_ply_format;

typedef enum conic_ply_type {
  CONIC_PLY_INT8,
  CONIC_PLY_UINT8,
  CONIC_PLY_INT16,
  CONIC_PLY_UINT16,
  CONIC_PLY_INT32,
  CONIC_PLY_UINT32,
  CONIC_PLY_FLOAT,
  CONIC_PLY_DOUBLE
} conic_ply_type;

/* Longer names are cut; no known name is that long. */
enum { CONIC_PLY_NAME_ROOM = 40 };

typedef struct conic_ply_property {
  char name[CONIC_PLY_NAME_ROOM];
  conic_ply_type type; /* of the value, or of a list's items */
  int is_list;
  conic_ply_type count_type; /* of a list's length */
  size_t row_offset;         /* bytes from the row's start, where the element has no lists */
} conic_ply_property;

typedef struct conic_ply_element {
  char name[CONIC_PLY_NAME_ROOM];
  uint64_t count, line; /* line: of its declaration */
  size_t first_property, n_properties;
  int has_lists;
  size_t least_row_bytes; /* of a binary row with empty lists; the exact size where there are no lists */
} conic_ply_element;

/* How Gaussians were trained, where a file says so. */
typedef enum conic_ply_splat_mode { CONIC_PLY_MODE_PLAIN, CONIC_PLY_MODE_MIP, CONIC_PLY_MODE_2D } conic_ply_splat_mode;

typedef struct conic_ply_header {
  conic_ply_format format;
  conic_ply_element *elements;
  conic_ply_property *properties;
  size_t n_elements, n_properties, element_capacity, property_capacity;
  conic_texts textures;            /* comment TextureFile NAME */
  conic_ply_splat_mode splat_mode; /* comment SplatRenderMode: NAME, or antialiased 1 */
  float up[3];                     /* comment Vertical axis: z, or X Y Z; of any length, and 0 where there is none */
  int is_conics;                   /* comment conic VERSION: its float colours are linear */
} conic_ply_header;

/* Reads from "ply" to past "end_header". On success the caller releases *header; on failure it is empty.
 * Errors: INPUT (also for Gaussians whose colours are spherical betas), MEMORY. */
conic_status conic_ply_header_read(conic_input *input, conic_ply_header *header);
void conic_ply_header_release(conic_context *context, conic_ply_header *header);

/* The element of that name, or null. */
const conic_ply_element *conic_ply_find_element(const conic_ply_header *header, const char *name);

/* The index, within the element, of the first property of that name, or -1. */
int conic_ply_find_property(const conic_ply_header *header, const conic_ply_element *element, const char *name);

size_t conic_ply_type_bytes(conic_ply_type type);
/* "uint8", "float" … */
const char *conic_ply_type_name(conic_ply_type type);
/* The type of either of its names; double for an unknown name. And the older name, which all programs know. */
conic_ply_type conic_ply_type_of(const char *name);
const char *conic_ply_type_word(conic_ply_type type);
/* The nearest number that a type holds; for integers, NaN becomes the least. And its bytes, little-endian. */
double conic_ply_nearest(conic_ply_type type, double value);
void conic_ply_store(conic_ply_type type, double value, void *to);
int conic_ply_type_is_integer(conic_ply_type type);

/* The least and largest value of an integer type. */
void conic_ply_type_range(conic_ply_type type, double *least, double *largest);
