/* Which files Assimp is asked to read: only those of formats that were tried. */
#pragma once

#include "conic/model.h"
#include "core/base/base.h"

/* Whether a kind is one of Assimp's. */
static inline int conic_assimp_reads(conic_model_kind kind) {
  return kind >= CONIC_MODEL_3MF && kind <= CONIC_MODEL_AMF;
}

/* Tells the kind by the first `n` bytes of a file of `size` (UINT64_MAX: not known). The bytes must be certain, or be
 * an archive's or XML's and the name's ending must fit; else returns 0. */
int conic_assimp_find_content(const char *path, const char *bytes, size_t n, uint64_t size, conic_model_kind *kind);

/* Whether a text is somewhere in bytes. */
int conic_assimp_has_text(const void *bytes, size_t n, const char *text);

/* Tells the kind by the name's ending. */
int conic_assimp_find_ending(const char *path, conic_model_kind *kind);
