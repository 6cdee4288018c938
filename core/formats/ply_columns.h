/* From the columns of a PLY's vertices to splats: which properties mean what, and how they are converted. */
#pragma once

#include "core/formats/ply_header.h"
#include "core/splats/builder.h"
#include "core/splats/raw_colors.h"

/* The meanings of vertex properties. Those of three components are consecutive. */
typedef enum conic_ply_column {
  CONIC_PLY_X = 0,
  CONIC_PLY_TANGENT_U = 3,
  CONIC_PLY_TANGENT_V = 6,
  CONIC_PLY_NORMAL = 9,
  CONIC_PLY_RADIUS = 12,
  CONIC_PLY_RED = 13,
  CONIC_PLY_OPACITY = 16,
  CONIC_PLY_SCALE = 17,
  CONIC_PLY_ROTATION = 20,
  CONIC_PLY_HARMONIC = 24,
  CONIC_PLY_COORDINATE = 27, /* two texture coordinates */
  CONIC_PLY_DOT = 29,
  CONIC_PLY_FIELD = 30, /* the requested ones */
  CONIC_PLY_N_COLUMNS = CONIC_PLY_FIELD + CONIC_MOST_POINT_VALUES
} conic_ply_column;

/* Rows that are converted together, column by column. */
enum { CONIC_PLY_BLOCK = 256 };

typedef double conic_ply_block[CONIC_PLY_N_COLUMNS][CONIC_PLY_BLOCK];

/* The ways in which files describe splats. */
typedef enum conic_ply_form {
  CONIC_PLY_POINTS,   /* positions */
  CONIC_PLY_NORMALS,  /* positions and normals */
  CONIC_PLY_CIRCLES,  /* normal and radius */
  CONIC_PLY_AXES,     /* tangent axes */
  CONIC_PLY_GAUSSIANS /* scales and rotation */
} conic_ply_form;

typedef struct conic_ply_layout {
  int property[CONIC_PLY_N_COLUMNS]; /* by column: the property, counted within the element; -1: none */
  conic_ply_type type[CONIC_PLY_N_COLUMNS];
  conic_ply_form form;
  unsigned fields;     /* of the splat set, bits of conic_splats_field */
  int has_coordinates; /* texture coordinates, which are not converted */
  int n_scales;        /* of GAUSSIANS: 2 or 3 */
  int has_harmonics, has_origin_positions;
  int is_origin_set;
  int is_alpha;                              /* the opacity is coded as colours are */
  int n_values;                              /* requested values, and for each: */
  int value_column[CONIC_MOST_POINT_VALUES]; /* its column, which may be that of a property with another meaning, too;
                                                −1: none */
  int clip_property[2];                      /* the lists of clip lines, by conic_clip_operator; -1: none */
  float cutoff;
  conic_color_meaning colors_are; /* DISPLAY: perhaps codes */
  int keeps_codes; /* colours of more than 8 bits are kept as they stand, until the whole file tells what white is */
  float srgb[256]; /* linear values of 8-bit codes */
} conic_ply_layout;

/* Whether the scale of its colours is told by the whole file (core/splats/raw_colors.h): those of more than 8 bits that
 * are not linear. */
int conic_ply_layout_has_codes(const conic_ply_layout *layout);
/* What colours of that type mean: in conic's own files, fractions are linear. */
conic_color_meaning conic_ply_colors_are(int is_conics, const conic_read_options *options, conic_ply_type type);

/* Finds what the vertices hold. The options' cutoff turns radii into standard deviations. Texture coordinates are left
 * out unless `keeps_coordinates`, alpha unless the options keep it. Errors: INPUT (no x, y, z). */
conic_status conic_ply_layout_find(conic_input *input, const conic_ply_header *header,
                                   const conic_ply_element *vertices, const conic_read_options *options,
                                   int keeps_coordinates, conic_ply_layout *layout);

/* Lists the vertices' properties as fields, and finds the requested ones. Errors: as conic_fields_choose. */
conic_status conic_ply_layout_choose_fields(conic_input *input, const conic_ply_header *header,
                                            const conic_ply_element *vertices, const conic_read_options *options,
                                            conic_builder *builder, conic_ply_layout *layout);

/* Converts the first `n` rows of `block` into `points` from `first` on; sets the origin from the first finite position
 * where positions need one. */
void conic_ply_layout_convert(conic_ply_layout *layout, const conic_ply_block block, size_t n, size_t first,
                              conic_splats *points);
