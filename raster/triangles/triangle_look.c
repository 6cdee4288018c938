#include "raster/triangles/triangle_look.h"

#include "core/base/vectors.h"

static conic_affine weight_of(const conic_triangle_record *record, const conic_triangle_edges *edges, int k,
                              int64_t e) {
  double scale = record->part * (double)record->iz[k], step = scale * (double)CONIC_SUBPIXELS;
  conic_affine weight = {(float)((double)e * scale), (float)((double)edges->a[k] * step),
                         (float)((double)edges->b[k] * step)};
  return weight;
}

static void take_piece(const conic_triangle_frame *frame, const conic_triangle_record *record,
                       conic_triangle_look *look) {
  look->is_piece = record->piece != CONIC_NO_PIECE;
  if (!look->is_piece)
    return;
  const CONIC_STORED conic_triangle_piece *piece = &frame->pieces[record->piece];
  int second = record->is_swapped ? 2 : 1, third = 3 - second;
  for (int i = 0; i < 2; i++) {
    look->at[0][i] = piece->at[0][i];
    look->at[1][i] = piece->at[second][i] - piece->at[0][i];
    look->at[2][i] = piece->at[third][i] - piece->at[0][i];
  }
}

/* Colours that no sum holds count as black. */
static float usable(float value) {
  return value >= -CONIC_GREATEST_COLOR && value <= CONIC_GREATEST_COLOR ? value : 0.0f;
}

static void take_color(const CONIC_STORED float *values, const uint32_t corners[3], int channel,
                       conic_triangle_look *look) {
  float first = usable(values[corners[0]]);
  look->color[0][channel] = first;
  look->color[1][channel] = usable(values[corners[1]]) - first;
  look->color[2][channel] = usable(values[corners[2]]) - first;
}

/* The attribute's component at three corners, as the first and differences from it. */
static void take_component(const CONIC_STORED float *values, const uint32_t corners[3], float *first, float *second,
                           float *third) {
  *first = values[corners[0]]; /* NOLINT(clang-analyzer-core.NullDereference): who has normals has three columns */
  *second = values[corners[1]] - *first;
  *third = values[corners[2]] - *first;
}

/* The direction of the face's normal; where it has none, that to the viewer. */
static void find_face(const conic_triangle_frame *frame, const uint32_t corners[3], float face[3]) {
  const conic_triangles *t = frame->triangles;
  double side[2][3], normal[3];
  for (int k = 0; k < 2; k++)
    for (int axis = 0; axis < 3; axis++)
      side[k][axis] = (double)t->position[axis][corners[k + 1]] - (double)t->position[axis][corners[0]];
  conic_cross(side[0], side[1], normal);
  double length = conic_length(normal), scale = 1.0 / length;
  for (int axis = 0; axis < 3; axis++)
    face[axis] = length > 0.0 ? (float)(normal[axis] * scale) : -frame->view->rotation_float[2][axis];
}

/* A piece's attributes are the triangle's; the others' corners may have changed places. */
static void in_record_order(const conic_triangle_record *record, const CONIC_STORED uint32_t *from, uint32_t to[3]) {
  int is_swapped = record->is_swapped && record->piece == CONIC_NO_PIECE;
  to[0] = from[0];
  to[1] = from[is_swapped ? 2 : 1];
  to[2] = from[is_swapped ? 1 : 2];
}

static void take_material(const conic_triangles *t, const conic_triangle_record *record, conic_triangle_look *look) {
  uint32_t index = record->index, corners[3];
  const CONIC_STORED conic_material *material = &t->materials[t->material ? t->material[index] : 0];
  in_record_order(record, t->texture_corners ? t->texture_corners[index] : t->corners[index], corners);
  for (int k = 0; k < 3; k++)
    for (int channel = 0; channel < 3; channel++)
      look->color[k][channel] *= material->color[channel];
  look->texture = t->texture_coordinate[0] ? conic_material_texture(material) : NULL;
  for (int axis = 0; axis < 2 && look->texture; axis++)
    take_component(t->texture_coordinate[axis], corners, &look->uv[0][axis], &look->uv[1][axis], &look->uv[2][axis]);
}

void conic_triangle_look_at(const conic_triangle_frame *frame, const conic_triangle_record *record, int x, int y,
                            conic_triangle_look *look) {
  const conic_triangles *t = frame->triangles;
  conic_triangle_edges edges;
  uint32_t corners[3];
  conic_triangle_edges_of(record, &edges);
  int64_t e1 = conic_triangle_edge_at(&edges, 1, x, y), e2 = conic_triangle_edge_at(&edges, 2, x, y);
  *look = (conic_triangle_look){.has_normals = t->normal[0] != NULL}; /* lanes reckon with what is not there, too */
  look->iz = conic_triangle_depth(record, &edges, e1, e2);
  look->first = weight_of(record, &edges, 1, e1);
  look->second = weight_of(record, &edges, 2, e2);
  look->iz_far = conic_triangle_far(record);
  look->iz_near = conic_triangle_near(record);
  take_piece(frame, record, look);
  in_record_order(record, t->corners[record->index], corners);
  for (int channel = 0; channel < 3; channel++) {
    look->color[0][channel] = 1.0f;
    if (t->color[0])
      take_color(t->color[channel], corners, channel, look);
  }
  find_face(frame, corners, look->face);
  if (look->has_normals) {
    uint32_t of_normals[3];
    in_record_order(record, t->normal_corners ? t->normal_corners[record->index] : t->corners[record->index],
                    of_normals);
    for (int axis = 0; axis < 3; axis++)
      take_component(t->normal[axis], of_normals, &look->normal[0][axis], &look->normal[1][axis],
                     &look->normal[2][axis]);
    float sum[3];
    for (int axis = 0; axis < 3; axis++)
      sum[axis] = 3.0f * look->normal[0][axis] + (look->normal[1][axis] + look->normal[2][axis]);
    look->side = (sum[0] * look->face[0] + sum[1] * look->face[1]) + sum[2] * look->face[2];
  }
  if (t->n_materials)
    take_material(t, record, look);
}
