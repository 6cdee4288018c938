/* What a mesh's faces have besides their vertices, while a model is read and until triangles take it. */
#pragma once

#include "core/base/base.h"

/* A corner without a normal or a texture coordinate. */
#define CONIC_NO_CORNER UINT32_MAX

/* More materials than any picture tells apart; looking names up stays quick. */
enum { CONIC_MAX_MATERIALS = 4096 };

/* Texts one after the other, each ended by a zero. */
typedef struct conic_texts {
  char *bytes;
  size_t used_bytes, room_bytes, count;
} conic_texts;

typedef struct conic_faces {
  size_t count, room;                                   /* one for every triangle of the model */
  uint32_t (*normal_corners)[3], (*texture_corners)[3]; /* CONIC_NO_CORNER: none */
  uint32_t *material;                                   /* by the order of material_names */
  size_t n_normals, normal_room;
  float (*normals)[3];
  size_t n_coordinates, coordinate_room;
  float (*coordinates)[2];
  int has_normal_corners, has_texture_corners;
  int has_vertex_coordinates; /* a texture coordinate a vertex, for corners that have none of their own: */
  size_t first_vertex_coordinate;
  uint32_t current_material;
  conic_texts material_names;  /* the first is empty: no material */
  conic_texts libraries;       /* material files, as paths */
  conic_texts pictures;        /* where no names are: material i is the texture of path i, one after all is none */
  struct conic_material *made; /* where no names are: the materials themselves, one after all is white */
  size_t n_made, made_room;
} conic_faces;

/* Errors: MEMORY. */
conic_status conic_faces_create(conic_context *context, conic_faces **faces);
/* Null is allowed. */
void conic_faces_destroy(conic_context *context, conic_faces *faces);

/* For the model's next triangle; null for corners without. Errors: MEMORY. */
conic_status conic_faces_add(conic_context *context, conic_faces *faces, const uint32_t normals[3],
                             const uint32_t coordinates[3]);
/* Errors: MEMORY. */
conic_status conic_faces_add_normal(conic_context *context, conic_faces *faces, const double normal[3]);
conic_status conic_faces_add_coordinate(conic_context *context, conic_faces *faces, const double coordinate[2]);

/* What is added from here on are the vertices' coordinates, in their order. */
void conic_faces_begin_vertices(conic_faces *faces);

/* Makes the material of that name the one of the triangles that follow. Errors: MEMORY, INPUT (too many). */
conic_status conic_faces_use_material(conic_context *context, conic_faces *faces, const char *name, size_t length);

/* Appends a material to `made`, which owns its texture from then on. Errors: MEMORY. */
conic_status conic_faces_add_material(conic_context *context, conic_faces *faces,
                                      const struct conic_material *material);

/* Appends a text of `length` bytes. Errors: MEMORY. */
conic_status conic_texts_add(conic_context *context, conic_texts *texts, const char *text, size_t length);
/* Text i. */
const char *conic_texts_at(const conic_texts *texts, size_t i);
/* Which of the texts is this; `count` where none is. */
size_t conic_texts_find(const conic_texts *texts, const char *text, size_t length);
