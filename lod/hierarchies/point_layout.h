/* Where a point's position, colour and intensity stand in its record, and taking them from there. */
#ifndef CONIC_POINT_LAYOUT_H
#define CONIC_POINT_LAYOUT_H

#include <stddef.h>
#include <stdint.h>

/* A number in a record. */
typedef struct conic_point_field {
  uint32_t at;
  uint8_t n_bytes; /* 0: there is none */
  char type;       /* 'i': two's complement, 'u': unsigned, 'f': IEEE 754 */
} conic_point_field;

typedef struct conic_point_layout {
  uint32_t n_bytes; /* of a record */
  conic_point_field position[3], color[3], intensity;
  double scale[3], offset[3]; /* a position is its number · scale + offset */
} conic_point_layout;

/* Points as they come: each array has room for all of a node. */
typedef struct conic_hierarchy_points {
  size_t n;
  double *position[3]; /* in world units */
  uint16_t *color[3];  /* as in the file, or else the intensity thrice; null: not wanted */
} conic_hierarchy_points;

/* Whether a number can be such a field. */
int conic_point_field_is_good(const conic_point_field *field);

/* Whether points of this layout have colours, or an intensity in place of them. */
int conic_point_layout_has_colors(const conic_point_layout *layout);

/* Takes points->n of them from as many records. */
void conic_point_layout_take(const conic_point_layout *layout, const unsigned char *records,
                             conic_hierarchy_points *points);

/* The same of nothing but colours, or the intensity. */
void conic_point_layout_take_colors(const conic_point_layout *layout, const unsigned char *records,
                                    conic_hierarchy_points *points);

/* Where LAS 1.4 has these in a record of a point format, 0 to 10; 0 where there is no such format. */
int conic_point_layout_of_las(unsigned format, uint32_t n_bytes, conic_point_layout *layout);

#endif
