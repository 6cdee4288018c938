#include "opencl/opencl_device.h"

#include "core/base/base.h"
#include "opencl/device_name.h"

enum { MOST_PLATFORMS = 16, MOST_DEVICES = 64 };

typedef struct found_device {
  cl_platform_id platform;
  cl_device_id id;
  int i_platform, i_device;
  cl_device_type type;
} found_device;

static const char *name_of(cl_int answer) {
  static const char *const names[] = {"CL_SUCCESS",
                                      "CL_DEVICE_NOT_FOUND",
                                      "CL_DEVICE_NOT_AVAILABLE",
                                      "CL_COMPILER_NOT_AVAILABLE",
                                      "CL_MEM_OBJECT_ALLOCATION_FAILURE",
                                      "CL_OUT_OF_RESOURCES",
                                      "CL_OUT_OF_HOST_MEMORY",
                                      "CL_PROFILING_INFO_NOT_AVAILABLE",
                                      "CL_MEM_COPY_OVERLAP",
                                      "CL_IMAGE_FORMAT_MISMATCH",
                                      "CL_IMAGE_FORMAT_NOT_SUPPORTED",
                                      "CL_BUILD_PROGRAM_FAILURE",
                                      "CL_MAP_FAILURE"};
  int n_names = (int)(sizeof names / sizeof names[0]);
  return answer <= 0 && -answer < n_names ? names[-answer] : "an error";
}

conic_status conic_opencl_check(conic_context *context, cl_int answer, const char *what) {
  if (answer == CL_SUCCESS)
    return CONIC_OK;
  int is_memory = answer == CL_MEM_OBJECT_ALLOCATION_FAILURE || answer == CL_OUT_OF_RESOURCES ||
                  answer == CL_OUT_OF_HOST_MEMORY || answer == CL_INVALID_BUFFER_SIZE;
  return conic_fail(context, is_memory ? CONIC_ERROR_MEMORY : CONIC_ERROR_UNSUPPORTED, "opencl: %s failed: %s (%d)%s",
                    what, name_of(answer), answer, is_memory ? ", which is short of memory" : "");
}

static void get_text(cl_device_id id, cl_device_info what, char *text, size_t room) {
  if (clGetDeviceInfo(id, what, room, text, NULL) != CL_SUCCESS)
    text[0] = 0;
  text[room - 1] = 0;
}

static int has_extension(cl_device_id id, const char *name) {
  char extensions[8192];
  get_text(id, CL_DEVICE_EXTENSIONS, extensions, sizeof extensions);
  return strstr(extensions, name) != NULL;
}

static void describe_device(const found_device *found, conic_opencl_device *device) {
  cl_device_id id = found->id;
  cl_device_type type = 0;
  cl_device_fp_config single = 0;
  cl_uint units = 0;
  cl_ulong memory = 0, buffer = 0;
  get_text(id, CL_DEVICE_NAME, device->name, sizeof device->name);
  get_text(id, CL_DEVICE_VERSION, device->version, sizeof device->version);
  get_text(id, CL_DRIVER_VERSION, device->driver, sizeof device->driver);
  if (clGetPlatformInfo(found->platform, CL_PLATFORM_NAME, sizeof device->platform, device->platform, NULL) !=
      CL_SUCCESS)
    device->platform[0] = 0;
  clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof type, &type, NULL);
  clGetDeviceInfo(id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof single, &single, NULL);
  clGetDeviceInfo(id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
  clGetDeviceInfo(id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof memory, &memory, NULL);
  clGetDeviceInfo(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof buffer, &buffer, NULL);
  device->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
  device->has_double = has_extension(id, "cl_khr_fp64");
  device->rounds_correctly = (single & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0 && (single & CL_FP_ROUND_TO_NEAREST);
  device->i_platform = found->i_platform;
  device->i_device = found->i_device;
  device->n_compute_units = (int)units;
  device->memory_bytes = memory;
  device->greatest_buffer_bytes = buffer;
}

/* All devices, in OpenCL's order. */
static size_t find_all(found_device found[MOST_DEVICES]) {
  cl_platform_id platforms[MOST_PLATFORMS];
  cl_uint n_platforms = 0;
  size_t n = 0;
  if (clGetPlatformIDs(MOST_PLATFORMS, platforms, &n_platforms) != CL_SUCCESS)
    return 0;
  for (cl_uint p = 0; p < n_platforms && p < MOST_PLATFORMS; p++) {
    cl_device_id ids[MOST_DEVICES];
    cl_uint n_ids = 0;
    if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, MOST_DEVICES, ids, &n_ids) != CL_SUCCESS)
      continue;
    for (cl_uint d = 0; d < n_ids && d < MOST_DEVICES && n < MOST_DEVICES; d++) {
      found[n] = (found_device){platforms[p], ids[d], (int)p, (int)d, 0};
      clGetDeviceInfo(ids[d], CL_DEVICE_TYPE, sizeof found[n].type, &found[n].type, NULL);
      n++;
    }
  }
  return n;
}

