/* glTF files made by hand: numbers of every type in a buffer, and the JSON that leads to them. */
#pragma once

#include "tests/support/mesh_file.h"

enum { GLTF_INT8 = 5120, GLTF_UINT8, GLTF_INT16, GLTF_UINT16, GLTF_UINT32 = 5125, GLTF_FLOAT };

/* How an accessor's numbers are stored. */
typedef struct gltf_storage {
  int component, is_normalized, stride, is_sparse;
} gltf_storage;

typedef struct gltf_file {
  mesh_file buffer, views, accessors;
  int n_views, n_accessors;
} gltf_file;

static inline size_t gltf_size(int component) {
  return component == GLTF_INT8 || component == GLTF_UINT8 ? 1 : component <= GLTF_UINT16 ? 2 : 4;
}

static inline void gltf_number(mesh_file *to, int component, double value) {
  if (component == GLTF_FLOAT) {
    float number = (float)value;
    mesh_put(to, &number, sizeof number);
  } else
    mesh_number(to, (uint32_t)(int64_t)value, gltf_size(component));
}

/* The whole number that stands for `value`, which a normalized one is a part of its greatest. */
static inline double gltf_code(gltf_storage storage, double value) {
  static const double most[] = {127, 255, 32767, 65535};
  return storage.is_normalized && storage.component < GLTF_UINT32
             ? floor(value * most[storage.component - GLTF_INT8] + 0.5)
             : value;
}

/* Ends a view of what was put from `start` on; returns its number. */
static inline int gltf_view(gltf_file *file, size_t start, int stride) {
  mesh_text(&file->views, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu", file->n_views ? "," : "", start,
            file->buffer.n - start);
  if (stride)
    mesh_text(&file->views, ",\"byteStride\":%d", stride);
  mesh_text(&file->views, "}");
  while (file->buffer.n % 4)
    mesh_number(&file->buffer, 0, 1);
  return file->n_views++;
}

static inline int gltf_put_values(gltf_file *file, gltf_storage storage, int n, const double *values, size_t count) {
  size_t start = file->buffer.n;
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < n; k++)
      gltf_number(&file->buffer, storage.component, gltf_code(storage, values[i * (size_t)n + (size_t)k]));
    for (size_t at = (size_t)n * gltf_size(storage.component); storage.stride && at < (size_t)storage.stride; at++)
      mesh_number(&file->buffer, 0xAB, 1);
  }
  return gltf_view(file, start, storage.stride);
}

/* An accessor of `count` items of n numbers, the second half of which are sparse values where it is sparse; returns its
 * number. */
static inline int gltf_put(gltf_file *file, gltf_storage storage, int n, const double *values, size_t count) {
  static const char *const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  double base[256] = {0};
  size_t half = count / 2;
  memcpy(base, values, (storage.is_sparse ? half : count) * (size_t)n * sizeof *values);
  int view = gltf_put_values(file, storage, n, base, count);
  mesh_text(&file->accessors, "%s{\"bufferView\":%d,\"componentType\":%d,\"count\":%zu,\"type\":\"%s\"",
            file->n_accessors ? "," : "", view, storage.component, count, n == 16 ? "MAT4" : types[n]);
  if (storage.is_normalized)
    mesh_text(&file->accessors, ",\"normalized\":true");
  if (storage.is_sparse) {
    size_t start = file->buffer.n;
    for (size_t i = half; i < count; i++)
      mesh_number(&file->buffer, (uint32_t)i, 2);
    int of_indices = gltf_view(file, start, 0);
    gltf_storage plain = storage;
    plain.stride = 0;
    int of_values = gltf_put_values(file, plain, n, values + half * (size_t)n, count - half);
    mesh_text(&file->accessors,
              ",\"sparse\":{\"count\":%zu,\"indices\":{\"bufferView\":%d,\"componentType\":5123},\"values\":"
              "{\"bufferView\":%d}}",
              count - half, of_indices, of_values);
  }
  mesh_text(&file->accessors, "}");
  return file->n_accessors++;
}

typedef enum gltf_container { GLTF_EMBEDDED, GLTF_BESIDE, GLTF_GLB } gltf_container;

/* All of it as a file: `rest` is the JSON but for asset, accessors, views and the buffer, which may lie in a file
 * g.bin. */
