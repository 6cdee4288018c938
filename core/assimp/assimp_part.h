/* Puts together the parts of a model that Assimp reads. Vertices with the same place, colour and alpha become one, as
 * in other files, even if their corners differ in other attributes. */
#pragma once

#include "core/assimp/assimp_process.h"
#include "core/files/input.h"
#include "core/splats/faces.h"
#include "core/splats/point_slots.h"

typedef struct conic_assimp_part_builder {
  conic_context *context;
  const char *name; /* of the file, for messages */
  conic_builder builder;
  conic_faces *faces; /* the model's, where faces are kept */
  int is_linear;      /* the file's colours are linear; else they are sRGB-encoded */
  conic_point_slots slots;
  double (*normals)[3];
  size_t normal_room; /* for the sums of the corners' normals at each point */
  int has_normals;
} conic_assimp_part_builder;

/* Errors: MEMORY. */
conic_status conic_assimp_parts_begin(conic_context *context, const char *name, conic_model_kind kind,
                                      const conic_read_options *options, conic_model *model,
                                      conic_assimp_part_builder *parts);

/* Takes the data after a part's record. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_assimp_take_part(conic_assimp_process *process, const conic_assimp_record *record,
                                    conic_assimp_part_builder *parts);

/* Gives the points their normals. Errors: MEMORY. */
conic_status conic_assimp_parts_end(conic_assimp_part_builder *parts);

/* Releases what the model has not taken. */
void conic_assimp_parts_release(conic_assimp_part_builder *parts);

/* The linear value of one of the file's colours. */
float conic_assimp_decode(const conic_assimp_part_builder *parts, float value);

/* The materials of a model that Assimp reads. */

/* Takes the data after a material's record as the next material of the model's faces. A picture that is missing or
 * cannot be read is a warning. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_assimp_take_material(const conic_input *input, conic_assimp_process *process,
                                        const conic_assimp_record *record, conic_assimp_part_builder *parts);
