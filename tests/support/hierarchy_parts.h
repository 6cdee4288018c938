/* A hierarchy of several files as one: the sizes of the first two parts, 4 bytes each, and then the parts: metadata, a
 * page of the hierarchy, and points, which are those of every node of an EPT. */
#pragma once

#include <stdint.h>
#include <string.h>

#include "conic/layers_draw.h"
#include "core/base/byte_order.h"
#include "tests/support/folder.h"

typedef struct hierarchy_parts {
  char folder[FOLDER_ROOM], first[192];
  int is_ept;
} hierarchy_parts;

static const char *const hierarchy_ept_files[] = {"ept.json", "ept-hierarchy/0-0-0-0.json", "ept-data/0-0-0-0.bin",
                                                  "ept-data/1-0-0-0.bin", "ept-data/1-1-1-1.bin"};
static const char *const hierarchy_potree_files[] = {"metadata.json", "hierarchy.bin", "octree.bin"};

static inline void hierarchy_write(const hierarchy_parts *parts, const char *name, const unsigned char *bytes,
                                   size_t n_bytes) {
  char path[192];
  snprintf(path, sizeof path, "%s/%s", parts->folder, name);
  FILE *file = fopen(path, "wb");
  if (!file || fwrite(bytes, 1, n_bytes, file) != n_bytes || fclose(file) != 0)
    exit(1);
}

/* Writes the files into a folder of their own. */
static inline hierarchy_parts hierarchy_unpack(int is_ept, const unsigned char *bytes, size_t n_bytes) {
  hierarchy_parts parts = {.is_ept = is_ept};
  const char *const *names = is_ept ? hierarchy_ept_files : hierarchy_potree_files;
  size_t sizes[3] = {0}, at = n_bytes < 8 ? n_bytes : 8;
  char path[192];
  folder_make(parts.folder);
  for (int i = 0; is_ept && i < 2; i++) {
    snprintf(path, sizeof path, "%s/%s", parts.folder, i ? "ept-data" : "ept-hierarchy");
    if (!conic_disk_make_folder(path))
      exit(1);
  }
  for (int i = 0; i < 3; i++) {
    uint32_t said = i < 2 && n_bytes >= 8 ? conic_load_32(bytes + 4 * i) : 0;
    sizes[i] = i < 2 && said < n_bytes - at ? said : n_bytes - at;
    for (int k = i; k < (is_ept ? 5 : 3) && (k == i || i == 2); k++)
      hierarchy_write(&parts, names[k], bytes + at, sizes[i]);
    at += sizes[i];
  }
  snprintf(parts.first, sizeof parts.first, "%s/%s", parts.folder, names[0]);
  return parts;
}

static inline void hierarchy_remove(const hierarchy_parts *parts) {
  char path[192];
  for (int i = 0; i < (parts->is_ept ? 5 : 3); i++) {
    snprintf(path, sizeof path, "%s/%s", parts->folder,
             parts->is_ept ? hierarchy_ept_files[i] : hierarchy_potree_files[i]);
    unlink(path);
  }
  for (int i = 0; parts->is_ept && i < 2; i++) {
    snprintf(path, sizeof path, "%s/%s", parts->folder, i ? "ept-data" : "ept-hierarchy");
    rmdir(path);
  }
  rmdir(parts->folder);
}

/* Reads all of a hierarchy. */
static inline conic_status hierarchy_read(conic_context *context, const char *path) {
  conic_layers_access access;
  conic_layers *layers;
  conic_splats splats;
  conic_layers_access_init(&access);
  access.memory_bytes = (uint64_t)64 << 20;
  conic_status status = conic_layers_open(context, path, &access, &layers);
  if (status == CONIC_OK) {
    status = conic_layers_splats(layers, 1.5f, &splats);
    conic_splats_release(context, &splats);
  }
  conic_layers_close(layers);
  return status;
}

static inline conic_status hierarchy_read_parts(conic_context *context, int is_ept, const unsigned char *bytes,
                                                size_t n_bytes) {
  hierarchy_parts parts = hierarchy_unpack(is_ept, bytes, n_bytes);
  conic_status status = hierarchy_read(context, parts.first);
  hierarchy_remove(&parts);
  return status;
}

/* --- examples; each returns how many bytes there are --- */

static inline size_t hierarchy_join(unsigned char *to, const char *metadata, const void *page, size_t n_page,
                                    const void *points, size_t n_points) {
  const uint32_t sizes[2] = {(uint32_t)strlen(metadata), (uint32_t)n_page};
  conic_store_32(to, sizes[0]);
  conic_store_32(to + 4, sizes[1]);
  memcpy(to + 8, metadata, sizes[0]);
  memcpy(to + 8 + sizes[0], page, n_page);
  memcpy(to + 8 + sizes[0] + n_page, points, n_points);
  return 8 + sizes[0] + n_page + n_points;
}

