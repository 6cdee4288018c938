/* Meshes packed by KHR_draco_mesh_compression, which a module unpacks by libdraco. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "core/base/machine.h"

typedef struct conic_draco_mesh {
  void *mesh; /* null: it could not be unpacked */
  size_t n_vertices, n_triangles;
} conic_draco_mesh;

/* The module's one symbol, conic_draco_bridge. */
typedef struct conic_draco_functions {
  const char *version; /* as in every module (core/base/machine.h) */
  conic_draco_mesh (*open)(const unsigned char *bytes, size_t n_bytes);
  void (*triangles)(const conic_draco_mesh *mesh, uint32_t (*triangles)[3]);
  /* n numbers of every vertex, integers as they are; 0 where there is no attribute of that id and number. */
  int (*attribute)(const conic_draco_mesh *mesh, uint32_t id, int n, float *values);
  void (*close)(conic_draco_mesh *mesh);
} conic_draco_functions;

#ifndef __cplusplus

/* Whether there is such a module, and what it has; null where it cannot be loaded. */
static inline int conic_draco_is_there(void) {
  return conic_module_is_there("conic-draco.so");
}
static inline const conic_draco_functions *conic_draco_load(void) {
  char message[CONIC_MODULE_MESSAGE];
  return conic_module_load("conic-draco.so", "conic_draco_bridge", message);
}

#endif
