/* The speed–accuracy chart: what was measured, and drawing it. */
#pragma once

#include "cli/session.h"
#include "core/files/file.h"

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

/* How far a picture is from what it should be; of R, G, B. */
typedef struct cli_chart_error {
  int is_measured;
  double max, rmse; /* linear */
  double psnr, flip;
  double delta_e; /* the mean distance of colours in CIELAB (1976) */
} cli_chart_error;

/* One method with one kernel on one scene. */
typedef struct cli_chart_point {
  const cli_chart_scene *scene;
  conic_method method;
  conic_kernel kernel;
  double ms; /* a frame */
  size_t fragments;
  cli_chart_error oracle, truth; /* against the exact kernel, in a window; against the surface */
  double weight_max;             /* the largest error of a weight in that window */
  size_t holes, largest_hole;    /* pixels */
  int is_front[2];               /* no other of its scene is faster and nearer to the oracle, the surface */
} cli_chart_point;

/* The error of b against a where they differ at no more than `n` pixels, over so many. Errors: MEMORY. */
conic_status cli_chart_measure(conic_context *context, const conic_image *a, const conic_image *b, size_t n,
                               cli_chart_error *error);

/* Its columns: max, rmse, psnr, flip; a comma before each. */
void cli_chart_write_error(FILE *to, const cli_chart_error *error);

/* A text as a cell of a table. */
void cli_chart_write_quoted(FILE *to, const char *text);

/* Writes FOLDER/NAME by `write`. Errors: those of conic_output_open and conic_output_commit. */
conic_status cli_chart_put(const cli_session *session, const char *folder, const char *name,
                           void (*write)(FILE *to, const void *chart), const void *chart);

static inline const cli_chart_error *cli_chart_error_of(const cli_chart_point *point, int against_truth) {
  return against_truth ? &point->truth : &point->oracle;
}
