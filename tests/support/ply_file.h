/* PLY files put together by hand, in one of the three encodings, and read. */
#pragma once

#include <stdint.h>

#include "tests/support/files.h"

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define ASCII "ply\nformat ascii 1.0\n"

typedef enum encoding { TEXT, LITTLE, BIG, N_ENCODINGS } encoding;

typedef struct ply_file {
  encoding encoding;
  char bytes[1 << 16];
  size_t n;
} ply_file;

/* The one that is put together, and who reads it. */
static ply_file ply;
static conic_context *context;

static inline void ply_add_text(const char *text) {
  memcpy(ply.bytes + ply.n, text, strlen(text));
  ply.n += strlen(text);
}

static inline void ply_begin(encoding kind, const char *header) {
  static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  ply.n = 0;
  ply.encoding = kind;
  ply_add_text("ply\nformat ");
  ply_add_text(names[kind]);
  ply_add_text(" 1.0\n");
  ply_add_text(header);
  ply_add_text("end_header\n");
}

static inline void ply_add_bits(uint64_t bits, int n_bytes) {
  for (int i = 0; i < n_bytes; i++)
    ply.bytes[ply.n++] = (char)(bits >> 8 * (ply.encoding == BIG ? n_bytes - 1 - i : i));
}

/* Letters: c C s S i I (signed and unsigned of 1, 2, 4 bytes), f, d. */
static inline void ply_add(char type, double value) {
  char text[40];
  uint64_t bits = 0;
  uint32_t half;
  float small = (float)value;
  if (ply.encoding == TEXT) {
    snprintf(text, sizeof text, type == 'd' ? "%.17g " : type == 'f' ? "%.9g " : "%.0f ", value);
    ply_add_text(text);
    return;
  }
  memcpy(&half, &small, sizeof half);
  if (type == 'd')
    memcpy(&bits, &value, sizeof bits);
  else
    bits = type == 'f' ? half : (uint64_t)(int64_t)value;
  ply_add_bits(bits, type == 'd' ? 8 : strchr("iIf", type) ? 4 : strchr("sS", type) ? 2 : 1);
}

static inline void ply_end_row(void) {
  if (ply.encoding == TEXT)
    ply_add_text("\n");
}

static inline conic_status ply_read(conic_model *model) {
  const char *path = files_write_bytes("a.ply", ply.bytes, ply.n);
  conic_status status = conic_model_read(context, path, NULL, model);
  CHECK(unlink(path) == 0);
  if (status != CONIC_OK)
    CHECK(model->points.count == 0 && !model->points.position[0] && !model->triangles && model->n_triangles == 0);
  return status;
}

static inline conic_status ply_read_text(const char *text, conic_model *model) {
  ply.n = 0;
  ply_add_text(text);
  return ply_read(model);
}

static inline int ply_same_arrays(float *const a[3], float *const b[3], size_t count) {
  for (int axis = 0; axis < 3; axis++)
    if (!a[axis] != !b[axis] || (a[axis] && memcmp(a[axis], b[axis], count * sizeof(float)) != 0))
      return 0;
  return 1;
}

static inline int ply_same_models(const conic_model *a, const conic_model *b) {
  const conic_splats *p = &a->points, *q = &b->points;
  return p->count == q->count && a->n_triangles == b->n_triangles && conic_splats_fields(p) == conic_splats_fields(q) &&
         memcmp(p->origin, q->origin, sizeof p->origin) == 0 && ply_same_arrays(p->position, q->position, p->count) &&
         ply_same_arrays(p->tangent_u, q->tangent_u, p->count) &&
         ply_same_arrays(p->tangent_v, q->tangent_v, p->count) && ply_same_arrays(p->normal, q->normal, p->count) &&
         ply_same_arrays(p->color, q->color, p->count) &&
         (!p->opacity || memcmp(p->opacity, q->opacity, p->count * sizeof(float)) == 0) &&
         (!p->dot || memcmp(p->dot, q->dot, p->count * sizeof(float)) == 0) &&
         (!a->n_triangles || memcmp(a->triangles, b->triangles, a->n_triangles * sizeof *a->triangles) == 0);
}

/* Every type, any order, lists in the vertices and elsewhere, unknown elements before, between and behind. */
static inline void ply_put_mixture(encoding kind, int has_vertex_list) {
  ply_begin(kind, has_vertex_list
                      ? "comment a comment\nobj_info an info\nelement camera 1\nproperty float view_px\n"
                        "property list uchar double knots\nelement vertex 3\nproperty uchar blue\n"
                        "property list short ushort extra\nproperty float z\nproperty int8 flag\n"
                        "property float y\nproperty uint8 green\nproperty float32 x\nproperty uint32 stamp\n"
                        "property uchar red\nproperty double time\nproperty int16 a\nproperty uint16 b\n"
                        "element nothing 0\nproperty float q\nelement empty 7\nelement face 2\n"
                        "property uchar f\nproperty list uchar int vertex_indices\n"
                        "property list int8 float64 t\nelement edge 1\nproperty int vertex1\n"
                      : "element camera 1\nproperty float view_px\nproperty list uchar double knots\n"
                        "element vertex 3\nproperty uchar blue\nproperty float z\nproperty int8 flag\n"
                        "property float y\nproperty uint8 green\nproperty float32 x\nproperty uint32 stamp\n"
                        "property uchar red\nproperty double time\nproperty int16 a\nproperty uint16 b\n"
                        "element nothing 0\nproperty float q\nelement empty 7\nelement face 2\n"
                        "property uchar f\nproperty list uchar int vertex_indices\n"
                        "property list int8 float64 t\nelement edge 1\nproperty int vertex1\n");
  ply_add('f', 0.1);
  ply_add('C', 2), ply_add('d', 0.2), ply_add('d', -1e300);
  ply_end_row();
  for (int i = 0; i < 3; i++) {
    ply_add('C', 10 * i);
    if (has_vertex_list) {
      ply_add('s', i);
      for (int k = 0; k < i; k++)
        ply_add('S', 65535);
    }
    ply_add('f', 0.3 + i), ply_add('c', -128), ply_add('f', 0.2 + i), ply_add('C', 100 + i),
        ply_add('f', 1e-3 / (i + 1));
    ply_add('I', 4294967295.0), ply_add('C', 255), ply_add('d', 0.1), ply_add('s', -32768), ply_add('S', 65535);
    ply_end_row();
  }
  for (int i = 0; i < 2; i++) {
    ply_add('C', 7), ply_add('C', 3 + i);
    for (int k = 0; k < 3 + i; k++)
      ply_add('i', k % 3);
    ply_add('c', 1), ply_add('d', 0.5);
    ply_end_row();
  }
  ply_add('i', -5);
  ply_end_row();
}
