#include "opencl/opencl_renderer.h"

#include "core/base/base.h"
#include "opencl/device_name.h"
#include "opencl/frame.h"
#include "opencl/program.h"

static const char *entry_name(const conic_opencl *opencl, int entry) {
  static const char *const names[] = {"project", "lanes_project", "scan_sums",    "scan_tops", "scan_places",
                                      "compact", "count_tiles",   "place_chunks", "fill_tiles"};
  static const char *const of_tiles[] = {"lanes_passes",    "lanes_passes",        "lanes_nearest",
                                         "lanes_triangles", "lanes_add_triangles", "tiles_composite"};
  static const char *const of_pixels[] = {"gather_visibility", "gather_accumulate",    "gather_nearest",
                                          "gather_triangles",  "gather_add_triangles", "pixels_composite"};
  if (entry < CONIC_ENTRY_VISIBILITY)
    return names[entry];
  int i = entry - CONIC_ENTRY_VISIBILITY;
  return opencl->work == CONIC_OPENCL_WORK_TILES ? of_tiles[i] : of_pixels[i];
}

/* The entries first … end - 1 of a program. */
static conic_status make_entries(conic_opencl *opencl, cl_program program, int first, int end) {
  conic_status status = CONIC_OK;
  for (int i = first; i < end && status == CONIC_OK; i++) {
    cl_int answer;
    opencl->entries[i] = clCreateKernel(program, entry_name(opencl, i), &answer);
    status = conic_opencl_check(opencl->context, answer, "clCreateKernel");
  }
  return status;
}

static int tile_bits_of(const conic_opencl *opencl) {
  return opencl->work == CONIC_OPENCL_WORK_TILES ? CONIC_TILE_BITS_OF_TILES : CONIC_TILE_BITS_OF_PIXELS;
}

/* Builds a program and makes its entries first … end - 1. */
static conic_status make_program(conic_opencl *opencl, const conic_opencl_text *text, int first, int end,
                                 cl_program *program) {
  if (*program) /* from an attempt that failed */
    clReleaseProgram(*program);
  conic_status status = conic_opencl_build(opencl->context, opencl->queue.cl, opencl->id, &opencl->device,
                                           tile_bits_of(opencl), text, opencl->cache_folder, program);
  return status == CONIC_OK ? make_entries(opencl, *program, first, end) : status;
}

static conic_status keep_folder(conic_opencl *opencl, const char *folder) {
  if (!folder)
    return CONIC_OK;
  opencl->cache_folder = conic_memory_copy_text(opencl->context, folder);
  return opencl->cache_folder ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status open_device(conic_opencl *opencl, const conic_opencl_options *options) {
  conic_context *context = opencl->context;
  conic_opencl_device *device = &opencl->device;
  conic_device_name name;
  cl_platform_id platform;
  conic_status status = conic_opencl_find(context, options, &platform, &opencl->id, device);
  if (status == CONIC_OK)
    status = keep_folder(opencl, options->cache_folder);
  if (status != CONIC_OK)
    return status;
  opencl->gaussian_device.n_units = device->n_compute_units;
  opencl->projects_on_host = options->projects_on_host || !device->has_double;
  opencl->part_splats = options->part_splats;
  conic_device_name_read(options->device, &name);
  opencl->work = name.work == CONIC_OPENCL_WORK_AUTO ? options->work : name.work;
  if (opencl->work == CONIC_OPENCL_WORK_AUTO)
    opencl->work = device->is_cpu ? CONIC_OPENCL_WORK_TILES : CONIC_OPENCL_WORK_PIXELS;
  opencl->tile = 1 << tile_bits_of(opencl);
  return conic_queue_open(context, platform, opencl->id, &opencl->queue);
}

conic_status conic_opencl_need_splats(conic_opencl *opencl) {
  conic_status status = CONIC_OK;
  if (!opencl->projects_on_host && !opencl->entries[CONIC_ENTRY_SCAN_SUMS - 1])
    status = make_program(opencl, &conic_opencl_setup_text, CONIC_ENTRY_PROJECT, CONIC_ENTRY_SCAN_SUMS, &opencl->setup);
  if (status == CONIC_OK && !opencl->entries[CONIC_ENTRY_TRIANGLES - 1])
    status =
        make_program(opencl, &conic_opencl_raster_text, CONIC_ENTRY_SCAN_SUMS, CONIC_ENTRY_TRIANGLES, &opencl->raster);
  return status;
}

conic_status conic_opencl_need_triangles(conic_opencl *opencl) {
  const conic_opencl_device *device = &opencl->device;
  if (opencl->entries[CONIC_ENTRY_ADD_TRIANGLES])
    return CONIC_OK;
  if (!device->has_double)
    return conic_fail(opencl->context, CONIC_ERROR_UNSUPPORTED,
                      "opencl:%d.%d: %s has no double precision, which triangles need", device->i_platform,
                      device->i_device, device->name);
  return make_program(opencl, &conic_opencl_triangles_text, CONIC_ENTRY_TRIANGLES, CONIC_ENTRY_GAUSSIANS,
                      &opencl->triangles);
}

conic_status conic_opencl_need_gaussians(conic_opencl *opencl) {
  const conic_opencl_text *text =
      opencl->work == CONIC_OPENCL_WORK_TILES ? &conic_opencl_gaussian_tiles_text : &conic_opencl_gaussian_pixels_text;
  if (opencl->entries[CONIC_ENTRY_GAUSSIANS])
    return CONIC_OK;
  return make_program(opencl, text, CONIC_ENTRY_GAUSSIANS, CONIC_N_ENTRY_NAMES, &opencl->gaussians);
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
  (*opened)->gaussian_device.composite = conic_opencl_composite;
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
    conic_queue_release(&opencl->queue, &opencl->buffers[i]);
  for (int i = 0; i < CONIC_N_ENTRY_NAMES; i++)
    if (opencl->entries[i])
      clReleaseKernel(opencl->entries[i]);
  if (opencl->setup)
    clReleaseProgram(opencl->setup);
  if (opencl->raster)
    clReleaseProgram(opencl->raster);
  if (opencl->triangles)
    clReleaseProgram(opencl->triangles);
  if (opencl->gaussians)
    clReleaseProgram(opencl->gaussians);
  conic_queue_close(&opencl->queue);
  conic_memory_release_these(opencl->context, opencl->cache_folder, opencl);
}

conic_status conic_opencl_renderer_create(conic_context *context, const conic_opencl_options *given,
                                          conic_opencl_device *device, conic_renderer **renderer) {
  conic_opencl_options options;
  conic_opencl *opencl;
  *renderer = NULL;
  conic_opencl_options_init(&options);
  if (!conic_options_take(&options, given))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "opencl: the options were not initialised");
  conic_status status = conic_opencl_open(context, &options, &opencl);
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

conic_gaussian_device *conic_opencl_gaussian_device(conic_renderer *renderer) {
  conic_backend *backend = conic_renderer_backend(renderer);
  return backend && backend->draw == conic_frame_draw ? &((conic_opencl *)backend)->gaussian_device : NULL;
}
