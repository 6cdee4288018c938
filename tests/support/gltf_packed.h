/* One square in glTF, packed by Draco and by meshopt. */
#pragma once

#include "tests/support/gltf_file.h"

/* The square of corners 0 and 1, by Google's encoder with 11 bits. */
static const unsigned char gltf_draco_bytes[] = {
    0x44, 0x52, 0x41, 0x43, 0x4f, 0x02, 0x02, 0x01, 0x01, 0x00, 0x00, 0x00, 0x04, 0x02, 0x00, 0x02, 0x00, 0x00, 0x01,
    0x1f, 0xff, 0x01, 0x11, 0x01, 0xff, 0x00, 0x00, 0x02, 0x03, 0x09, 0x02, 0x01, 0x00, 0x00, 0x09, 0x03, 0x00, 0x01,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x80, 0x3f, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x01, 0x00,
    0x03, 0x03, 0x01, 0x20, 0x01, 0x20, 0x03, 0x00, 0x10, 0x84, 0x4a, 0xa4, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0x07,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x3f, 0x0b};

/* The same places as three floats, and the corners, by the encoders of meshoptimizer 0.18. */
static const unsigned char gltf_meshopt_vertices[] = {
    0xa0, 0x00, 0x00, 0x01, 0x3f, 0x00, 0x00, 0x00, 0xff, 0xff, 0xff, 0x01, 0x3f, 0x00, 0x00, 0x00, 0x7e, 0x7d,
    0x7e, 0x00, 0x00, 0x01, 0x0c, 0x00, 0x00, 0x00, 0xff, 0x01, 0x0c, 0x00, 0x00, 0x00, 0x7e, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
static const unsigned char gltf_meshopt_triangles[] = {0xe1, 0xf0, 0x10, 0x00, 0x76, 0x87, 0x56, 0x67, 0x78, 0xa9,
                                                       0x86, 0x65, 0x89, 0x68, 0x98, 0x01, 0x69, 0x00, 0x00},
                           gltf_meshopt_sequence[] = {0xd1, 0x00, 0x04, 0x04, 0x00, 0x02, 0x08, 0x00, 0x00, 0x00, 0x00};

/* All but the last `cut` bytes of it, of so many vertices; returns the rest of the JSON. */
static inline const char *gltf_draco(gltf_file *file, size_t cut, int count) {
  memset(file, 0, sizeof *file);
  mesh_put(&file->buffer, gltf_draco_bytes, sizeof gltf_draco_bytes - cut);
  gltf_view(file, 0, 0);
  mesh_text(&file->accessors,
            "{\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\"},{\"componentType\":5126,\"count\":%d,"
            "\"type\":\"VEC2\"},{\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}",
            count, count);
  return "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"nodes\":[{\"mesh\":0}],\"meshes\":[{"
         "\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":2,\"extensions\":{"
         "\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":1,\"TEXCOORD_0\":0}}}}]}]";
}

/* Its corners by a mode of the extension, TRIANGLES or INDICES, but for the last `cut` bytes of them. */
static inline const char *gltf_meshopt(gltf_file *file, const char *mode, size_t cut, int count) {
  int is_sequence = strcmp(mode, "INDICES") == 0;
  size_t n = is_sequence ? sizeof gltf_meshopt_sequence : sizeof gltf_meshopt_triangles;
  memset(file, 0, sizeof *file);
  mesh_put(&file->buffer, gltf_meshopt_vertices, sizeof gltf_meshopt_vertices);
  mesh_put(&file->buffer, is_sequence ? gltf_meshopt_sequence : gltf_meshopt_triangles, n);
  while (file->buffer.n % 4)
    mesh_number(&file->buffer, 0, 1);
  mesh_text(&file->views,
            "{\"buffer\":1,\"byteLength\":%d,\"byteStride\":12,\"extensions\":{\"EXT_meshopt_compression\":{"
            "\"buffer\":0,\"byteLength\":%zu,\"byteStride\":12,\"count\":%d,\"mode\":\"ATTRIBUTES\"}}},{\"buffer\":1,"
            "\"byteLength\":12,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":%zu,"
            "\"byteLength\":%zu,\"byteStride\":2,\"count\":6,\"mode\":\"%s\"}}}",
            12 * 4, sizeof gltf_meshopt_vertices, count, sizeof gltf_meshopt_vertices, n - cut, mode);
  mesh_text(&file->accessors, "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
                              "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}");
  return "\"extensionsRequired\":[\"EXT_meshopt_compression\"],\"nodes\":[{\"mesh\":0}],\"meshes\":[{"
         "\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]";
}
