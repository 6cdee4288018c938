/* Modules: libraries of conic's own that are loaded when the first file needs them, since what they are linked to is
 * much, and whoever has no such file should not wait for it. */
#ifndef CONIC_MODULE_H
#define CONIC_MODULE_H

enum { CONIC_MODULE_MESSAGE = 256 };

/* What a module exports is a struct that begins with `const char *version`: conic_version() of the build that it
 * belongs to; no other may use it. */

/* The struct `symbol` of the module whose file is NAME, loaded by the first call that asks; null where it cannot be,
 * and the message says why. */
const void *conic_module_load(const char *name, const char *symbol, char message[CONIC_MODULE_MESSAGE]);

/* Whether there is such a module to load; what it is linked to is left alone. */
int conic_module_is_there(const char *name);

#endif
