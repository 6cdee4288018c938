/* OpenCL's platforms and devices, and what its calls answer. */
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include "conic/opencl.h"

/* Logs that `what` failed with this answer of OpenCL's, and returns the status that stands for it: MEMORY where memory
 * was short, else UNSUPPORTED. CONIC_OK, and nothing logged, where it did not fail. */
conic_status conic_opencl_check(conic_context *context, cl_int answer, const char *what);

/* Finds the device that the options ask for. Errors: ARGUMENT, UNSUPPORTED, MEMORY. */
conic_status conic_opencl_find(conic_context *context, const conic_opencl_options *options, cl_platform_id *platform,
                               cl_device_id *id, conic_opencl_device *device);
