#include "core/formats/ply_texture.h"

/* The property of that name that is a list, or is none; -1 where there is no such property. */
static int find(const conic_ply_header *header, const conic_ply_element *element, const char *name, int is_list) {
  int i = conic_ply_find_property(header, element, name);
  return i >= 0 && header->properties[element->first_property + (size_t)i].is_list == is_list ? i : -1;
}

static int find_coordinates(const conic_ply_header *header, const conic_ply_element *element) {
  return strcmp(element->name, "face") == 0 ? find(header, element, "texcoord", 1) : -1;
}

/* Colours of faces count where neither vertices have some nor there are pictures. */
static int find_colors(const conic_ply_header *header, const conic_ply_element *element, int color[3]) {
  static const char *const names[][3] = {{"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}};
  const conic_ply_element *vertices = conic_ply_find_element(header, "vertex");
  for (size_t i = 0; i < 2 && vertices; i++)
    if (find(header, vertices, names[i][0], 0) >= 0)
      return 0;
  for (size_t i = 0; i < 2 && strcmp(element->name, "face") == 0 && header->textures.count == 0; i++) {
    for (int k = 0; k < 3; k++)
      color[k] = find(header, element, names[i][k], 0);
    if (color[0] >= 0 && color[1] >= 0 && color[2] >= 0)
      return 1;
  }
  return 0;
}

/* With one texture there is nothing to choose. */
static int find_picture(const conic_ply_header *header, const conic_ply_element *element) {
  return header->textures.count > 1 ? find(header, element, "texnumber", 0) : -1;
}

int conic_ply_has_texture_corners(const conic_ply_header *header) {
  for (size_t i = 0; i < header->n_elements; i++)
    if (find_coordinates(header, &header->elements[i]) >= 0)
      return 1;
  return 0;
}

/* Names are relative to the model's folder. */
static conic_status add_picture(const conic_input *input, const char *file, conic_faces *faces) {
  char path[2 * CONIC_INPUT_LONGEST_WORD];
  size_t n = conic_input_beside(input, file, strlen(file), path, sizeof path);
  if (n == 0)
    return conic_input_wrong(input, "the path of a texture is too long");
  return conic_texts_add(input->context, &faces->pictures, path, n);
}

conic_status conic_ply_begin_textures(const conic_input *input, const conic_ply_header *header, conic_model *model) {
  conic_status status = conic_faces_create(input->context, &model->faces);
  for (size_t i = 0; status == CONIC_OK && i < header->textures.count; i++)
    status = add_picture(input, conic_texts_at(&header->textures, i), model->faces);
  return status;
}

/* If any triangle of the model is noted, all are. */
static int has_notes(const conic_ply_header *header) {
  int has = conic_ply_has_texture_corners(header);
  for (size_t i = 0; i < header->n_elements; i++)
    has |= find_picture(header, &header->elements[i]) >= 0;
  return has;
}

void conic_ply_face_texture_find(const conic_ply_header *header, const conic_ply_element *element, conic_model *model,
                                 conic_ply_face_texture *texture) {
  memset(texture, 0, sizeof *texture);
  texture->faces = has_notes(header) ? model->faces : NULL;
  texture->coordinates = texture->faces ? find_coordinates(header, element) : -1;
  texture->picture = texture->faces ? find_picture(header, element) : -1;
  if (find_colors(header, element, texture->color))
    texture->color_type = header->properties[element->first_property + (size_t)texture->color[0]].type;
  else
    texture->color[0] = texture->color[1] = texture->color[2] = -1;
}

void conic_ply_face_texture_begin_row(conic_ply_face_texture *texture) {
  if (!texture->faces)
    return;
  texture->faces->current_material = 0;
  texture->first = texture->faces->n_coordinates;
  texture->n_values = 0;
}

static conic_status read_coordinates(conic_ply_source *source, const conic_ply_property *property,
                                     conic_ply_face_texture *texture) {
  uint64_t length;
  double coordinate[2];
  conic_status status = conic_ply_read_list_length(source, property, &length);
  for (uint64_t i = 0; status == CONIC_OK && i < length; i++) {
    status = conic_ply_read_value(source, property->type, &coordinate[i % 2]);
    if (status == CONIC_OK && texture->faces->n_coordinates >= CONIC_MAX_POINTS)
      return conic_ply_wrong(source, "too many texture coordinates");
    if (status == CONIC_OK && i % 2)
      status = conic_faces_add_coordinate(source->input->context, texture->faces, coordinate);
  }
  texture->n_values = (size_t)length;
  return status;
}

/* A number that no texture has means no texture. */
static conic_status read_picture(conic_ply_source *source, const conic_ply_property *property, conic_faces *faces) {
  double number, count = (double)faces->pictures.count;
  conic_status status = conic_ply_read_value(source, property->type, &number);
  if (status == CONIC_OK)
    faces->current_material = (uint32_t)(number >= 0.0 && number < count ? number : count);
  return status;
}

conic_status conic_ply_face_texture_read(conic_ply_source *source, const conic_ply_property *properties, size_t i,
                                         conic_ply_face_texture *texture, int *is_read) {
  *is_read = 1;
  if ((int)i == texture->coordinates)
    return read_coordinates(source, &properties[i], texture);
  if ((int)i == texture->picture)
    return read_picture(source, &properties[i], texture->faces);
  for (int k = 0; k < 3; k++)
    if ((int)i == texture->color[k])
      return conic_ply_read_value(source, properties[i].type, &texture->values[k]);
  *is_read = 0;
  return CONIC_OK;
}

conic_status conic_ply_face_texture_end_row(const conic_ply_source *source, uint64_t n_corners, conic_model *model,
                                            size_t first, conic_ply_face_texture *texture) {
  const size_t n_triangles = model->n_triangles - first;
  conic_status status = texture->color[0] >= 0 ? conic_face_colors_take(source->input->context, &texture->colors, model,
                                                                        first, texture->values)
                                               : CONIC_OK;
  if (!texture->faces || status != CONIC_OK)
    return status;
  if (texture->n_values && texture->n_values != 2 * n_corners)
    return conic_ply_wrong(source, "a list of texture coordinates holds neither none nor two a corner");
  for (size_t i = 0; status == CONIC_OK && i < n_triangles; i++) {
    uint32_t corner = (uint32_t)texture->first, second = corner + (uint32_t)i + 1;
    const uint32_t corners[3] = {corner, second, second + 1};
    status = conic_faces_add(source->input->context, texture->faces, NULL, texture->n_values ? corners : NULL);
  }
  return status;
}
