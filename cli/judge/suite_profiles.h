/* The option --profile NAME[,NAME] of what works on suites. */
#ifndef CONIC_SUITE_PROFILES_H
#define CONIC_SUITE_PROFILES_H

#include "conic/gaussian_render.h"

/* Which profiles such a list names, as bits, all where it is null; 0, after a message, where a name is none. */
unsigned cli_suite_find_profiles(const char *command, const char *list);

#endif
