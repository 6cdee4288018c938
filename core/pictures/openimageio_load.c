#include <stdio.h>

#include "core/base/machine.h"
#include "core/pictures/openimageio_bridge.h"

#if CONIC_HAVE_OPENIMAGEIO

static const char module[] = "conic-openimageio.so";

const conic_bridge *conic_bridge_load(char message[CONIC_BRIDGE_MESSAGE]) {
  return conic_module_load(module, "conic_openimageio_bridge", message);
}

int conic_bridge_is_there(void) {
  return conic_module_is_there(module);
}

#else

const conic_bridge *conic_bridge_load(char message[CONIC_BRIDGE_MESSAGE]) {
  snprintf(message, CONIC_BRIDGE_MESSAGE, "this build is without OpenImageIO");
  return NULL;
}

int conic_bridge_is_there(void) {
  return 0;
}

#endif
