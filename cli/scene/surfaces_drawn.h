/* The surfaces among Gaussians by themselves. */
#pragma once

#include "cli/scene/render_job.h"
#include "conic/gaussian_judge.h"

typedef struct cli_surfaces_drawn {
  conic_image image;
  conic_gaussian_surfaces surfaces;     /* of the image */
  const conic_gaussian_surfaces *given; /* these; null: there are none */
} cli_surfaces_drawn;

/* Draws them, a pixel each sample, with rgba, Z and, where `planes` has these, or what is made of them, N and id.
 * *drawn stays where it is until its image is released, after a failure, too. */
conic_status cli_draw_surfaces(const cli_render_job *scene, const conic_camera *camera, unsigned planes,
                               cli_surfaces_drawn *drawn);
