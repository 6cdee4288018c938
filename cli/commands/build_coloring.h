/* Colours that a command makes and keeps in its output. */
#pragma once

#include "cli/color_options.h"
#include "cli/commands/build_steps.h"
#include "cli/points/points_share.h"
#include "cli/scene/scene_options.h"

typedef struct cli_coloring {
  conic_coloring_options options; /* `by` null: colours stay as they are */
  int is_up_given, keeps_up;      /* keeps_up: the output says what points up, too */
  conic_coloring done;
} cli_coloring;

/* Where what points up decides colours alone. */
#define CLI_UP_OF_COLORS "color-by=height|color-by=normal"

/* `up_with` says what --up acts with, as cli_effect has it. */
#define CLI_BUILD_COLOR_OPTIONS(coloring, up_with)                                                                     \
  CLI_COLOR_OPTIONS(&(coloring)->options), {                                                                           \
    "up", CLI_PARSED, (coloring)->options.up, "DIR",                                                                   \
        "what points up, for --color-by height and in a .lpc: x, y, z, -x … or X,Y,Z [y; z for surveys]",              \
        .parse = cli_parse_up, .is_given = &(coloring)->is_up_given, .acts.with = (up_with)                            \
  }

void cli_coloring_init(cli_coloring *coloring);

/* Returns CLI_DONE, or CLI_USAGE after a message. */
int cli_coloring_check(const cli_session *session, cli_coloring *coloring);

/* Sets what must be read for the colours. */
void cli_coloring_read(const cli_coloring *coloring, conic_read_options *reading);

/* Colours splats or triangles, either of which may be null; `up` is what their file says, or zero. Errors: as
 * conic_drawing_color. */
conic_status cli_coloring_apply(cli_build *build, cli_coloring *coloring, const double up[3], conic_splats *splats,
                                conic_triangles *triangles);

/* For inputs that are coloured batch by batch: reads them once to find the range; several processes read them twice.
 * Collective. Errors: as conic_model_stream. */
conic_status cli_coloring_find_range(cli_coloring *coloring, const cli_points_share *share,
                                     const conic_read_options *reading);
