#include "cli/commands/convert_measure.h"

#include <math.h>
#include <stdlib.h>

#include "conic/source.h"

enum { SIDE = 512 };

typedef struct two_pictures {
  conic_gaussian_planes planes[2];
  double squares, greatest;
} two_pictures;

static double display_value(float value) {
  return value < 0.0f ? 0.0 : value < 1.0f ? (double)value : 1.0;
}

static void add_differences(two_pictures *both) {
  for (size_t i = 0; i < 3 * (size_t)SIDE * SIDE; i++) {
    double apart = fabs(display_value(both->planes[0].rgb[i]) - display_value(both->planes[1].rgb[i]));
    both->squares += apart * apart;
    both->greatest = apart > both->greatest ? apart : both->greatest;
  }
}

static conic_status draw_views(conic_context *context, conic_source *source, const conic_gaussians *const scenes[2],
                               int n_views, two_pictures *both) {
  conic_framing framing;
  conic_status status = CONIC_OK;
  conic_framing_init(&framing);
  framing.width = framing.height = SIDE;
  for (int view = 0; view < n_views && status == CONIC_OK; view++) {
    conic_camera camera;
    framing.azimuth_deg = 30.0 + 360.0 * view / n_views;
    status = conic_source_frame(source, &framing, &camera);
    for (int i = 0; i < 2 && status == CONIC_OK; i++)
      status = conic_gaussians_render(context, scenes[i], &camera, NULL, &both->planes[i], NULL);
    if (status == CONIC_OK)
      add_differences(both);
  }
  return status;
}

conic_status cli_convert_measure(conic_context *context, const char *path, const conic_gaussians *before,
                                 const conic_gaussians *after, cli_convert_pictures *pictures) {
  const conic_gaussians *const scenes[2] = {before, after};
  const size_t n = 3 * (size_t)SIDE * SIDE;
  conic_gaussian_options exact;
  conic_source_options opening;
  conic_source *source = NULL;
  two_pictures both = {.planes = {{.width = SIDE, .height = SIDE}, {.width = SIDE, .height = SIDE}}};
  conic_gaussian_options_init(&exact);
  conic_source_options_init(&opening);
  opening.gaussians = &exact;
  both.planes[0].rgb = malloc(n * sizeof(float));
  both.planes[1].rgb = malloc(n * sizeof(float));
  conic_status status = both.planes[0].rgb && both.planes[1].rgb ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_source_open(context, &path, 1, &opening, &source);
  if (status == CONIC_OK)
    status = draw_views(context, source, scenes, pictures->n_views, &both);
  pictures->psnr = -10.0 * log10(both.squares / ((double)n * pictures->n_views));
  pictures->greatest = both.greatest;
  conic_source_close(source);
  free(both.planes[0].rgb);
  free(both.planes[1].rgb);
  return status;
}
