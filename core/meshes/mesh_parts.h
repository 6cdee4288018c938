/* Puts together the parts of a mesh. Vertices with the same place, colour and alpha become one point, even if their
 * corners differ in other attributes. */
#pragma once

#include "core/meshes/point_slots.h"
#include "core/splats/builder.h"
#include "core/splats/faces.h"

typedef struct conic_mesh_parts {
  conic_context *context;
  const char *name; /* of the file, for messages */
  conic_builder builder;
  conic_faces *faces; /* the model's, where faces are kept */
  conic_point_slots slots;
  double (*normals)[3]; /* the sums of the corners' normals at each point; null while no part has any */
  size_t normal_room;
} conic_mesh_parts;

/* Vertices, and whether there are triangles between them. Arrays may be null but for the places. */
typedef struct conic_mesh_part {
  size_t n_vertices;
  int is_points;
  double (*position)[3];                                     /* in the world */
  float (*normal)[3], (*coordinate)[2], (*color)[3], *alpha; /* colours are linear */
  uint32_t *point;                                           /* which point each vertex became */
  size_t first_normal, first_coordinate;
} conic_mesh_part;

/* Errors: MEMORY. */
conic_status conic_mesh_parts_begin(conic_context *context, const char *name, const conic_read_options *options,
                                    conic_model *model, conic_mesh_parts *parts);

/* Adds a part's vertices. Errors: INPUT, MEMORY. */
conic_status conic_mesh_parts_add(conic_mesh_parts *parts, conic_mesh_part *part);
/* And triangles between vertices of a part that was added. Errors: INPUT (an index), MEMORY. */
conic_status conic_mesh_parts_add_triangles(conic_mesh_parts *parts, const conic_mesh_part *part,
                                            const uint32_t (*triangles)[3], size_t n);
void conic_mesh_part_release(conic_context *context, conic_mesh_part *part);

/* Gives the points their normals. Errors: MEMORY. */
conic_status conic_mesh_parts_end(conic_mesh_parts *parts);

/* Releases what the model has not taken. */
void conic_mesh_parts_release(conic_mesh_parts *parts);
