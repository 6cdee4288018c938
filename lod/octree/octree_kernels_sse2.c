#define COVER conic_cover_baseline
#define FIND_NEAR conic_find_near_baseline
#define ADD_REACH conic_add_reach_baseline
#define CHOOSE_RATIO conic_choose_ratio_baseline
#define MEASURE conic_measure_baseline
#define PUT conic_put_baseline
#include "lod/octree/octree_cover_body.h"
#include "lod/octree/octree_measure_body.h"
#include "lod/octree/octree_put_body.h"
#include "lod/octree/octree_reach_body.h"
