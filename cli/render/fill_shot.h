/* What of a shot the options leave open, once the scene is known: each frame's camera, lights and moment. */
#pragma once

#include "cli/scene/render_job.h"

/* What the options alone say, once they are parsed. */
void cli_shot_take_options(cli_render_job *job);

/* The job's shot becomes that of a frame, from 0. Reads a sky and a file of motion for the first one. Errors: as
 * conic_shot_frame, conic_sky_read and conic_motion_read; ARGUMENT (two eyes of a camera that has none). */
conic_status cli_shot_fill(cli_session *session, cli_render_job *job, int i_frame);

/* --exposure auto: finds it where it is still to be found, for this frame and those that follow. */
conic_status cli_choose_exposure(cli_render_job *job);
