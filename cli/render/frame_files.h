/* What is written of a frame: the picture, with what it says of itself, and pictures of how and of what it was drawn.
 */
#pragma once

#include "cli/scene/render_job.h"

/* Says in a picture's header what it is. */
void cli_frame_describe(const cli_render_job *job, const conic_camera *camera, conic_image *image);
/* Writes a picture to all outputs. */
conic_status cli_frame_write(cli_session *session, cli_render_job *job, const conic_image *image, int i_frame);

/* Describes a finished picture, fills its mattes, which job->manifest names, draws its legend, and writes all that is
 * wanted of it. */
conic_status cli_frame_files_write(cli_session *session, cli_render_job *job, const conic_camera *camera,
                                   conic_image *image, int i_frame);

/* The file of a frame's sums, which the caller frees; null without memory. */
char *cli_sums_name(const cli_render_job *job, int i_frame);
/* Removes it, if it is there: the frame is finished. */
void cli_sums_forget(const cli_render_job *job, int i_frame);
