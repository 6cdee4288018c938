/* Colours that a file's faces have, and its vertices lack. */
#pragma once

#include "core/splats/builder.h"

/* While faces are read; zero before the first. Where the model keeps faces' attributes, each colour becomes a material;
 * else a vertex has the mean of its faces' colours. */
typedef struct conic_face_colors {
  conic_splats raw; /* of the triangles, as they stand in the file; NaN where one has none */
  size_t room;
} conic_face_colors;

/* Takes the colour of the model's triangles from `first` on, as it stands in the file; those before that have none are
 * white. Errors: MEMORY. */
conic_status conic_face_colors_take(conic_context *context, conic_face_colors *colors, const conic_model *model,
                                    size_t first, const double raw[3]);

/* Decodes the colours, whose kind is of conic_raw_kind, and gives them to the model's faces, which are made where
 * `keeps_faces`, or to the vertices; unless there is none, or `status` is a failure. Releases the rest. Errors: MEMORY,
 * `status`. */
conic_status conic_face_colors_finish(conic_builder *builder, conic_face_colors *colors, unsigned kind, int keeps_faces,
                                      conic_status status);
