/* What reading a model and streaming its points share. */
#pragma once

#include "conic/triangles.h"
#include "core/files/input.h"
#include "core/splats/builder.h"

/* Opens a file and finds its format at its start. On success the caller closes the input. Errors: as conic_input_open,
 * and CANCELLED. */
conic_status conic_model_open(conic_context *context, const char *path, conic_input *input, conic_model_kind *kind);

/* Reads the file; with a delivery the points go there, except for an OBJ's. On failure *model is for the caller to
 * release. Errors: INPUT, MEMORY, CANCELLED, the receiver's. */
conic_status conic_model_read_kind(conic_input *input, conic_model_kind kind, const conic_read_options *options,
                                   const conic_delivery *delivery, conic_model *model);

/* Hands over a PLY's points as conic_model_stream does, and its triangles in their order, some at a time; polygons
 * become fans. Errors: as conic_model_stream; INPUT (not a PLY). */
conic_status conic_mesh_stream(conic_context *context, const char *path, conic_batch_receiver *receive,
                               conic_status (*receive_faces)(void *cookie, const uint32_t (*corners)[3], size_t n),
                               void *cookie);

/* Whether its colours are fractions of 1, whose meaning conic_read_options.colors_are says. */
static inline int conic_model_has_fractions(const conic_model *model) {
  return (model->colors_are == CONIC_COLORS_DISPLAY || model->colors_are == CONIC_COLORS_LINEAR) &&
         model->kind != CONIC_MODEL_GLTF && model->kind != CONIC_MODEL_GLB;
}

/* Null options become the defaults. Errors: ARGUMENT. */
conic_status conic_read_options_check(conic_context *context, const char *path, const conic_read_options *options,
                                      conic_read_options *settings);

/* conic_triangles_read with these options, which are set to keep faces. */
conic_status conic_triangles_read_model(conic_context *context, const char *path, conic_read_options *options,
                                        conic_triangles *triangles);
