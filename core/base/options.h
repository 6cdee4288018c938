/* Options structs across versions. Each begins with a size_t: its size where it was compiled. A later version adds
 * members at the end, none of them where there was padding, so that the smaller size says which are not there. */
#ifndef CONIC_OPTIONS_H
#define CONIC_OPTIONS_H

#include <stddef.h>

/* Sets the caller's struct of `size` bytes to the defaults `own`; members that only the caller knows to zero. */
void conic_options_give(void *theirs, size_t size, const void *own);

/* Replaces the defaults `own` by what the caller's struct says; members that it lacks stay. Returns 0, and changes
 * nothing, where it is null, its size is none (below a size_t's, no multiple of that, above 4096: not initialised), or
 * a member that only the caller knows is not zero: it asks for something that this version cannot do. */
int conic_options_take(void *own, const void *theirs);

/* Whether so many bytes are all zero, as reserved words of the other structs are. */
int conic_is_zero(const void *bytes, size_t n);

#endif
