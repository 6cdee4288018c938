/* Modules: conic's own libraries, loaded when the first file needs them. They are linked to large libraries, which
 * nobody without such files should wait for. */
#ifndef CONIC_MODULE_H
#define CONIC_MODULE_H

enum { CONIC_MODULE_MESSAGE = 256 };

/* A module exports a struct that begins with `const char *version`: conic_version() of its build. Other builds may not
 * use it. */

/* The struct `symbol` of the module whose file is NAME, loaded by the first call. Null where it cannot be loaded; the
 * message says why. */
const void *conic_module_load(const char *name, const char *symbol, char message[CONIC_MODULE_MESSAGE]);

/* Whether there is such a module to load; the libraries it is linked to are not checked. */
int conic_module_is_there(const char *name);

#endif
