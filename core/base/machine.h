/* What the system says about the machine. */
#pragma once

#include <stdint.h>

/* How many threads run at the same time; at least 1. */
int conic_machine_threads(void);

/* Bytes of memory; 0 where it does not say. */
uint64_t conic_machine_memory(void);

/* Modules: conic's own libraries, loaded when the first file needs them. They are linked to large libraries, which
 * nobody without such files should wait for. */

enum { CONIC_MODULE_MESSAGE = 256 };

/* A module exports a struct that begins with `const char *version`: conic_version() of its build. Other builds may not
 * use it. */

/* The struct `symbol` of the module whose file is NAME, loaded by the first call. Null where it cannot be loaded; the
 * message says why. */
const void *conic_module_load(const char *name, const char *symbol, char message[CONIC_MODULE_MESSAGE]);

/* Whether there is such a module to load; the libraries it is linked to are not checked. */
int conic_module_is_there(const char *name);
