/* The library's version and what was built into it. */
#ifndef CONIC_VERSION_H
#define CONIC_VERSION_H

#include "conic/export.h"

CONIC_BEGIN_C

#define CONIC_VERSION_MAJOR 0
#define CONIC_VERSION_MINOR 6
#define CONIC_VERSION_PATCH 0

/* "0.6.0"; static. */
CONIC_API const char *conic_version(void);

/* A library that conic can use, and whether it does here. It does where the library was there when conic was built;
 * OpenImageIO and Assimp also need the module that leads to them. */
typedef struct conic_feature {
  const char *name; /* "OpenEXR", "OpenImageIO", "OpenCL", "zstd", "CURL", "libpng", "Assimp", "zlib", "libwebp",
                       "libxml2", "libdeflate" */
  int available;
} conic_feature;

/* The i-th feature, or null past the last; static. */
CONIC_API const conic_feature *conic_feature_at(int i);

CONIC_END_C
#endif
