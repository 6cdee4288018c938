/* The PLY reader. */
#ifndef CONIC_PLY_READ_H
#define CONIC_PLY_READ_H

#include "conic/model.h"
#include "core/files/input.h"
#include "core/formats/model_part.h"
#include "core/formats/ply_source.h"
#include "core/splats/builder.h"

/* Reads a model from the start of the file; with a delivery the points go there, and faces are passed over. On failure
 * *model is for the caller to release. Errors: INPUT, MEMORY, CANCELLED, the receiver's. */
conic_status conic_ply_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model);

/* Reads the shape from the header of a file at its start. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_ply_look(conic_input *input, const conic_read_options *options, conic_model_shape *shape);

/* Reads the elements `face` and `tristrips`; the source is at the start of the element's rows. Errors: as above. */
conic_status conic_ply_read_faces(conic_ply_source *source, const conic_ply_header *header, uint64_t n_vertices,
                                  conic_builder *builder);

#endif
