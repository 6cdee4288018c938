#if defined(__x86_64__)
#define COVER conic_cover_avx512
#define FIND_NEAR conic_find_near_avx512
#define ADD_REACH conic_add_reach_avx512
#define CHOOSE_RATIO conic_choose_ratio_avx512
#define MEASURE conic_measure_avx512
#define PUT conic_put_avx512
#include "lod/octree/octree_cover_body.h"
#include "lod/octree/octree_measure_body.h"
#include "lod/octree/octree_put_body.h"
#include "lod/octree/octree_reach_body.h"
#else
typedef int conic_not_this_machine;
#endif
