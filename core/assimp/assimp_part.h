/* The parts and materials of a model that Assimp reads, as they come through the pipe. */
#pragma once

#include "core/assimp/assimp_process.h"
#include "core/files/input.h"
#include "core/meshes/mesh_parts.h"

/* Takes the data after a part's record. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_assimp_take_part(conic_assimp_process *process, const conic_assimp_record *record,
                                    conic_mesh_parts *parts);

/* The linear value of one of the file's colours, which are sRGB-encoded. */
float conic_assimp_decode(float value);

/* Takes the data after a material's record as the next material of the model's faces. A picture that is missing or
 * cannot be read is a warning. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_assimp_take_material(const conic_input *input, conic_assimp_process *process,
                                        const conic_assimp_record *record, conic_mesh_parts *parts);
