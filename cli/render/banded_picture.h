/* A picture that nobody holds: drawn in strips, and written row by row, to the file that it would become at once. */
#ifndef CONIC_BANDED_PICTURE_H
#define CONIC_BANDED_PICTURE_H

#include "cli/scene/render_job.h"

/* Whether it could be, as far as the options tell. */
int cli_may_be_banded(const cli_session *session, const cli_render_job *job);

/* Whether it is: its planes are too large to be held, and go into an EXR as they are drawn. */
int cli_is_banded(const cli_session *session, const cli_render_job *job, const conic_camera *camera);

/* Of a picture that is not: an error where the machine has no memory for it. */
conic_status cli_refuse_too_large(const cli_session *session, const cli_render_job *job, const conic_camera *camera);

/* Draws and writes it; a team's processes together, where windows are what they share. In the first process the
 * statistics are the picture's, and the job has its hashes where they are reported. With --resumable and --resume it is
 * kept in OUT.part and OUT.strips until it is whole. Errors: as conic_source_draw; IO, ARGUMENT; INPUT (what is kept is
 * of another picture). */
conic_status cli_render_banded(cli_session *session, cli_render_job *job, int i_frame, const conic_camera *camera,
                               conic_render_statistics *statistics);

#endif
