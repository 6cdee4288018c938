#include "opencl/renderer.h"

#include <string.h>

#include "core/memory.h"
#include "core/message.h"
#include "opencl/frame.h"
#include "opencl/program.h"

static const char *kernel_name(const conic_opencl *opencl, int kernel) {
  static const char *const names[] = {"project", "lanes_project", "scan_sums",    "scan_tops", "scan_places",
                                      "compact", "count_tiles",   "place_chunks", "fill_tiles"};
  static const char *const of_tiles[] = {"lanes_visibility", "lanes_accumulate", "lanes_nearest"};
  static const char *const of_pixels[] = {"gather_visibility", "gather_accumulate", "gather_nearest"};
  if (kernel < CONIC_KERNEL_VISIBILITY)
    return names[kernel];
  int i = kernel - CONIC_KERNEL_VISIBILITY;
  return opencl->work == CONIC_OPENCL_WORK_TILES ? of_tiles[i] : of_pixels[i];
}

static conic_status make_kernels(conic_opencl *opencl) {
  for (int i = 0; i < CONIC_N_KERNEL_NAMES; i++) {
    cl_int answer;
    cl_program program = i <= CONIC_KERNEL_PROJECT_LANES ? opencl->setup : opencl->raster;
    if (!program)
      continue;
    opencl->kernels[i] = clCreateKernel(program, kernel_name(opencl, i), &answer);
    conic_status status = conic_opencl_check(opencl->context, answer, "clCreateKernel");
    if (status != CONIC_OK)
      return status;
  }
  return CONIC_OK;
}

static conic_status open_device(conic_opencl *opencl, const conic_opencl_options *options) {
  conic_context *context = opencl->context;
  conic_opencl_device *device = &opencl->device;
  cl_platform_id platform;
  cl_device_id id;
  conic_status status = conic_opencl_find(context, options, &platform, &id, device);
  if (status != CONIC_OK)
    return status;
  opencl->projects_on_host = options->projects_on_host || !device->has_double;
  opencl->part_splats = options->part_splats;
  opencl->work = options->work;
  if (opencl->work == CONIC_OPENCL_WORK_AUTO)
    opencl->work = device->is_cpu ? CONIC_OPENCL_WORK_TILES : CONIC_OPENCL_WORK_PIXELS;
  int tile_bits = opencl->work == CONIC_OPENCL_WORK_TILES ? CONIC_TILE_BITS_OF_TILES : CONIC_TILE_BITS_OF_PIXELS;
  opencl->tile = 1 << tile_bits;
  status = conic_queue_open(context, platform, id, &opencl->queue);
  cl_context cl = opencl->queue.cl;
  const char *folder = options->cache_folder;
  if (status == CONIC_OK && !opencl->projects_on_host)
    status = conic_opencl_build(context, cl, id, device, tile_bits, &conic_opencl_setup_text, folder, &opencl->setup);
  if (status == CONIC_OK)
    status = conic_opencl_build(context, cl, id, device, tile_bits, &conic_opencl_raster_text, folder, &opencl->raster);
  return status == CONIC_OK ? make_kernels(opencl) : status;
}

static void destroy_backend(conic_backend *backend) {
  conic_opencl_close((conic_opencl *)backend);
}

conic_status conic_opencl_open(conic_context *context, const conic_opencl_options *options, conic_opencl **opened) {
  *opened = conic_memory_allocate_zeroed(context, 1, sizeof **opened);
  if (!*opened)
    return CONIC_ERROR_MEMORY;
  (*opened)->context = context;
  (*opened)->backend.draw = conic_frame_draw;
  (*opened)->backend.destroy = destroy_backend;
  conic_status status = open_device(*opened, options);
  if (status != CONIC_OK) {
    conic_opencl_close(*opened);
    *opened = NULL;
  }
  return status;
}

void conic_opencl_close(conic_opencl *opencl) {
  if (!opencl)
    return;
  for (int i = 0; i < CONIC_N_BUFFER_NAMES; i++)
    conic_queue_release(&opencl->buffers[i]);
  for (int i = 0; i < CONIC_N_KERNEL_NAMES; i++)
    if (opencl->kernels[i])
      clReleaseKernel(opencl->kernels[i]);
  if (opencl->setup)
    clReleaseProgram(opencl->setup);
  if (opencl->raster)
    clReleaseProgram(opencl->raster);
  conic_queue_close(&opencl->queue);
  conic_memory_release(opencl->context, opencl);
}

conic_status conic_opencl_renderer_create(conic_context *context, const conic_opencl_options *options,
                                          conic_opencl_device *device, conic_renderer **renderer) {
  conic_opencl *opencl;
  *renderer = NULL;
  if (!options || options->size != sizeof *options)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "opencl: the options were not initialised");
  conic_status status = conic_opencl_open(context, options, &opencl);
  if (status != CONIC_OK)
    return status;
  status = conic_renderer_create(context, renderer);
  if (status != CONIC_OK) {
    conic_opencl_close(opencl);
    return status;
  }
  conic_renderer_take(*renderer, &opencl->backend);
  if (device)
    *device = opencl->device;
  return CONIC_OK;
}
