/* conic prepare --bake: computes the light from all around at the points themselves. */
#pragma once

#include "cli/arguments.h"

typedef enum cli_bake { CLI_BAKE_NONE, CLI_BAKE_AO, CLI_BAKE_COLOR } cli_bake;

/* Parses --bake's value into a cli_bake. */
int cli_bake_parse(const char *text, void *value);

/* Gives splats with axes the named value "ao", and darkens their colours by it if wanted. Errors: as
 * conic_splats_occlude. */
conic_status cli_bake_splats(conic_context *context, cli_bake bake, int n_directions, float cutoff,
                             conic_splats *splats);
