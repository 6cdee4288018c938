#include "core/splats/faces.h"

#include "conic/triangles.h"

conic_status conic_faces_create(conic_context *context, conic_faces **faces) {
  *faces = conic_memory_allocate_zeroed(context, 1, sizeof **faces);
  if (!*faces)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_texts_add(context, &(*faces)->material_names, "", 0);
  if (status != CONIC_OK) {
    conic_faces_destroy(context, *faces);
    *faces = NULL;
  }
  return status;
}

void conic_faces_destroy(conic_context *context, conic_faces *faces) {
  if (!faces)
    return;
  conic_memory_release_these(context, faces->normal_corners, faces->texture_corners, faces->material, faces->normals,
                             faces->coordinates, faces->material_names.bytes, faces->libraries.bytes,
                             faces->pictures.bytes);
  for (size_t i = 0; i < faces->n_made; i++)
    conic_texture_destroy(faces->made[i].texture);
  conic_memory_release_these(context, faces->made, faces);
}

conic_status conic_faces_add(conic_context *context, conic_faces *faces, const uint32_t normals[3],
                             const uint32_t coordinates[3]) {
  size_t n = faces->count;
  if (n == faces->room) {
    size_t larger = n + n / 2 + 1024;
    conic_status status = conic_memory_grow(context, &faces->normal_corners, n, larger, sizeof *faces->normal_corners);
    if (status == CONIC_OK)
      status = conic_memory_grow(context, &faces->texture_corners, n, larger, sizeof *faces->texture_corners);
    if (status == CONIC_OK)
      status = conic_memory_grow(context, &faces->material, n, larger, sizeof *faces->material);
    if (status != CONIC_OK)
      return status;
    faces->room = larger;
  }
  for (int i = 0; i < 3; i++) {
    faces->normal_corners[n][i] = normals ? normals[i] : CONIC_NO_CORNER;
    faces->texture_corners[n][i] = coordinates ? coordinates[i] : CONIC_NO_CORNER;
    faces->has_normal_corners |= faces->normal_corners[n][i] != CONIC_NO_CORNER;
    faces->has_texture_corners |= faces->texture_corners[n][i] != CONIC_NO_CORNER;
  }
  faces->material[n] = faces->current_material;
  faces->count++;
  return CONIC_OK;
}

conic_status conic_faces_add_normal(conic_context *context, conic_faces *faces, const double normal[3]) {
  const float kept[3] = {(float)normal[0], (float)normal[1], (float)normal[2]};
  return conic_memory_append(context, &faces->normals, &faces->n_normals, &faces->normal_room, kept, sizeof kept);
}

conic_status conic_faces_add_coordinate(conic_context *context, conic_faces *faces, const double coordinate[2]) {
  const float kept[2] = {(float)coordinate[0], (float)coordinate[1]};
  return conic_memory_append(context, &faces->coordinates, &faces->n_coordinates, &faces->coordinate_room, kept,
                             sizeof kept);
}

void conic_faces_begin_vertices(conic_faces *faces) {
  faces->has_vertex_coordinates = 1;
  faces->first_vertex_coordinate = faces->n_coordinates;
}

conic_status conic_faces_use_material(conic_context *context, conic_faces *faces, const char *name, size_t length) {
  size_t i = conic_texts_find(&faces->material_names, name, length);
  if (i == faces->material_names.count) {
    if (i == CONIC_MAX_MATERIALS)
      return conic_fail(context, CONIC_ERROR_INPUT, "there are more than %d materials", (int)CONIC_MAX_MATERIALS);
    conic_status status = conic_texts_add(context, &faces->material_names, name, length);
    if (status != CONIC_OK)
      return status;
  }
  faces->current_material = (uint32_t)i;
  return CONIC_OK;
}

conic_status conic_faces_add_material(conic_context *context, conic_faces *faces, const conic_material *material) {
  return conic_memory_append(context, &faces->made, &faces->n_made, &faces->made_room, material, sizeof *material);
}

conic_status conic_texts_add(conic_context *context, conic_texts *texts, const char *text, size_t length) {
  if (conic_memory_reserve(context, &texts->bytes, texts->used_bytes, texts->used_bytes + length + 1,
                           &texts->room_bytes, 1) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  memcpy(texts->bytes + texts->used_bytes, text, length);
  texts->bytes[texts->used_bytes + length] = '\0';
  texts->used_bytes += length + 1;
  texts->count++;
  return CONIC_OK;
}

const char *conic_texts_at(const conic_texts *texts, size_t i) {
  const char *text = texts->bytes;
  for (; i > 0; i--)
    text += strlen(text) + 1;
  return text;
}

size_t conic_texts_find(const conic_texts *texts, const char *text, size_t length) {
  const char *known = texts->bytes;
  for (size_t i = 0; i < texts->count; i++) {
    size_t known_length = strlen(known);
    if (known_length == length && memcmp(known, text, length) == 0)
      return i;
    known += known_length + 1;
  }
  return texts->count;
}
