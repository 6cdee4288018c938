/* The parts of a glTF that Gaussians are read from: its JSON, as far as it matters to them, and its buffers. */
#pragma once

#include "core/files/json_read.h"
#include "gaussians/formats/gaussian_formats.h"

enum { CONIC_GLTF_MOST_BUFFERS = 64, CONIC_GLTF_MOST_DEPTH = 32, CONIC_GLTF_NONE = -1 };

/* Attributes: those of one number of the harmonics follow the first five, of the old names the last three. */
enum {
  CONIC_GLTF_POSITION,
  CONIC_GLTF_ROTATION,
  CONIC_GLTF_SCALE,
  CONIC_GLTF_OPACITY,
  CONIC_GLTF_COLOR,
  CONIC_GLTF_SH,
  CONIC_GLTF_N_ATTRIBUTES = CONIC_GLTF_SH + CONIC_MOST_HARMONICS / 3
};

typedef struct conic_gltf_view {
  double buffer, offset, length, stride;
} conic_gltf_view;

typedef struct conic_gltf_accessor {
  double view, offset, type, count;
  int n_components, is_normalized, is_sparse;
} conic_gltf_accessor;

typedef struct conic_gltf_primitive {
  int mesh, is_gaussian, is_linear;
  double accessors[CONIC_GLTF_N_ATTRIBUTES];
} conic_gltf_primitive;

typedef struct conic_gltf_node {
  double mesh, matrix[16], translation[3], rotation[4], scale[3];
  int has_matrix, is_child;
  size_t first_child, n_children;
} conic_gltf_node;

typedef struct conic_gltf_buffer {
  const unsigned char *bytes;
  size_t n_bytes;
  unsigned char *own;    /* decoded */
  conic_mapping mapping; /* or a file */
} conic_gltf_buffer;

typedef struct conic_gltf_reader {
  const conic_gaussian_bytes *file;
  conic_json json;
  conic_gltf_buffer binary, buffers[CONIC_GLTF_MOST_BUFFERS];
  int n_buffers;
  conic_gltf_view *views;
  conic_gltf_accessor *accessors;
  conic_gltf_primitive *primitives;
  conic_gltf_node *nodes;
  double *children;
  size_t n_views, n_accessors, n_primitives, n_nodes, n_children;
  size_t view_room, accessor_room, primitive_room, node_room, child_room;
  int n_meshes;
  conic_gaussians *gaussians; /* null: they are counted */
  size_t n_placed;
} conic_gltf_reader;

/* Numbers from the JSON are doubles, and looked at when they are used. Whether one is an index below `end`. */
static inline int conic_gltf_is_index(double number, size_t end) {
  return number >= 0.0 && number < (double)end;
}

/* Fills in all but the last two members of a zeroed reader that has its file. Errors: INPUT, MEMORY. */
conic_status conic_gltf_parse(conic_gltf_reader *reader);
/* Releases what parsing has made; after failures, too. */
void conic_gltf_release(conic_gltf_reader *reader);

/* "FILE: what is wrong (at byte 0)". */
conic_status conic_gltf_wrong(const conic_gltf_reader *reader, const char *what);
