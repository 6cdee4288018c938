/* Which files Assimp is asked to read: those of the formats that were tried, and no other that it knows. */
#ifndef CONIC_ASSIMP_KINDS_H
#define CONIC_ASSIMP_KINDS_H

#include <stddef.h>
#include <stdint.h>

#include "conic/model.h"

/* Whether a kind is one of Assimp's; its name is also the ending of its files. */
static inline int conic_assimp_reads(conic_model_kind kind) {
  return kind >= CONIC_MODEL_STL && kind <= CONIC_MODEL_AMF;
}

/* Tells by the first `n` bytes of a file of `size` (UINT64_MAX where that is not known), where they are certain, or are
 * those of an archive or XML and the name's ending says which; else 0. */
int conic_assimp_find_content(const char *path, const char *bytes, size_t n, uint64_t size, conic_model_kind *kind);

/* Whether a text is somewhere in bytes. */
int conic_assimp_has_text(const void *bytes, size_t n, const char *text);

/* Whether they are a whole binary STL, as its own length says. */
int conic_assimp_is_binary(const void *bytes, uint64_t n);

/* Tells by the name's ending. */
int conic_assimp_find_ending(const char *path, conic_model_kind *kind);

#endif
