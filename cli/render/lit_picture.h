/* --ao, --shadow and --sky with a picture: light that does not arrive. */
#ifndef CONIC_LIT_PICTURE_H
#define CONIC_LIT_PICTURE_H

#include "cli/scene/render_job.h"

/* The planes that lighting needs, and what the planes that are asked for need. */
void cli_light_want_planes(cli_render_job *job);

/* Wrong usage where it does not go with other options. */
int cli_light_check(const cli_render_job *job);

int cli_light_is_wanted(const cli_render_job *job);

/* Lights one of many samples by a direction of its own; its camera is not chosen for again. */
conic_status cli_light_sample(cli_session *session, cli_render_job *job, uint64_t i_sample, const conic_camera *camera,
                              conic_image *image);

/* Lights a drawn picture, if that is wanted; what the source says was chosen is the picture's again afterwards. */
conic_status cli_light_picture(cli_session *session, cli_render_job *job, const conic_camera *camera,
                               conic_image *image);

#endif