/* Of every node two points, in the middle of the root's cell, where all children meet. */
static inline size_t hierarchy_ept_example(unsigned char *to) {
  static const char page[] = "{\"0-0-0-0\": 2, \"1-0-0-0\": 2, \"1-1-1-1\": 2}";
  static const unsigned char points[28] = {1, 0, 0, 0, [12] = 9, 1, [14] = 0, 0, 0, 0, 1, [26] = 200};
  return hierarchy_join(to,
                        "{\"bounds\": [0, 0, 0, 8, 8, 8], \"boundsConforming\": [4, 4, 4, 5, 5, 5], \"dataType\": "
                        "\"binary\",\n\"points\": 6, \"span\": 4, \"srs\": {}, \"schema\": [\n{\"name\": \"X\", "
                        "\"type\": \"signed\", \"size\": 4, \"scale\": 0.01, \"offset\": 4},\n{\"name\": \"Y\", "
                        "\"type\": \"signed\", \"size\": 4, \"scale\": 0.01, \"offset\": 4},\n{\"name\": \"Z\", "
                        "\"type\": \"signed\", \"size\": 4, \"scale\": 0.01, \"offset\": 4},\n{\"name\": "
                        "\"Intensity\", \"type\": \"unsigned\", \"size\": 2}]}",
                        page, sizeof page - 1, points, sizeof points);
}

static inline size_t hierarchy_potree_example(unsigned char *to) {
  unsigned char page[44] = {0}, points[36] = {0};
  page[1] = 0x80; /* a child */
  page[2] = 2;
  page[14] = 24;
  page[22] = 1; /* a leaf */
  page[24] = 1;
  page[28] = 24;
  page[36] = 12;
  points[0] = 5;
  return hierarchy_join(
      to,
      "{\"version\": \"2.0\", \"points\": 3, \"hierarchy\": {\"firstChunkSize\": 44, \"stepSize\": 4, "
      "\"depth\": 1},\n\"offset\": [4, 4, 4], \"scale\": [0.01, 0.01, 0.01], \"spacing\": 2,\n"
      "\"boundingBox\": {\"min\": [0, 0, 0], \"max\": [8, 8, 8]}, \"encoding\": \"DEFAULT\",\n"
      "\"attributes\": [{\"name\": \"position\", \"size\": 12, \"numElements\": 3, \"elementSize\": "
      "4, \"type\": \"int32\", \"min\": [4, 4, 4], \"max\": [5, 5, 5]}]}",
      page, sizeof page, points, sizeof points);
}

static inline void hierarchy_put(unsigned char *to, size_t n_bytes, uint64_t value) {
  for (size_t i = 0; i < n_bytes; i++)
    to[i] = (unsigned char)(value >> 8 * i);
}

static inline void hierarchy_put_double(unsigned char *to, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  hierarchy_put(to, 8, bits);
}

/* A COPC of one point: its chunk is the point as it is, and nine layers of nothing. */
static inline size_t hierarchy_copc_example(unsigned char *to) {
  enum { POINTS = 375 + 54 + 160 + 54 + 40, CHUNK = POINTS + 8, N_CHUNK = 30 + 4 + 36, PAGE = CHUNK + N_CHUNK };
  memset(to, 0, PAGE + 32);
  memcpy(to, "LASF", 4);
  to[24] = 1;
  to[25] = 4;
  hierarchy_put(to + 94, 2, 375);
  hierarchy_put(to + 96, 4, POINTS);
  hierarchy_put(to + 100, 4, 2);
  to[104] = 0x86;
  to[105] = 30;
  to[247] = 1;
  for (size_t axis = 0; axis < 3; axis++) {
    hierarchy_put_double(to + 131 + 8 * axis, 0.01);
    hierarchy_put_double(to + 179 + 16 * axis, 5.0);
    hierarchy_put_double(to + 187 + 16 * axis, 4.0);
    hierarchy_put_double(to + 429 + 8 * axis, 4.0);
  }
  memcpy(to + 377, "copc", 5);
  hierarchy_put(to + 393, 2, 1);
  hierarchy_put(to + 395, 2, 160);
  hierarchy_put_double(to + 453, 4.0);
  hierarchy_put_double(to + 461, 1.0);
  hierarchy_put(to + 469, 8, PAGE);
  hierarchy_put(to + 477, 8, 32);
  unsigned char *record = to + 589;
  memcpy(record + 2, "laszip encoded", 15);
  hierarchy_put(record + 18, 2, 22204);
  hierarchy_put(record + 20, 2, 40);
  record[54] = 3;
  hierarchy_put(record + 54 + 12, 4, UINT32_MAX);
  record[54 + 32] = 1;
  record[54 + 34] = 10;
  record[54 + 36] = 30;
  record[54 + 38] = 3;
  unsigned char *chunk = to + CHUNK;
  for (size_t axis = 0; axis < 3; axis++)
    hierarchy_put(chunk + 4 * axis, 4, 400 + 10 * axis);
  chunk[12] = 7;
  chunk[14] = 0x11;
  chunk[30] = 1;
  hierarchy_put(to + PAGE + 16, 8, CHUNK);
  hierarchy_put(to + PAGE + 24, 4, N_CHUNK);
  hierarchy_put(to + PAGE + 28, 4, 1);
  return PAGE + 32;
}
