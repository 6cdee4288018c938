/* The reader of meshes in glTF. */
#pragma once

#include "core/files/input.h"
#include "core/gltf/draco.h"
#include "core/gltf/gltf.h"
#include "core/meshes/mesh_parts.h"

/* Reads from the start of the file; a delivery gets nothing. On failure *model is for the caller to release. Errors:
 * INPUT, UNSUPPORTED (an extension that is required), MEMORY, CANCELLED. */
conic_status conic_gltf_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                             conic_model *model);

/* --- what the reader's files share --- */

typedef struct conic_gltf_reader {
  conic_gltf gltf;
  const conic_read_options *options;
  conic_mesh_parts parts;
  int has_triangles; /* some primitive that is drawn has */
  int is_counting;   /* the first walk over the scene only looks for them */
  uint32_t *made; /* of each material, and of none after all, its number among the model's; UINT32_MAX: not made yet */
  conic_draco_mesh draco; /* of the primitive that is read */

  /* The vertices that were added last, and whose they were: primitives may share them. */
  conic_mesh_part part;
  const conic_gltf_primitive *part_primitive;
  conic_gltf_texture_use part_use;
  double part_world[3][4];
  int n_skipped_lines;
} conic_gltf_reader;

/* The use of the texture that gives a material's colour; null: none is drawn. */
const conic_gltf_texture_use *conic_gltf_color_texture(const conic_gltf *gltf, const conic_gltf_material *material);

/* Makes the material of a number (NONE: what glTF has for none) the one of the triangles that follow. Errors: INPUT,
 * MEMORY, CANCELLED. */
conic_status conic_gltf_use_material(conic_gltf_reader *reader, double number);

/* Adds a primitive of a node. Errors: INPUT, MEMORY, UNSUPPORTED. */
conic_status conic_gltf_add_primitive(conic_gltf_reader *reader, const conic_gltf_node *node,
                                      const conic_gltf_primitive *primitive, const double world[3][4]);