static inline void gltf_make(mesh_file *to, const gltf_file *file, gltf_container container, const char *rest) {
  static mesh_file json;
  json.n = to->n = 0;
  mesh_text(&json, "{\"asset\":{\"version\":\"2.0\"},%s,\"accessors\":[%.*s],\"bufferViews\":[%.*s]", rest,
            (int)file->accessors.n, (const char *)file->accessors.bytes, (int)file->views.n,
            (const char *)file->views.bytes);
  mesh_text(&json, ",\"buffers\":[{\"byteLength\":%zu", file->buffer.n);
  if (container == GLTF_BESIDE)
    mesh_text(&json, ",\"uri\":\"g.bin\"");
  if (container == GLTF_EMBEDDED) {
    mesh_text(&json, ",\"uri\":\"data:application/octet-stream;base64,");
    mesh_base64(&json, file->buffer.bytes, file->buffer.n);
    mesh_text(&json, "\"");
  }
  mesh_text(&json, "}]}");
  if (container != GLTF_GLB) {
    mesh_put(to, json.bytes, json.n);
    return;
  }
  while (json.n % 4)
    mesh_put(&json, " ", 1);
  mesh_put(to, "glTF\2\0\0\0", 8);
  mesh_number(to, (uint32_t)(28 + json.n + file->buffer.n), 4);
  mesh_number(to, (uint32_t)json.n, 4);
  mesh_put(to, "JSON", 4);
  mesh_put(to, json.bytes, json.n);
  mesh_number(to, (uint32_t)file->buffer.n, 4);
  mesh_put(to, "BIN\0", 4);
  mesh_put(to, file->buffer.bytes, file->buffer.n);
}

/* A file that has some of everything: instances, a target, a skin, sparse and strided numbers, materials with textures
 * in the file, two scenes, and points. */
static inline void gltf_make_rich(mesh_file *to, gltf_container container) {
  static const double places[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  static const double coordinates[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}}, joints[16] = {0};
  static const double weights[4][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}};
  static const double corners[4] = {0, 1, 2, 3}, moved[2][3] = {{0, 0, 0}, {4, 0, 0}};
  static const png_kind picture = {.width = 2, .height = 2, .kind = PNG_COLOR, .depth = 8};
  static gltf_file file;
  static png_file png;
  double inverse[16];
  char rest[3000];
  memset(&file, 0, sizeof file);
  for (int i = 0; i < 16; i++)
    inverse[i] = i % 5 == 0;
  gltf_put(&file, (gltf_storage){GLTF_INT16, 1, 8, 1}, 3, places[0], 4);
  gltf_put(&file, (gltf_storage){GLTF_UINT8, 1, 4, 0}, 2, coordinates[0], 4);
  gltf_put(&file, (gltf_storage){GLTF_UINT8, 0, 0, 0}, 1, corners, 4);
  gltf_put(&file, (gltf_storage){GLTF_UINT8, 0, 0, 0}, 4, joints, 4);
  gltf_put(&file, (gltf_storage){GLTF_UINT16, 1, 0, 0}, 4, weights[0], 4);
  gltf_put(&file, (gltf_storage){GLTF_FLOAT, 0, 0, 0}, 16, inverse, 1);
  gltf_put(&file, (gltf_storage){GLTF_FLOAT, 0, 0, 0}, 3, moved[0], 2);
  png.n_bytes = 0;
  png_make(&png, &picture);
  size_t start = file.buffer.n;
  mesh_put(&file.buffer, png.bytes, png.n_bytes);
  int view = gltf_view(&file, start, 0);
  snprintf(
      rest, sizeof rest,
      "\"extensionsUsed\":[\"KHR_mesh_quantization\",\"EXT_mesh_gpu_instancing\"],\"scene\":1,\"scenes\":[{\"nodes\":["
      "2]},"
      "{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{\"children\":[3,4],\"rotation\":[0,0,1,1]},{},"
      "{\"mesh\":1,\"weights\":[0.5],\"scale\":[-1,1,2],\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{"
      "\"TRANSLATION\":6}}}},{\"mesh\":2,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,1,2,3,1]}],\"skins\":[{\"joints\":[1],"
      "\"inverseBindMatrices\":5}],\"meshes\":[{\"primitives\":[{\"mode\":5,\"attributes\":{\"POSITION\":0,"
      "\"TEXCOORD_0\":1,\"JOINTS_0\":3,\"WEIGHTS_0\":4},\"indices\":2,\"material\":0}]},{\"primitives\":[{\"mode\":6,"
      "\"attributes\":{\"POSITION\":0,\"NORMAL\":0,\"COLOR_0\":0,\"TEXCOORD_1\":1},\"material\":1,\"targets\":[{"
      "\"POSITION\":0}]}]},{\"primitives\":[{\"mode\":0,\"attributes\":{\"POSITION\":0}}]}],\"materials\":[{"
      "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25,\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.5,0.25,0.5],"
      "\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0,1],\"rotation\":0.5,"
      "\"scale\":[2,3]}}}}},{\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":0,\"texCoord\":1},"
      "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1]}}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648}],"
      "\"textures\":[{\"sampler\":0,\"source\":0}],\"images\":[{\"mimeType\":\"image/png\",\"bufferView\":%d}]",
      view);
  gltf_make(to, &file, container, rest);
}
