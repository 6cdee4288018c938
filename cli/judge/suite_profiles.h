/* The option --profile NAME[,NAME] of commands for suites. */
#ifndef CONIC_SUITE_PROFILES_H
#define CONIC_SUITE_PROFILES_H

#include "conic/gaussian_render.h"

/* The profiles of such a list, as bits; null: all. Returns 0 after a message where a name is unknown. */
unsigned cli_suite_find_profiles(const char *command, const char *list);

#endif
