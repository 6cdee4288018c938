/* What `conic info` says of an octree. */
#ifndef CONIC_OCTREE_INFO_H
#define CONIC_OCTREE_INFO_H

#include "cli/json_write.h"
#include "conic/octree.h"

/* `broken` is null where the bounds were not checked. */
void cli_octree_print(const conic_octree_info *info, const conic_octree_defects *broken);
void cli_octree_report(cli_json *json, const conic_octree_info *info, const conic_octree_defects *broken);

#endif
