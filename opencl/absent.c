/* What stands in where conic is built without OpenCL. */

#include "conic/opencl.h"
#include "core/base/base.h"

static conic_status refuse(conic_context *context) {
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "opencl: this build has no OpenCL; it draws on the CPU only");
}

conic_status conic_opencl_devices(conic_context *context, conic_opencl_device **devices, size_t *n_devices) {
  *devices = NULL;
  *n_devices = 0;
  return refuse(context);
}

void conic_opencl_devices_release(conic_context *context, conic_opencl_device *devices) {
  (void)context;
  (void)devices;
}

CONIC_DEFINE_OPTIONS(conic_opencl_options, .device = "opencl")

conic_status conic_opencl_renderer_create(conic_context *context, const conic_opencl_options *options,
                                          conic_opencl_device *device, conic_renderer **renderer) {
  (void)options;
  (void)device;
  *renderer = NULL;
  return refuse(context);
}

conic_gaussian_device *conic_opencl_gaussian_device(conic_renderer *renderer) {
  (void)renderer;
  return NULL;
}