conic_status conic_opencl_devices(conic_context *context, conic_opencl_device **devices, size_t *n_devices) {
  found_device found[MOST_DEVICES];
  *n_devices = 0;
  size_t n = find_all(found);
  *devices = conic_memory_allocate_zeroed(context, n, sizeof **devices);
  if (!*devices)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    describe_device(&found[i], &(*devices)[i]);
  *n_devices = n;
  return CONIC_OK;
}

void conic_opencl_devices_release(conic_context *context, conic_opencl_device *devices) {
  conic_memory_release(context, devices);
}

CONIC_DEFINE_OPTIONS(conic_opencl_options, .device = "opencl")

/* GPUs before others, what rounds correctly before what does not. */
static const found_device *choose_device(const found_device *found, size_t n) {
  const found_device *best = NULL;
  int best_rank = -1;
  for (size_t i = 0; i < n; i++) {
    conic_opencl_device device;
    memset(&device, 0, sizeof device);
    describe_device(&found[i], &device);
    int rank = 2 * device.rounds_correctly + ((found[i].type & CL_DEVICE_TYPE_GPU) != 0);
    if (rank > best_rank) {
      best = &found[i];
      best_rank = rank;
    }
  }
  return best;
}

static conic_status refuse_device(conic_context *context, const conic_opencl_options *options,
                                  const conic_opencl_device *device) {
  if (device->rounds_correctly)
    return CONIC_OK;
  if (!options->allow_inexact)
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED,
                      "opencl:%d.%d: %s does not round division and square root correctly, so its pictures would be "
                      "others; --allow-inexact takes it nevertheless",
                      device->i_platform, device->i_device, device->name);
  conic_log(context, CONIC_LOG_WARNING,
            "opencl:%d.%d: %s may be off by 2.5 ulp in a division and 3 in a square root: colours by some 1e-5, and "
            "pixels at a splat's border may change sides",
            device->i_platform, device->i_device, device->name);
  return CONIC_OK;
}

conic_status conic_opencl_find(conic_context *context, const conic_opencl_options *options, cl_platform_id *platform,
                               cl_device_id *id, conic_opencl_device *device) {
  found_device found[MOST_DEVICES];
  const found_device *chosen = NULL;
  conic_device_name name;
  if (!conic_device_name_read(options->device, &name))
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "%s: a device is cpu, opencl or opencl:P.D, such as opencl:0.0, with :gather or :lanes behind it",
                      options->device ? options->device : "(null)");
  size_t n = find_all(found);
  if (n == 0)
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED,
                      "%s: there is no OpenCL platform with a device (a driver, such as PoCL, is a package of its own)",
                      options->device);
  if (name.i_platform < 0)
    chosen = choose_device(found, n);
  for (size_t i = 0; i < n && name.i_platform >= 0; i++)
    if (found[i].i_platform == name.i_platform && found[i].i_device == name.i_device)
      chosen = &found[i];
  if (!chosen)
    return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "%s: no such device; conic devices lists what there is",
                      options->device);
  memset(device, 0, sizeof *device);
  describe_device(chosen, device);
  *platform = chosen->platform;
  *id = chosen->id;
  return refuse_device(context, options, device);
}
