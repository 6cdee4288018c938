/* The materials of a model that Assimp reads. */
#ifndef CONIC_ASSIMP_MATERIAL_H
#define CONIC_ASSIMP_MATERIAL_H

#include "core/assimp/assimp_part.h"
#include "core/files/input.h"

/* Takes the data after a material's record as the next material of the model's faces. A picture that is missing or
 * cannot be read is a warning. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_assimp_take_material(const conic_input *input, conic_assimp_process *process,
                                        const conic_assimp_record *record, conic_assimp_part_builder *parts);

#endif
