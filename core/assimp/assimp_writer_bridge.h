/* What the module's files share: how records are written, and what Assimp is given to read. */
#ifndef CONIC_ASSIMP_WRITER_BRIDGE_H
#define CONIC_ASSIMP_WRITER_BRIDGE_H

#include <assimp/cfileio.h>
#include <assimp/scene.h>

#include "core/assimp/assimp_bridge.h"

typedef struct conic_assimp_writer {
  const conic_assimp_request *request;
  const struct aiScene *scene;
  int64_t *sent; /* of each material, which record it was; -1: not sent */
  uint32_t n_sent;
  int has_triangles;
  int is_failed, n_notes;
  const char *why_refused; /* null: it is not */
} conic_assimp_writer;

/* Makes the process one for this file alone: it says nothing, ends with its parent, takes no more memory and time than
 * a file of that size should, and dies of what it does wrong. */
void conic_assimp_settle(conic_assimp_request *request);

void conic_assimp_send_bytes(conic_assimp_writer *w, const void *bytes, size_t n_bytes);
/* A record about bytes, and those. */
void conic_assimp_send(conic_assimp_writer *w, conic_assimp_record record, const void *bytes, size_t n_bytes);
void conic_assimp_send_failure(conic_assimp_writer *w, const char *why);

/* The files that Assimp asks for: the model, from memory, and what lies beside it. */
struct aiFileIO conic_assimp_files(conic_assimp_writer *w);

/* Which of the mesh's texture coordinates its picture goes by. */
unsigned conic_assimp_coordinates(const conic_assimp_writer *w, const struct aiMesh *mesh);
/* Which record the material of a mesh is; it is sent when the first mesh needs it. */
uint32_t conic_assimp_material(conic_assimp_writer *w, const struct aiMesh *mesh);

#endif
