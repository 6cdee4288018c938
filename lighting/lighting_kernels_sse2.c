#if defined(__x86_64__)
#include "lighting/lighting_kernels_body.h"
#else
typedef int conic_not_this_machine;
#endif
