#if defined(__x86_64__)
#include "lod/octree/octree_loops_body.h"
#else
typedef int conic_not_this_machine;
#endif
