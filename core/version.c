#include "conic/version.h"

#include "core/assimp/assimp_read.h"
#include "core/gltf/draco.h"
#include "core/pictures/openimageio_bridge.h"

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

const char *conic_version(void) {
  return TEXT(CONIC_VERSION_MAJOR) "." TEXT(CONIC_VERSION_MINOR) "." TEXT(CONIC_VERSION_PATCH);
}

#ifndef CONIC_HAVE_OPENEXR
#define CONIC_HAVE_OPENEXR 0
#endif
#ifndef CONIC_HAVE_PNG
#define CONIC_HAVE_PNG 0
#endif
#ifndef CONIC_HAVE_ZLIB
#define CONIC_HAVE_ZLIB 0
#endif
#ifndef CONIC_HAVE_LIBDEFLATE
#define CONIC_HAVE_LIBDEFLATE 0
#endif
#ifndef CONIC_HAVE_OPENCL
#define CONIC_HAVE_OPENCL 0
#endif
#ifndef CONIC_HAVE_ZSTD
#define CONIC_HAVE_ZSTD 0
#endif
#ifndef CONIC_HAVE_CURL
#define CONIC_HAVE_CURL 0
#endif
#ifndef CONIC_HAVE_BROTLI
#define CONIC_HAVE_BROTLI 0
#endif
#ifndef CONIC_HAVE_XML
#define CONIC_HAVE_XML 0
#endif
#ifndef CONIC_HAVE_WEBP
#define CONIC_HAVE_WEBP 0
#endif
#ifndef CONIC_HAVE_MESHOPTIMIZER
#define CONIC_HAVE_MESHOPTIMIZER 0
#endif

static const conic_feature features[] = {
    {"OpenEXR", CONIC_HAVE_OPENEXR},
    {"OpenImageIO", 1},
    {"OpenCL", CONIC_HAVE_OPENCL},
    {"zstd", CONIC_HAVE_ZSTD},
    {"CURL", CONIC_HAVE_CURL},
    {"libpng", CONIC_HAVE_PNG},
    {"Assimp", 1},
    {"zlib", CONIC_HAVE_ZLIB},
    {"libwebp", CONIC_HAVE_WEBP},
    {"Brotli", CONIC_HAVE_BROTLI},
    {"libxml2", CONIC_HAVE_XML},
    {"Draco", 1},
    {"meshoptimizer", CONIC_HAVE_MESHOPTIMIZER},
    {"libdeflate", CONIC_HAVE_LIBDEFLATE},
};
static const conic_feature without_openimageio = {"OpenImageIO", 0}, without_assimp = {"Assimp", 0};
static const conic_feature without_draco = {"Draco", 0};
enum { I_OPENIMAGEIO = 1, I_ASSIMP = 6, I_DRACO = 11 };

const conic_feature *conic_feature_at(int i) {
  if (i == I_OPENIMAGEIO && !conic_bridge_is_there())
    return &without_openimageio;
  if (i == I_ASSIMP && !conic_assimp_is_there())
    return &without_assimp;
  if (i == I_DRACO && !conic_draco_is_there())
    return &without_draco;
  return i >= 0 && (size_t)i < sizeof features / sizeof features[0] ? &features[i] : NULL;
}
