/* Shows the loss of a Gaussian scene: compares pictures of it before and after. */
#ifndef CONIC_CONVERT_MEASURE_H
#define CONIC_CONVERT_MEASURE_H

#include "conic/gaussian_render.h"

typedef struct cli_convert_pictures {
  int n_views;     /* from all around; 0: nothing is drawn */
  double psnr;     /* of R, G and B as display values from 0 to 1, by the mean square over all views; infinite for equal
                      pictures */
  double greatest; /* the greatest difference of a value */
} cli_convert_pictures;

/* Draws both scenes, which have the same order, with the profile `exact` from n_views sides of the file at `path`,
 * which holds `after`, and compares the pictures. Errors: those of conic_source_open and conic_gaussians_render. */
conic_status cli_convert_measure(conic_context *context, const char *path, const conic_gaussians *before,
                                 const conic_gaussians *after, cli_convert_pictures *pictures);

#endif
