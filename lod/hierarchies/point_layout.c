/* Where a point's position, colour and intensity stand in its record, and taking them from there. */
#include "lod/hierarchies/hierarchy.h"

#include <string.h>

#include "core/base/byte_order.h"

int conic_point_field_is_good(const conic_point_field *field) {
  int n = field->n_bytes;
  if (field->type == 'f')
    return n == 4 || n == 8;
  return (field->type == 'i' || field->type == 'u') && (n == 1 || n == 2 || n == 4 || n == 8);
}

int conic_point_layout_has_colors(const conic_point_layout *layout) {
  return layout->intensity.n_bytes > 0 ||
         (layout->color[0].n_bytes > 0 && layout->color[1].n_bytes > 0 && layout->color[2].n_bytes > 0);
}

static double field_number(const unsigned char *record, const conic_point_field *field) {
  uint64_t bits = conic_load_bits(record + field->at, field->n_bytes);
  if (field->type == 'u')
    return (double)bits;
  if (field->type == 'i') {
    uint64_t sign = UINT64_C(1) << (8 * field->n_bytes - 1);
    return bits & sign ? -(double)((sign << 1) - bits) : (double)bits; /* of 8 bytes, sign << 1 is 0, and so it is */
  }
  return field->n_bytes == 4 ? (double)conic_float_of_bits((uint32_t)bits) : conic_double_of_bits(bits);
}

/* What is no number of 16 bits becomes the nearest. */
static uint16_t color_code_of(double value) {
  return value > 0.0 ? value < 65535.0 ? (uint16_t)value : UINT16_MAX : 0;
}

void conic_point_layout_take(const conic_point_layout *layout, const unsigned char *records,
                             conic_hierarchy_points *points) {
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < points->n; i++)
      points->position[axis][i] =
          field_number(records + i * layout->n_bytes, &layout->position[axis]) * layout->scale[axis] +
          layout->offset[axis];
  conic_point_layout_take_colors(layout, records, points);
}

void conic_point_layout_take_colors(const conic_point_layout *layout, const unsigned char *records,
                                    conic_hierarchy_points *points) {
  for (int channel = 0; channel < 3 && points->color[0]; channel++) {
    const conic_point_field *color = layout->color[0].n_bytes ? &layout->color[channel] : &layout->intensity;
    for (size_t i = 0; i < points->n; i++)
      points->color[channel][i] =
          color->n_bytes ? color_code_of(field_number(records + i * layout->n_bytes, color)) : UINT16_MAX;
  }
}

int conic_point_layout_of_las(unsigned format, uint32_t n_bytes, conic_point_layout *layout) {
  static const struct {
    uint8_t n_bytes, color;
  } formats[] = {{20, 0}, {28, 0},  {26, 20}, {34, 28}, {57, 0}, {63, 28},
                 {30, 0}, {36, 30}, {38, 30}, {59, 0},  {67, 30}};
  if (format >= sizeof formats / sizeof *formats || n_bytes < formats[format].n_bytes)
    return 0;
  memset(layout, 0, sizeof *layout);
  layout->n_bytes = n_bytes;
  layout->intensity = (conic_point_field){12, 2, 'u'};
  for (uint32_t axis = 0; axis < 3; axis++) {
    layout->position[axis] = (conic_point_field){4 * axis, 4, 'i'};
    if (formats[format].color)
      layout->color[axis] = (conic_point_field){formats[format].color + 2 * axis, 2, 'u'};
  }
  return 1;
}
