#include "core/formats/ply_columns.h"
#include "core/formats/ply_texture.h"
#include "core/formats/readers.h"
#include "core/splats/polygon.h"

/* Turns a list of vertex indices, one at a time, into triangles. */
typedef struct triangulation {
  conic_ply_source *source;
  conic_builder *builder;
  uint64_t n_vertices;
  int is_strip;
  uint64_t n_seen;   /* indices since the start of the polygon or strip */
  uint32_t first[2]; /* of a polygon: the corner that all its triangles share, and the last one; of a strip: the last
                        two */
  conic_ply_face_texture texture;
} triangulation;

static conic_status wrong_index(const triangulation *faces, double index) {
  char what[96] = "a vertex index is negative";
  if (index >= 0.0)
    snprintf(what, sizeof what, "vertex index %.0f, but there are only %llu vertices", index,
             (unsigned long long)faces->n_vertices);
  return conic_ply_wrong(faces->source, what);
}

/* Every other triangle of a strip is wound the other way round. Triangles with a vertex twice only bridge gaps. */
static conic_status continue_strip(triangulation *strip, uint32_t index) {
  uint32_t a = strip->first[0], b = strip->first[1];
  int is_odd = (int)(strip->n_seen & 1);
  strip->first[0] = b;
  strip->first[1] = index;
  if (strip->n_seen++ < 2 || a == b || b == index || a == index)
    return CONIC_OK;
  return conic_builder_add_triangle(strip->builder, is_odd ? b : a, is_odd ? a : b, index);
}

static conic_status continue_fan(triangulation *polygon, uint32_t index) {
  uint32_t previous = polygon->first[1];
  if (polygon->n_seen == 0)
    polygon->first[0] = index;
  polygon->first[1] = index;
  if (polygon->n_seen++ < 2)
    return CONIC_OK;
  return conic_builder_add_triangle(polygon->builder, polygon->first[0], previous, index);
}

static conic_status add_index(triangulation *faces, double index) {
  if (faces->is_strip && index == -1.0) {
    faces->n_seen = 0;
    return CONIC_OK;
  }
  if (!(index >= 0.0 && index < (double)faces->n_vertices))
    return wrong_index(faces, index);
  return faces->is_strip ? continue_strip(faces, (uint32_t)index) : continue_fan(faces, (uint32_t)index);
}

static conic_status read_indices(triangulation *faces, const conic_ply_property *property) {
  uint64_t length;
  conic_status status = conic_ply_read_list_length(faces->source, property, &length);
  faces->n_seen = 0;
  for (uint64_t i = 0; status == CONIC_OK && i < length; i++) {
    double index;
    status = conic_ply_read_value(faces->source, property->type, &index);
    if (status == CONIC_OK)
      status = add_index(faces, index);
  }
  return status;
}

static conic_status skip_property(conic_ply_source *source, const conic_ply_property *property) {
  uint64_t count = 1;
  conic_status status = property->is_list ? conic_ply_read_list_length(source, property, &count) : CONIC_OK;
  return status == CONIC_OK ? conic_ply_skip_values(source, property->type, count) : status;
}

static conic_status read_face_row(triangulation *faces, const conic_ply_property *properties, size_t i_indices) {
  size_t n_before = faces->builder->model->n_triangles;
  conic_status status = conic_ply_begin_row(faces->source);
  conic_ply_face_texture_begin_row(&faces->texture);
  for (size_t i = 0; status == CONIC_OK && i < faces->source->element->n_properties; i++) {
    int is_read = i == i_indices;
    if (is_read)
      status = read_indices(faces, &properties[i]);
    else
      status = conic_ply_face_texture_read(faces->source, properties, i, &faces->texture, &is_read);
    if (status == CONIC_OK && !is_read)
      status = skip_property(faces->source, &properties[i]);
  }
  if (status == CONIC_OK)
    status =
        conic_ply_face_texture_end_row(faces->source, faces->n_seen, faces->builder->model, n_before, &faces->texture);
  if (status == CONIC_OK && !faces->is_strip)
    conic_polygon_settle(faces->builder->model, n_before);
  if (faces->source->is_cut) { /* what there is of the face is none */
    faces->builder->model->n_triangles = n_before;
    return status;
  }
  return status == CONIC_OK ? conic_ply_end_row(faces->source) : status;
}

/* Hands over triangles that are not kept, if they fill a batch or `is_last`, and drops them. */
static conic_status deliver_faces(conic_builder *builder, int is_last) {
  conic_model *model = builder->model;
  const conic_delivery *delivery = builder->delivery;
  if (!delivery || model->n_triangles < (is_last ? 1 : delivery->batch))
    return CONIC_OK;
  conic_status status =
      delivery->receive_faces(delivery->cookie, (const uint32_t(*)[3])model->triangles, model->n_triangles);
  model->n_triangles = 0;
  return status;
}

conic_status conic_ply_read_faces(conic_ply_source *source, const conic_ply_header *header, uint64_t n_vertices,
                                  const conic_read_options *options, conic_builder *builder) {
  const conic_ply_element *element = source->element;
  triangulation faces = {.source = source, .builder = builder, .n_vertices = n_vertices};
  int i_indices = conic_ply_find_property(header, element, "vertex_indices");
  const conic_ply_property *properties = header->properties + element->first_property;
  conic_status status = CONIC_OK;
  faces.is_strip = strcmp(element->name, "tristrips") == 0;
  if (i_indices < 0)
    i_indices = conic_ply_find_property(header, element, "vertex_index");
  if (i_indices < 0 || !properties[i_indices].is_list || !conic_ply_type_is_integer(properties[i_indices].type))
    return conic_fail(source->input->context, CONIC_ERROR_INPUT,
                      "%s: the element '%s' has no list of integers vertex_indices (line %llu)", source->input->name,
                      element->name, (unsigned long long)element->line);
  conic_ply_face_texture_find(header, element, builder->model, &faces.texture);
  if (builder->delivery) /* the vertices are gone */
    faces.texture.color[0] = -1;
  if (builder->delivery) /* so that no polygon is settled with only a part of the vertices */
    status = conic_builder_deliver(builder, 1);
  for (uint64_t i = 0; status == CONIC_OK && i < element->count; i++) {
    status = read_face_row(&faces, properties, (size_t)i_indices);
    if (status == CONIC_OK)
      status = deliver_faces(builder, 0);
  }
  const unsigned kind = conic_raw_kind_of(conic_ply_colors_are(header->is_conics, options, faces.texture.color_type));
  conic_status colored =
      conic_face_colors_finish(builder, &faces.texture.colors, kind, options->keeps_faces && !builder->delivery,
                               source->is_cut ? CONIC_OK : status);
  if (colored == CONIC_OK)
    colored = deliver_faces(builder, 1);
  return status == CONIC_OK || colored != CONIC_OK ? colored : status;
}
