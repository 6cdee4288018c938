#include <draco/compression/decode.h>

#include <new>

#include "conic/export.h"
#include "conic/version.h"

extern "C" {
#include "core/gltf/draco.h"
}

static const draco::Mesh *mesh_of(const conic_draco_mesh *opened) {
  return static_cast<const draco::Mesh *>(opened->mesh);
}

static conic_draco_mesh open_mesh(const unsigned char *bytes, size_t n_bytes) {
  conic_draco_mesh opened = {nullptr, 0, 0};
  try {
    draco::DecoderBuffer buffer;
    draco::Decoder decoder;
    buffer.Init(reinterpret_cast<const char *>(bytes), n_bytes);
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (decoded.ok()) {
      draco::Mesh *mesh = std::move(decoded).value().release();
      opened = {mesh, mesh->num_points(), mesh->num_faces()};
    }
  } catch (const std::exception &) { /* without memory for what a spoiled file says */
  }
  return opened;
}

static void copy_triangles(const conic_draco_mesh *opened, uint32_t (*triangles)[3]) {
  for (draco::FaceIndex i(0); i < mesh_of(opened)->num_faces(); ++i)
    for (size_t k = 0; k < 3; k++)
      triangles[i.value()][k] = mesh_of(opened)->face(i)[k].value();
}

static int copy_attribute(const conic_draco_mesh *opened, uint32_t id, int n, float *values) {
  const draco::PointAttribute *found = mesh_of(opened)->GetAttributeByUniqueId(id);
  if (!found || found->num_components() != n)
    return 0;
  try {
    draco::PointAttribute attribute;
    attribute.CopyFrom(*found);
    attribute.set_normalized(false); /* the file says that of its accessor */
    for (draco::PointIndex i(0); i < mesh_of(opened)->num_points(); ++i)
      if (!attribute.ConvertValue<float>(attribute.mapped_index(i), static_cast<int8_t>(n),
                                         values + i.value() * static_cast<size_t>(n)))
        return 0;
  } catch (const std::exception &) { /* no exception may leave for C */
    return 0;
  }
  return 1;
}

static void close_mesh(conic_draco_mesh *opened) {
  delete static_cast<draco::Mesh *>(opened->mesh);
  opened->mesh = nullptr;
}

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

extern "C" {
CONIC_API extern const conic_draco_functions conic_draco_bridge;
const conic_draco_functions conic_draco_bridge = {
    TEXT(CONIC_VERSION_MAJOR) "." TEXT(CONIC_VERSION_MINOR) "." TEXT(CONIC_VERSION_PATCH), open_mesh, copy_triangles,
    copy_attribute, close_mesh};
}
