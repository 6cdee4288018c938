/* Programs for a device: built from the text within this library, or taken from where an earlier run has kept them. */
#pragma once

#include "opencl/opencl_device.h"

/* The text of a program, preprocessed when conic was built (cmake/opencl_program.cmake). */
typedef struct conic_opencl_text {
  const char *name;
  const char *text;
  size_t n_bytes;
} conic_opencl_text;

extern const conic_opencl_text conic_opencl_setup_text, conic_opencl_raster_text, conic_opencl_triangles_text,
    conic_opencl_gaussian_tiles_text, conic_opencl_gaussian_pixels_text;

/* Builds the text for the device, with tiles of that size. Where `cache_folder` is not null, the result is kept there,
 * under a name that is a hash of the text, the device and its driver, and taken from there next time; a cache that
 * cannot be read or written is none. On success the caller releases *program. Errors: UNSUPPORTED (the build's own
 * messages go to the log), MEMORY. */
conic_status conic_opencl_build(conic_context *context, cl_context cl, cl_device_id id,
                                const conic_opencl_device *device, int tile_bits, const conic_opencl_text *text,
                                const char *cache_folder, cl_program *program);
