/* Pictures that are too large to be held: they are drawn in strips (shots/strips.h), where they can be. */
#pragma once

#include "cli/scene/render_job.h"

/* Whether a picture could be, as far as the options tell. */
int cli_may_be_in_strips(const cli_session *session, const cli_render_job *job);

/* Refuses --memory that bounds nothing. */
int cli_memory_check(const cli_session *session, const cli_render_job *job);

/* Whether it is: its planes are too large to be held, and go into an EXR as they are drawn. */
int cli_is_in_strips(const cli_session *session, const cli_render_job *job, const conic_camera *camera);

/* Of a picture that is not: an error where the machine has no memory for it. */
conic_status cli_refuse_too_large(const cli_session *session, const cli_render_job *job, const conic_camera *camera);

/* Draws and writes it; a team's processes together, where windows are what they share. In the first process the
 * statistics are the picture's, and the job has its hashes where they are reported. With --resumable and --resume it is
 * kept until it is whole. Errors: as conic_strips_draw; MEMORY. */
conic_status cli_render_in_strips(cli_session *session, cli_render_job *job, int i_frame, const conic_camera *camera,
                                  conic_render_statistics *statistics);
