/* Finds and loads the module with the bridge to OpenImageIO. It lies in a known place beside the file that this code
 * was linked into (the program, libconic.so), so that an installation may be moved; a program of somebody else's that
 * is linked to libconic.a finds it by its run path, as the dynamic linker finds a library. */
#include <dlfcn.h>
#include <limits.h>
#include <link.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "conic/version.h"
#include "core/image/openimageio_bridge.h"

#if CONIC_HAVE_OPENIMAGEIO

#define MODULE "conic-openimageio.so"

/* From the folder of the program, and from that of the shared library. */
static const char *const places[] = {CONIC_MODULES_FROM_PROGRAM "/" MODULE, "conic/" MODULE};

static const char address_here;

/* The file that this code was linked into. What the dynamic linker calls the program is the word that it was started
 * with, which may be no path at all. */
static int find_own_file(char path[PATH_MAX]) {
  Dl_info about;
  struct link_map *map = NULL;
  if (!dladdr1(&address_here, &about, (void **)&map, RTLD_DL_LINKMAP) || !map)
    return 0;
  if (map->l_name && *map->l_name)
    return snprintf(path, PATH_MAX, "%s", map->l_name) < PATH_MAX;
  ssize_t n = readlink("/proc/self/exe", path, PATH_MAX - 1);
  if (n < 1 || n >= PATH_MAX - 1)
    return 0;
  path[n] = '\0';
  return 1;
}

/* The module beside the own file; 0 where there is none. */
static int find_module(char path[PATH_MAX]) {
  char own[PATH_MAX];
  if (!find_own_file(own))
    return 0;
  char *slash = strrchr(own, '/');
  if (!slash)
    return 0;
  *slash = '\0';
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
    if (snprintf(path, PATH_MAX, "%s/%s", own, places[i]) < PATH_MAX && access(path, R_OK) == 0)
      return 1;
  return 0;
}

/* It stays loaded, as OpenImageIO has threads of its own; loading it again only finds it. */
static void *open_module(void) {
  char path[PATH_MAX];
  return dlopen(find_module(path) ? path : MODULE, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
}

const conic_bridge *conic_bridge_load(char message[CONIC_BRIDGE_MESSAGE]) {
  void *module = open_module();
  const conic_bridge *bridge = module ? dlsym(module, "conic_openimageio_bridge") : NULL;
  if (!bridge) {
    const char *reason = dlerror();
    snprintf(message, CONIC_BRIDGE_MESSAGE, "%s", reason ? reason : MODULE " cannot be loaded");
    return NULL;
  }
  if (strcmp(bridge->version, conic_version()) != 0) {
    snprintf(message, CONIC_BRIDGE_MESSAGE, MODULE " is that of conic %s", bridge->version);
    return NULL;
  }
  return bridge;
}

int conic_bridge_is_there(void) {
  char path[PATH_MAX];
  return find_module(path) || open_module() != NULL;
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
