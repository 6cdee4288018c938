/* The scenes of the speed–accuracy chart, and what their pictures would be of the surfaces themselves. */
#ifndef CONIC_CHART_SCENE_H
#define CONIC_CHART_SCENE_H

#include <stddef.h>

#include "conic/conic.h"

typedef struct cli_chart_scene {
  const char *name;
  conic_scene_type type; /* the plane, the sphere or the torus */
  size_t n_splats;
  double azimuth_deg, elevation_deg, zoom;
} cli_chart_scene;

#define CLI_N_CHART_SCENES 4

extern const cli_chart_scene cli_chart_scenes[CLI_N_CHART_SCENES];

/* A picture of the surface: where a pixel's centre sees it, its colour averaged by the pixel's Gaussian of 1 px² over
 * what of the surface is seen there, A = 1; else 0. is_inside[i]: the surface fills all that the Gaussian reaches. Both
 * are the camera's size; the image is allocated with rgba. Errors: as conic_image_allocate's. */
conic_status cli_chart_truth(conic_context *context, const cli_chart_scene *scene, const conic_camera *camera,
                             conic_image *truth, unsigned char *is_inside);

#endif
