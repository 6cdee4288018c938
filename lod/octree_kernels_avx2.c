#if defined(__x86_64__)
#define COVER conic_cover_avx2
#define FIND_INSIDE conic_find_inside_avx2
#include "lod/octree_cover_body.h"
#include "lod/octree_inside_body.h"
#else
typedef int conic_not_this_machine;
#endif
