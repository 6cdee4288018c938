#include "core/assimp/assimp_kinds.h"

#include "core/base/byte_order.h"
#include "core/files/file.h"

/* How a file of a kind begins, and what else stands within its first bytes; empty: nothing. */
typedef struct content {
  conic_model_kind kind;
  const char *start, *within, *also;
} content;

static const content contents[] = {
    {CONIC_MODEL_GLB, "glTF", "", ""},
    {CONIC_MODEL_FBX, "Kaydara FBX Binary", "", ""},
    {CONIC_MODEL_FBX, "; FBX", "", ""},
    {CONIC_MODEL_3MF, "PK\x03\x04", "3D/3dmodel.model", ""},
    {CONIC_MODEL_STL, "solid", "facet", ""},
    {CONIC_MODEL_STL, "solid", "endsolid", ""},
    {CONIC_MODEL_GLTF, "{", "\"asset\"", "\"version\""},
    {CONIC_MODEL_DAE, "<", "<COLLADA", ""},
    {CONIC_MODEL_X3D, "<", "<X3D", ""},
    {CONIC_MODEL_AMF, "<", "<amf", ""},
    {CONIC_MODEL_DXF, "0\nSECTION", "", ""},
    {CONIC_MODEL_DXF, "0\r\nSECTION", "", ""},
};

int conic_assimp_has_text(const void *bytes, size_t n, const char *text) {
  size_t length = strlen(text);
  for (const char *c = bytes, *found; length > 0 && n >= length; n -= (size_t)(found + 1 - c), c = found + 1) {
    found = memchr(c, text[0], n - length + 1);
    if (!found)
      return 0;
    if (memcmp(found, text, length) == 0)
      return 1;
  }
  return length == 0;
}

/* OFF, COFF, STNOFF … alone on the first line. */
static int is_off(const char *bytes, size_t n) {
  size_t i = 0;
  while (i < n && i < 8 && strchr("STCN4", bytes[i]) && bytes[i])
    i++;
  return i + 3 < n && memcmp(bytes + i, "OFF", 3) == 0 && strchr("\r\n \t", bytes[i + 3]) && bytes[i + 3];
}

static uint64_t number_at(const char *bytes, size_t at) {
  return conic_load_32(bytes + at);
}

/* Whether the faces read have normals of length 1 or 0, and places within reach. */
static int has_stl_faces(const char *bytes, size_t n) {
  for (size_t at = 84; at + 50 <= n; at += 50) {
    float values[12];
    memcpy(values, bytes + at, sizeof values);
    conic_turn_words(values, 12, sizeof *values);
    float square = values[0] * values[0] + values[1] * values[1] + values[2] * values[2];
    if (!(square == 0.0f || (square > 0.99f && square < 1.01f)))
      return 0;
    for (int i = 3; i < 12; i++)
      if (!(values[i] > -1e15f && values[i] < 1e15f))
        return 0;
  }
  return 1;
}

/* Whether a file of that size is a binary STL, which says how many faces it has; for a pipe, whether it may be one. */
static int is_stl(const char *bytes, size_t n, uint64_t size) {
  if (n < 134 || number_at(bytes, 80) == 0)
    return 0;
  return size == UINT64_MAX ? has_stl_faces(bytes, n) : size == 84 + 50 * number_at(bytes, 80);
}

/* Binary files whose length must be what they say. */
static int has_length(const char *bytes, size_t n, uint64_t size, conic_model_kind *kind) {
  if (is_stl(bytes, n, size))
    *kind = CONIC_MODEL_STL;
  else if (n >= 6 && memcmp(bytes, "MM", 2) == 0 && size == number_at(bytes, 2))
    *kind = CONIC_MODEL_3DS;
  else
    return 0;
  return 1;
}

/* Beginnings that other kinds of files share. */
static int is_wrapped(conic_model_kind kind, const char *bytes, size_t n) {
  if (kind == CONIC_MODEL_3MF)
    return n >= 4 && memcmp(bytes, "PK\x03\x04", 4) == 0;
  return n >= 1 && bytes[0] == '<' && (kind == CONIC_MODEL_DAE || kind == CONIC_MODEL_X3D || kind == CONIC_MODEL_AMF);
}

int conic_assimp_find_content(const char *path, const char *bytes, size_t n, uint64_t size, conic_model_kind *kind) {
  size_t n_blanks = 0;
  if (has_length(bytes, n, size, kind))
    return 1;
  if (n >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0)
    n_blanks = 3;
  while (n_blanks < n && bytes[n_blanks] && strchr(" \t\r\n", bytes[n_blanks]))
    n_blanks++;
  bytes += n_blanks;
  n -= n_blanks;
  for (size_t i = 0; i < sizeof contents / sizeof *contents; i++) {
    size_t length = strlen(contents[i].start);
    if (n < length || memcmp(bytes, contents[i].start, length) != 0)
      continue;
    *kind = contents[i].kind;
    if (conic_assimp_has_text(bytes, n, contents[i].within) && conic_assimp_has_text(bytes, n, contents[i].also))
      return 1;
  }
  if (conic_assimp_find_ending(path, kind) && is_wrapped(*kind, bytes, n))
    return 1;
  *kind = CONIC_MODEL_OFF;
  return is_off(bytes, n);
}

int conic_assimp_find_ending(const char *path, conic_model_kind *kind) {
  for (int i = CONIC_MODEL_STL; i <= CONIC_MODEL_AMF; i++)
    if (conic_file_has_ending(path, conic_model_kind_name((conic_model_kind)i))) {
      *kind = (conic_model_kind)i;
      return 1;
    }
  return 0;
}
