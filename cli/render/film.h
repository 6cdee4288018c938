/* Frames as a film, by the program ffmpeg, which takes them through a pipe. */
#pragma once

#include "cli/scene/render_job.h"

/* Takes an output that is a film away from those that are pictures, and sees to it that one can be made. Returns
 * CLI_DONE, or, after a message, CLI_USAGE, or CLI_RESOURCE without ffmpeg. */
int cli_film_check(const cli_session *session, cli_render_job *job);
/* BITS, or BITS:QUALITY, into a cli_film. */
int cli_parse_film(const char *text, void *value);

/* Adds a frame, where there is a film. Errors: MEMORY, IO. */
conic_status cli_film_add(cli_session *session, cli_render_job *job, const conic_image *drawn);
/* Completes it, or drops it unless `status` is OK; returns that, or what went wrong. */
conic_status cli_film_end(cli_session *session, cli_render_job *job, conic_status status);
