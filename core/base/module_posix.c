/* Finds and loads modules. They lie in a known place beside the file that this code was linked into (the program,
 * libconic.so), so that an installation may be moved. Another program that is linked to libconic.a finds them by its
 * run path, as the dynamic linker finds a library. */
#include "core/base/machine.h"

#include <dlfcn.h>
#include <limits.h>
#if CONIC_HAVE_DLADDR1
#include <link.h>
#endif
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "conic/version.h"

/* From the folder of the program, and from that of the shared library. */
static const char *const places[] = {CONIC_MODULES_FROM_PROGRAM, "conic"};

static const char address_here;

/* The file that this code was linked into. For a program, the dynamic linker has only the word that started it, which
 * may be no path. */
static int find_own_file(char path[PATH_MAX]) {
  const char *name = NULL;
  Dl_info about;
#if CONIC_HAVE_DLADDR1
  struct link_map *map = NULL;
  if (!dladdr1(&address_here, &about, (void **)&map, RTLD_DL_LINKMAP) || !map)
    return 0;
  name = map->l_name;
#else
  if (dladdr(&address_here, &about) && about.dli_fname && strchr(about.dli_fname, '/'))
    name = about.dli_fname;
#endif
  if (name && *name)
    return snprintf(path, PATH_MAX, "%s", name) < PATH_MAX;
  ssize_t n = readlink("/proc/self/exe", path, PATH_MAX - 1);
  if (n < 1 || n >= PATH_MAX - 1)
    return 0;
  path[n] = '\0';
  return 1;
}

/* The module beside the own file; 0 where there is none. */
static int find_module(const char *name, char path[PATH_MAX]) {
  char own[PATH_MAX];
  if (!find_own_file(own))
    return 0;
  char *slash = strrchr(own, '/');
  if (!slash)
    return 0;
  *slash = '\0';
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
    if (snprintf(path, PATH_MAX, "%s/%s/%s", own, places[i], name) < PATH_MAX && access(path, R_OK) == 0)
      return 1;
  return 0;
}

/* The module stays loaded, as some libraries have threads of their own; loading it again only finds it. */
static void *open_module(const char *name) {
  char path[PATH_MAX];
  return dlopen(find_module(name, path) ? path : name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
}

const void *conic_module_load(const char *name, const char *symbol, char message[CONIC_MODULE_MESSAGE]) {
  void *module = open_module(name);
  const char *const *given = module ? dlsym(module, symbol) : NULL;
  if (!given) {
    const char *reason = dlerror();
    snprintf(message, CONIC_MODULE_MESSAGE, "%s", reason ? reason : "the module cannot be loaded");
    return NULL;
  }
  if (strcmp(*given, conic_version()) != 0) {
    snprintf(message, CONIC_MODULE_MESSAGE, "%s is that of conic %s", name, *given);
    return NULL;
  }
  return given;
}

int conic_module_is_there(const char *name) {
  char path[PATH_MAX];
  return find_module(name, path) || open_module(name) != NULL;
}
