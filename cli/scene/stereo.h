/* --stereo: each frame twice, from the left and from the right eye. */
#pragma once

#include "cli/scene/render_job.h"

/* A parser of the depth at which both eyes look, into a cli_stereo. */
int cli_parse_convergence(const char *text, void *value);

/* How many pictures a frame is; begins the one of an eye, from 0. */
int cli_stereo_eyes(const cli_render_job *job);
void cli_stereo_begin(cli_render_job *job, int i_eye);

/* The eye that is drawn. */
conic_stereo_eye cli_stereo_eye(const cli_render_job *job);

/* Of a name that malloc gave and that this takes, the eye's: left or right in the place of %V, or before the ending.
 * Null without memory. */
char *cli_stereo_name(const cli_render_job *job, char *name);
