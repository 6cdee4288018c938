#include "conic/gaussian_render.h"
#include "core/base/options.h"

const char *conic_gaussian_profile_name(conic_gaussian_profile profile) {
  static const char *const names[CONIC_N_GAUSSIAN_PROFILES] = {
      "exact",      "inria-2023",    "gsplat-1.5", "gsplat-1.5-aa", "gsplat-1.6", "gsplat-1.6-aa",
      "2dgs-2024", "2dgs-gsplat", "khr-2026"};
  return (unsigned)profile < CONIC_N_GAUSSIAN_PROFILES ? names[profile] : NULL;
}

void conic_gaussian_options_init_sized(conic_gaussian_options *options, size_t size) {
  static const conic_gaussian_options own = {.size = sizeof own, .profile = CONIC_PROFILE_EXACT};
  conic_options_give(options, size, &own);
}
