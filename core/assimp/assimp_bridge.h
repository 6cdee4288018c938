/* The bridge to Assimp, a module of its own that runs in a process of its own: Assimp is written for files that are
 * sound, and of a spoiled one it may not come back. What it has read comes as records through a pipe, each followed by
 * its arrays, and is not believed.
 *
 * The module knows Assimp and nothing of conic but this header. */
#ifndef CONIC_ASSIMP_BRIDGE_H
#define CONIC_ASSIMP_BRIDGE_H

#include <stddef.h>
#include <stdint.h>

typedef enum conic_assimp_record_type {
  CONIC_ASSIMP_MATERIAL = 1, /* n_bytes: of what its picture is, or holds */
  CONIC_ASSIMP_PART = 2,     /* vertices, and triangles between them; points where there are none */
  CONIC_ASSIMP_OPENED = 3,   /* n_bytes: the path of a file that was read besides */
  CONIC_ASSIMP_FAILED = 4,   /* n_bytes: why; the last */
  CONIC_ASSIMP_END = 5,      /* all is read; the last */
  CONIC_ASSIMP_NOTE = 6      /* n_bytes: what a user should know of the file */
} conic_assimp_record_type;

/* What of a material's picture follows. */
typedef enum conic_assimp_picture {
  CONIC_ASSIMP_NO_PICTURE = 0,
  CONIC_ASSIMP_PATH = 1,   /* the name that the file has for it */
  CONIC_ASSIMP_FILE = 2,   /* the whole file */
  CONIC_ASSIMP_TEXELS = 3, /* width × height × (r, g, b, a), from the top left */
} conic_assimp_picture;

enum { CONIC_ASSIMP_NORMALS = 1, CONIC_ASSIMP_COORDINATES = 2, CONIC_ASSIMP_COLORS = 4, CONIC_ASSIMP_ALPHAS = 8 };

/* As conic_alpha_mode has them. */
enum { CONIC_ASSIMP_BLEND = 0, CONIC_ASSIMP_MASK = 1, CONIC_ASSIMP_OPAQUE = 2 };

/* What a record is not about is zero. After a part come double position[n_vertices][3] in the world; if there are such,
 * float normal[][3], coordinate[][2], color[][3] and alpha[]; and uint32_t triangles[n_triangles][3]. */
typedef struct conic_assimp_record {
  uint32_t type;
  uint32_t fields;     /* of a part: which of the arrays there are */
  uint32_t i_material; /* of a part: in the order of their records */
  uint32_t picture, is_clamped, width, height;
  float color[3], opacity, alpha_cutoff; /* of a material */
  uint32_t alpha_mode;                   /* likewise */
  double up[3];                          /* at the end: zero where the file does not say */
  uint64_t n_bytes, n_vertices, n_triangles;
} conic_assimp_record;

typedef struct conic_assimp_request {
  const char *name;   /* of the file, without a folder: for messages of Assimp's */
  const char *ending; /* that of the name, in lower case, which says who reads it */
  const unsigned char *bytes;
  size_t n_bytes;
  size_t folder_length; /* what it names besides is looked for in here, "…/" or "", and below */
  const char *folder;
  int keeps_faces; /* materials and texture coordinates are wanted */
  int keeps_alpha; /* so is that of vertices, of glTF */
  int descriptor;  /* where the records go */
} conic_assimp_request;

/* What the module gives, as its one symbol, conic_assimp_bridge. */
typedef struct conic_assimp_bridge_functions {
  const char *version; /* as of every module (core/base/module.h) */

  /* Reads the file and writes the records, and ends the process, which should be one of its own. */
  void (*read)(conic_assimp_request *request);
} conic_assimp_bridge_functions;

#endif
