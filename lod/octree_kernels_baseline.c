#define COVER conic_cover_baseline
#define FIND_INSIDE conic_find_inside_baseline
#include "lod/octree_cover_body.h"
#include "lod/octree_inside_body.h"
