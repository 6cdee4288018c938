/* What a file is that is not read as a model: told by its first bytes, or by the ending of its name, with what would
 * make it readable. */
#ifndef CONIC_FILE_KINDS_H
#define CONIC_FILE_KINDS_H

#include <stddef.h>

typedef struct conic_foreign_kind {
  const char *name;    /* "an HDF5 file" */
  const char *remedy;  /* what to do about it, as a request */
  const char *endings; /* "fls rcs": a name that ends so is such a file if no bytes say otherwise; null: none */
  const char *bytes;   /* how such a file begins, from byte `at` on; null: any way */
  size_t n_bytes, at;
} conic_foreign_kind;

/* The kind of a file that begins with these bytes and has that name; null: none that is known. Those that bytes tell
 * are looked at where `by_bytes`, and else those that endings tell. */
const conic_foreign_kind *conic_foreign_kind_find(const char *path, const char *bytes, size_t n, int by_bytes);

/* Everything that is read, for messages. */
extern const char conic_readable_kinds[];

#endif
