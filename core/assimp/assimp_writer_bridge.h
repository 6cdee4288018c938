/* What the module's files share: writing records, and giving Assimp files to read. */
#pragma once

#include <assimp/cfileio.h>
#include <assimp/scene.h>

#include "core/assimp/assimp_bridge.h"

typedef struct conic_assimp_writer {
  const conic_assimp_request *request;
  const struct aiScene *scene;
  int64_t *sent; /* of each material, the number of its record; -1: not sent */
  uint32_t n_sent;
  int has_triangles;
  int is_failed, n_notes;
  const char *why_refused; /* null: not refused */
} conic_assimp_writer;

/* Prepares the process for this file alone: it writes nothing, ends with its parent, takes no more memory and time than
 * a file of that size should, and dies of its faults. */
void conic_assimp_settle(conic_assimp_request *request);

void conic_assimp_send_bytes(conic_assimp_writer *w, const void *bytes, size_t n_bytes);
/* Sends a record and its bytes. */
void conic_assimp_send(conic_assimp_writer *w, conic_assimp_record record, const void *bytes, size_t n_bytes);
void conic_assimp_send_failure(conic_assimp_writer *w, const char *why);

/* The files that Assimp asks for: the model, from memory, and what lies beside it. */
struct aiFileIO conic_assimp_files(conic_assimp_writer *w);

/* Which of the mesh's texture coordinates its picture uses. */
unsigned conic_assimp_coordinates(const conic_assimp_writer *w, const struct aiMesh *mesh);
/* The number of a mesh's material record, which is sent when the first mesh needs it. */
uint32_t conic_assimp_material(conic_assimp_writer *w, const struct aiMesh *mesh);
