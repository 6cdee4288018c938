/* What the charts measure, and how they write it. */
#include <math.h>

#include "bench/chart.h"
#include "core/image/image_common.h"

conic_status cli_chart_measure(conic_context *context, const conic_image *a, const conic_image *b, size_t n,
                               cli_chart_error *error) {
  conic_difference difference;
  const float *a_pixel = a->planes[CONIC_PLANE_RGBA], *b_pixel = b->planes[CONIC_PLANE_RGBA];
  size_t n_pixels = conic_image_pixels(a);
  double squares = 0.0;
  for (size_t i = 0; i < 4 * n_pixels; i++) {
    double step = i % 4 < 3 ? fabs((double)a_pixel[i] - (double)b_pixel[i]) : 0.0;
    squares += step * step;
    error->max = step > error->max ? step : error->max;
  }
  conic_status status = conic_image_compare(context, a, b, &difference);
  if (status != CONIC_OK || n == 0)
    return status;
  double share = (double)n / (double)n_pixels;
  error->is_measured = 1;
  error->rmse = sqrt(squares / (3.0 * (double)n));
  error->psnr = difference.psnr + 10.0 * log10(share);
  error->flip = difference.flip / share;
  return CONIC_OK;
}

void cli_chart_write_error(FILE *to, const cli_chart_error *error) {
  if (error->is_measured)
    fprintf(to, ",%.6g,%.6g,%.3f,%.6g", error->max, error->rmse, error->psnr, error->flip);
  else
    fputs(",,,,", to);
}

conic_status cli_chart_put(const cli_session *session, const char *folder, const char *name,
                           void (*write)(FILE *to, const void *chart), const void *chart) {
  char path[4096];
  conic_output *output;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  conic_status status = conic_output_open(session->context, path, &output);
  if (status != CONIC_OK)
    return status;
  write(conic_output_stream(output), chart);
  return conic_output_commit(output);
}

void cli_chart_write_quoted(FILE *to, const char *text) {
  fputc('"', to);
  for (; *text; text++)
    fprintf(to, *text == '"' ? "\"\"" : "%c", *text);
  fputc('"', to);
}
