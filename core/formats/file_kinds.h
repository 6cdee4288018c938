/* Kinds of files that are not read as models, told by their first bytes or the ending of their name, and what would
 * make them readable. */
#pragma once

#include <stddef.h>

typedef struct conic_foreign_kind {
  const char *name;    /* "an HDF5 file" */
  const char *remedy;  /* what to do about it, as a request */
  const char *endings; /* "fls rcs": the kind of a name that ends so, if no bytes say otherwise; null: none */
  const char *bytes;   /* how such a file begins, from byte `at` on; null: not known */
  size_t n_bytes, at;
} conic_foreign_kind;

/* The kind of a file with these first bytes and that name; null: none is known. With `by_bytes` the bytes decide, else
 * the ending. */
const conic_foreign_kind *conic_foreign_kind_find(const char *path, const char *bytes, size_t n, int by_bytes);

/* All kinds that are read, for messages. */
extern const char conic_readable_kinds[];
