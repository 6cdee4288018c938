/* Colours that a file's faces have, and its vertices lack. */
#pragma once

#include "core/splats/builder.h"

/* While faces are read; zero before the first. Where the model keeps faces' attributes, each colour becomes a material;
 * else a vertex has the mean of its faces' colours. */
typedef struct conic_face_colors {
  uint32_t *table;  /* of codes of 24 bits and their materials, by hash */
  float (*sums)[4]; /* a vertex: of colours, and how many */
  size_t n_sums;
} conic_face_colors;

/* Takes the linear colour of the model's triangles from `first` on, before they are added to its faces, whose current
 * material it becomes. Errors: MEMORY. */
conic_status conic_face_colors_take(conic_context *context, conic_face_colors *colors, conic_model *model, size_t first,
                                    const double linear[3]);

/* Gives the vertices their colours, unless `status` is a failure, and releases the rest. Errors: MEMORY, `status`. */
conic_status conic_face_colors_finish(conic_builder *builder, conic_face_colors *colors, conic_status status);
