/* conic: a software rasteriser for surface splatting. This header brings in the whole public API. */
#ifndef CONIC_CONIC_H
#define CONIC_CONIC_H

#include "conic/camera.h"
#include "conic/context.h"
#include "conic/contributions.h"
#include "conic/export.h"
#include "conic/hybrid.h"
#include "conic/image.h"
#include "conic/layers.h"
#include "conic/layers_draw.h"
#include "conic/model.h"
#include "conic/octree.h"
#include "conic/opencl.h"
#include "conic/oracle.h"
#include "conic/patches.h"
#include "conic/render.h"
#include "conic/scene.h"
#include "conic/splats.h"
#include "conic/status.h"
#include "conic/surface.h"
#include "conic/texture.h"
#include "conic/triangles.h"
#include "conic/version.h"

#endif
