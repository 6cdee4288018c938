/* What stands before the text that plain C and OpenCL C share: names that OpenCL C keeps for itself are changed, and
 * what has no place on a device is left out. Only for the preprocessor (cmake/opencl_program.cmake). */
#pragma once

#define CONIC_ON_DEVICE

#pragma OPENCL FP_CONTRACT OFF

/* Words of OpenCL C: */
#define kernel reconstruction
#define constant constant_part
#define half half_part
/* and functions that it has already: */
#define rotate conic_rotate
#define dot conic_dot_of_floats

/* Where a profile's table is: core/splats/profile.h. */
#define CONIC_FAR __global

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* conic/context.h and core/splats/clip.h have pointers to functions, which OpenCL C has not. */
#define CONIC_CONTEXT_H
#include "conic/status.h"
typedef struct conic_context conic_context;
#define conic_clip_filter(...) conic_clip_filter_is_not_here(void)
