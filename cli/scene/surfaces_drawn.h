/* The surfaces among Gaussians by themselves. */
#pragma once

#include "cli/scene/render_job.h"

/* Draws them, a pixel each sample, with rgba, Z and, where `planes` has these, or what is made of them, N and id. An
 * empty image where there are none; the caller releases it, after a failure, too. */
conic_status cli_draw_surfaces(cli_session *session, const cli_render_job *scene, const conic_camera *camera,
                               unsigned planes, conic_image *surfaces);
