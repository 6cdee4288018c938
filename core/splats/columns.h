/* Sets as callers give them. A column is one component of an array, read with its stride; what only public functions
 * check is sound, and lies side by side, in all that comes after them. */
#pragma once

#include "conic/triangles.h"

enum { CONIC_SPLATS_COLUMNS = 21 };

typedef struct conic_column {
  float **floats; /* in the set; null where the array is absent */
  size_t *stride; /* likewise, in bytes; shared by an array's components */
  size_t count;
  unsigned field; /* of conic_splats_field; 0: the position */
} conic_column;

/* Position, both axes, normal, colour (three each), opacity, dot, scalar and sight (three). */
void conic_splats_list_columns(conic_splats *splats, conic_column columns[CONIC_SPLATS_COLUMNS]);

static inline float conic_column_at(const float *floats, size_t stride, size_t i) {
  return *(const float *)((const char *)floats + i * (stride ? stride : sizeof *floats));
}

static inline void conic_columns_at(float *const columns[3], size_t stride, size_t i, double vector[3]) {
  for (int axis = 0; axis < 3; axis++)
    vector[axis] = (double)conic_column_at(columns[axis], stride, i);
}

/* The normal of a face, its length twice its area; differences of floats, formed in double. */
void conic_triangles_face_normal(const conic_triangles *triangles, size_t i, double normal[3]);

/* What makes a set unusable, or null: it is null, its arrays are not whole, its strides or reserved words not sound. */
const char *conic_splats_fault(const conic_splats *given);
const char *conic_triangles_fault(const conic_triangles *given);

/* Errors: ARGUMENT, where there is a fault. */
conic_status conic_splats_check(conic_context *context, const char *who, const conic_splats *splats);

/* The same of a set that is changed or taken over: it has no strides. Errors: ARGUMENT. */
conic_status conic_splats_check_own(conic_context *context, const char *who, const conic_splats *splats);
conic_status conic_triangles_check_own(conic_context *context, const char *who, const conic_triangles *triangles);

/* Checks a set and makes `close` the same without strides: arrays that have some are copied into *block, which the
 * caller releases, the others are the given ones. On failure *block is null. Errors: ARGUMENT, MEMORY; for triangles
 * also INPUT, by conic_triangles_check. */
conic_status conic_splats_enter(conic_context *context, const char *who, const conic_splats *given, conic_splats *close,
                                float **block);

/* Both of a drawing; sets that it has not are empty. Whoever enters one leaves it, on failure too. */
typedef struct conic_entered_drawing {
  conic_splats splats;
  conic_triangles triangles;
  float *blocks[2];
} conic_entered_drawing;

conic_status conic_drawing_enter(conic_context *context, const char *who, const conic_drawing *given,
                                 conic_entered_drawing *entered);
void conic_drawing_leave(conic_context *context, conic_entered_drawing *entered);
