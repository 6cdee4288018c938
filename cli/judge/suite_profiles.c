/* The option --profile NAME[,NAME] of commands for suites. */

#include "cli/judge/suite_scenes.h"
#include "cli/session.h"
#include "core/base/nearest_word.h"

const char *cli_suite_profile_name(int profile) {
  return profile == SUITE_SURFACE ? "surface" : conic_gaussian_profile_name((conic_gaussian_profile)profile);
}

static unsigned find_suite_profile(const char *command, const char *name) {
  const char *nearest = NULL;
  for (int i = 0; i < SUITE_PROFILES; i++) {
    const char *known = cli_suite_profile_name(i);
    if (strcmp(name, known) == 0)
      return 1u << i;
    nearest = conic_nearer_word(name, nearest, known);
  }
  cli_usage("%s: --profile %s: no profile has that name%s%s%s", command, name, nearest ? "; did you mean " : "",
            nearest ? nearest : "", nearest ? "?" : "");
  return 0;
}

unsigned cli_suite_find_profiles(const char *command, const char *list) {
  char name[64];
  unsigned found = 0;
  if (!list)
    return (1u << SUITE_PROFILES) - 1;
  for (const char *at = list; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
    snprintf(name, sizeof name, "%.*s", (int)strcspn(at, ","), at);
    unsigned one = find_suite_profile(command, name);
    if (!one)
      return 0;
    found |= one;
  }
  return found;
}
