/* The names of OpenCL devices, which builds without OpenCL know too. */
#pragma once

#include "conic/opencl.h"

typedef struct conic_device_name {
  int i_platform, i_device; /* -1: the first that will do */
  conic_opencl_work work;   /* AUTO where the name does not say */
} conic_device_name;

/* Reads "opencl", with ":P.D" and ":gather" or ":lanes" behind it or not. Returns 0 where the text is no such name;
 * null is none. */
int conic_device_name_read(const char *text, conic_device_name *name);
