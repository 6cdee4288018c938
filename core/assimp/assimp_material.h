/* The materials of a model that Assimp has read. */
#ifndef CONIC_ASSIMP_MATERIAL_H
#define CONIC_ASSIMP_MATERIAL_H

#include "core/assimp/assimp_part.h"
#include "core/files/input.h"

/* Takes what follows a material's record: it becomes the next of the model's faces. A picture that is not there or
 * cannot be read is a warning. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_assimp_take_material(const conic_input *input, conic_assimp_process *process,
                                        const conic_assimp_record *record, conic_assimp_part_builder *parts);

#endif
