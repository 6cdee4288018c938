/* Whether the options of a picture change anything, and go together: by the facts on which each has an effect. */
#pragma once

#include "cli/option_check.h"

struct cli_render_job;
struct cli_scene_words;

/* Wrong usage, or a warning, of what has no effect or does not go together: once the options are parsed and the inputs
 * are told by their first bytes, and again once the scene is open. */
int cli_effects_check(const cli_session *session, const struct cli_scene_words *words, struct cli_render_job *job);
int cli_effects_check_open(const cli_session *session, struct cli_render_job *job);
