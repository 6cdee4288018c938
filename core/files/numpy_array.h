/* Arrays of numbers as NumPy writes them: .npy, by itself or in an .npz. */
#pragma once

#include "conic/context.h"

enum { CONIC_NUMPY_MOST_AXES = 5 };

typedef struct conic_numpy_array {
  const unsigned char *bytes; /* of the first number */
  char type;                  /* 'f', 'i' or 'u' */
  int n_type_bytes, is_fortran, n_axes;
  size_t shape[CONIC_NUMPY_MOST_AXES];
} conic_numpy_array;

/* Understands a whole .npy, which must outlive *array. Errors: INPUT, as "FILE: NAME: what is wrong". */
conic_status conic_numpy_array_open(conic_context *context, const char *file, const char *name,
                                    const unsigned char *bytes, size_t n_bytes, conic_numpy_array *array);

/* Number i, which must exist, in C's order, whatever the file's order is. */
double conic_numpy_array_at(const conic_numpy_array *array, size_t i);

enum { CONIC_NUMPY_HEAD = 128 };

/* Writes the start of an .npy, of numbers of a type such as "<f4", in C's order. */
void conic_numpy_head(const char *type, const size_t *shape, int n_axes, unsigned char head[CONIC_NUMPY_HEAD]);
