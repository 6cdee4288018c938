/* The bridge to Assimp: a module that runs in a process of its own. Assimp is written for sound files, and may never
 * come back from a spoiled one. Its results come as records through a pipe, each followed by its arrays, and are all
 * checked.
 *
 * The module knows Assimp and nothing of conic but this header. */
#pragma once

#include <stddef.h>
#include <stdint.h>

typedef enum conic_assimp_record_type {
  CONIC_ASSIMP_MATERIAL = 1, /* n_bytes: of its picture's name or contents */
  CONIC_ASSIMP_PART = 2,     /* vertices, and triangles between them; points where there are none */
  CONIC_ASSIMP_OPENED = 3,   /* n_bytes: the path of another file that was read */
  CONIC_ASSIMP_FAILED = 4,   /* n_bytes: the reason; the last record */
  CONIC_ASSIMP_END = 5,      /* all is read; the last record */
  CONIC_ASSIMP_NOTE = 6      /* n_bytes: a note on the file for the user */
} conic_assimp_record_type;

/* What follows about a material's picture. */
typedef enum conic_assimp_picture {
  CONIC_ASSIMP_NO_PICTURE = 0,
  CONIC_ASSIMP_PATH = 1,   /* the name that the file has for it */
  CONIC_ASSIMP_FILE = 2,   /* the whole file */
  CONIC_ASSIMP_TEXELS = 3, /* width × height × (r, g, b, a), from the top left */
} conic_assimp_picture;

enum { CONIC_ASSIMP_NORMALS = 1, CONIC_ASSIMP_COORDINATES = 2, CONIC_ASSIMP_COLORS = 4 };

/* Fields that do not concern a record are zero. After a part come double position[n_vertices][3] in the world; then,
 * where there are such arrays, float normal[][3], coordinate[][2] and color[][3]; then uint32_t
 * triangles[n_triangles][3]. */
typedef struct conic_assimp_record {
  uint32_t type;
  uint32_t fields;     /* of a part: which arrays it has */
  uint32_t i_material; /* of a part: the number of the material's record */
  uint32_t picture, is_clamped, width, height;
  float color[3], opacity; /* of a material */
  double up[3];            /* in the last record: zero where the file does not say */
  uint64_t n_bytes, n_vertices, n_triangles;
} conic_assimp_record;

typedef struct conic_assimp_request {
  const char *name;   /* of the file, without a folder: for Assimp's messages */
  const char *ending; /* of the name, in lower case; it decides which reader is used */
  const unsigned char *bytes;
  size_t n_bytes;
  size_t folder_length; /* other files are looked for in this folder, "…/" or "", and below it */
  const char *folder;
  int keeps_faces; /* materials and texture coordinates are kept */
  int descriptor;  /* where the records go */
} conic_assimp_request;

/* The module's one symbol, conic_assimp_bridge. */
typedef struct conic_assimp_bridge_functions {
  const char *version; /* as in every module (core/base/machine.h) */

  /* Reads the file, writes the records, and ends the process, which should be its own. */
  void (*read)(conic_assimp_request *request);
} conic_assimp_bridge_functions;
