/* conic: a software rasteriser for surface splatting. This header brings in the whole public API.
 *
 * What holds everywhere: pointers are not null unless a function says that they may be. An object made with a context
 * is used by one thread at a time, as the context is, unless its comment says otherwise. Functions that make something
 * set their result to null, or empty it, before they can fail; after a failure there is nothing to release. Functions
 * that end something (destroy, close, abandon) allow null; those that release a set leave it empty, and a set of zero
 * bytes is one already. Functions that take a set over empty it on failure too, unless they refuse its arrays. Lengths
 * are in world units unless a comment says otherwise. Colours are linear.
 *
 * Structs grow in two ways, so that a program and a library of different versions never read or write past the end of
 * each other's structs. Options, which an init function fills, begin with their size and grow at their end: members
 * that a caller's struct lacks have their defaults. It is an ARGUMENT error if no init function has set the size, or if
 * a member that this version does not know is not zero. The init functions are macros for functions that are told the
 * size; programs in other languages call these functions. All other structs keep their size: later members take the
 * place of `reserved`, and of elements of arrays from CONIC_N_… up to CONIC_MAX_…. Whoever fills such a struct leaves
 * zeros there, as initialisers do; drawing refuses other values. Structs without reserved words never change, unless
 * the library owns them. */
#ifndef CONIC_CONIC_H
#define CONIC_CONIC_H

#include "conic/accumulate.h"
#include "conic/camera.h"
#include "conic/cameras.h"
#include "conic/coloring.h"
#include "conic/context.h"
#include "conic/contributions.h"
#include "conic/csg.h"
#include "conic/diagnosis.h"
#include "conic/export.h"
#include "conic/gather.h"
#include "conic/gaussian_gradient.h"
#include "conic/gaussian_intermediates.h"
#include "conic/gaussian_judge.h"
#include "conic/gaussian_oracle.h"
#include "conic/gaussian_render.h"
#include "conic/gaussians.h"
#include "conic/hybrid.h"
#include "conic/image.h"
#include "conic/isa.h"
#include "conic/layers.h"
#include "conic/layers_draw.h"
#include "conic/lighting.h"
#include "conic/loan.h"
#include "conic/model.h"
#include "conic/motion.h"
#include "conic/octree.h"
#include "conic/opencl.h"
#include "conic/oracle.h"
#include "conic/patches.h"
#include "conic/picture.h"
#include "conic/render.h"
#include "conic/scene.h"
#include "conic/shot.h"
#include "conic/shot_file.h"
#include "conic/source.h"
#include "conic/splats.h"
#include "conic/status.h"
#include "conic/surface.h"
#include "conic/texture.h"
#include "conic/transparency.h"
#include "conic/triangles.h"
#include "conic/version.h"

#endif
