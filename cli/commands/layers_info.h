/* What `conic info` says of a layered point cloud. */
#ifndef CONIC_LAYERS_INFO_H
#define CONIC_LAYERS_INFO_H

#include "cli/json_write.h"
#include "conic/layers.h"

/* `broken` is null where the clouds were not looked at. */
void cli_layers_print(const conic_layers_info *info, const conic_layers_defects *broken);
void cli_layers_report(cli_json *json, const conic_layers_info *info, const conic_layers_defects *broken);

/* Whether nothing is broken. */
int cli_layers_are_sound(const conic_layers_defects *broken);

#endif
