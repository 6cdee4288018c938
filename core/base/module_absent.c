/* Loading libraries when they are needed has not been tried on Windows, and WebAssembly cannot. */
#include "core/base/machine.h"

#include <stdio.h>

const void *conic_module_load(const char *name, const char *symbol, char message[CONIC_MODULE_MESSAGE]) {
  (void)symbol;
  snprintf(message, CONIC_MODULE_MESSAGE, "%s is not loaded on this system", name);
  return NULL;
}

int conic_module_is_there(const char *name) {
  (void)name;
  return 0;
}
