/* Drawing on another device through OpenCL: the same pictures, bit for bit (docs/reference/opencl.md).
 *
 * A renderer that is made here is used like any other: conic_render and conic_render_samples draw on its device. */
#ifndef CONIC_OPENCL_H
#define CONIC_OPENCL_H

#include "conic/gaussian_render.h"
#include "conic/render.h"

CONIC_BEGIN_C

typedef struct conic_opencl_device {
  int i_platform, i_device; /* its name is opencl:P.D */
  char name[128], platform[128], version[128], driver[128];
  int is_cpu;
  int has_double;       /* else the host projects the splats for it, and it draws no triangles */
  int rounds_correctly; /* of division and square root; else its pictures may differ */
  int n_compute_units;
  uint64_t memory_bytes, greatest_buffer_bytes;
  uint64_t reserved[8];
} conic_opencl_device;

/* The devices of this machine, platform by platform; it is no error if there are none. On success the caller releases
 * *devices. Errors: UNSUPPORTED (this build has no OpenCL), MEMORY. */
CONIC_API conic_status conic_opencl_devices(conic_context *context, conic_opencl_device **devices, size_t *n_devices);
/* Null is allowed. */
CONIC_API void conic_opencl_devices_release(conic_context *context, conic_opencl_device *devices);

/* How the raster is shared out. Neither way changes a bit, and any device can work either way. */
typedef enum conic_opencl_work {
  CONIC_OPENCL_WORK_AUTO = 0,  /* tiles on a CPU, else pixels */
  CONIC_OPENCL_WORK_TILES = 1, /* "lanes": a tile a work-item, in vectors of 16 */
  CONIC_OPENCL_WORK_PIXELS = 2 /* "gather": a pixel a work-item */
} conic_opencl_work;

typedef struct conic_opencl_options {
  size_t size;              /* sizeof(conic_opencl_options), set by the init function */
  const char *device;       /* "opencl": the first device that will do, GPUs before others; or "opencl:P.D". An ending
                               ":gather" or ":lanes" overrides `work` */
  int allow_inexact;        /* take a device that does not round correctly, too */
  const char *cache_folder; /* where built programs are kept; null: nowhere */
  conic_opencl_work work;
  int projects_on_host; /* as for a device without double precision */
  size_t part_splats;   /* the most splats, or entries of Gaussians in tiles' lists, on the device at a time; a single
                           tile may need more. 0: as many as its memory holds */
} conic_opencl_options;

/* The first device that will do and rounds correctly, no cache, work as the device needs it, projection on the
 * device. */
CONIC_API void conic_opencl_options_init_sized(conic_opencl_options *options, size_t size);
#define conic_opencl_options_init(options) conic_opencl_options_init_sized(options, sizeof *(options))

/* A renderer that draws splats and triangles on the device. The first picture of either builds the programs that it
 * needs. On success the caller owns *renderer, which must not outlive the context, and *device (which may be null) says
 * what draws. Errors: ARGUMENT (not a name), UNSUPPORTED (no such device, it does not round correctly, this build has
 * no OpenCL), MEMORY. */
CONIC_API conic_status conic_opencl_renderer_create(conic_context *context, const conic_opencl_options *options,
                                                    conic_opencl_device *device, conic_renderer **renderer);

/* The renderer's device as conic_gaussian_options takes it, to composite Gaussians. It belongs to the renderer and,
 * like it, draws for one caller at a time. Null where the renderer draws on the processor. */
CONIC_API conic_gaussian_device *conic_opencl_gaussian_device(conic_renderer *renderer);

CONIC_END_C
#endif
