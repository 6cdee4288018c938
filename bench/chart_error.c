/* What the charts measure, and how they write it. */

#include "bench/chart.h"
#include "core/image/image_common.h"

/* CIELAB of linear colours, clamped to 0 … 1; of the white point D65. */
static void find_lab(const float *rgb, double lab[3]) {
  static const double rows[3][3] = {{0.4124564 / 0.95047, 0.3575761 / 0.95047, 0.1804375 / 0.95047},
                                    {0.2126729, 0.7151522, 0.0721750},
                                    {0.0193339 / 1.08883, 0.1191920 / 1.08883, 0.9503041 / 1.08883}};
  double f[3];
  for (int i = 0; i < 3; i++) {
    double v = 0.0;
    for (int k = 0; k < 3; k++)
      v += rows[i][k] * fmin(1.0, fmax(0.0, (double)rgb[k]));
    f[i] = v > 216.0 / 24389.0 ? cbrt(v) : v * 841.0 / 108.0 + 4.0 / 29.0;
  }
  lab[0] = 116.0 * f[1] - 16.0;
  lab[1] = 500.0 * (f[0] - f[1]);
  lab[2] = 200.0 * (f[1] - f[2]);
}

static double delta_e(const float *a, const float *b) {
  double first[3], second[3], sum = 0.0;
  find_lab(a, first);
  find_lab(b, second);
  for (int i = 0; i < 3; i++)
    sum += (first[i] - second[i]) * (first[i] - second[i]);
  return sqrt(sum);
}

/* What display values stand for. */
static void decode_pixel(const float *pixel, int is_display, float linear[3]) {
  for (int i = 0; i < 3; i++) {
    double v = (double)pixel[i];
    linear[i] = (float)(!is_display ? v : v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
  }
}

static double sum_delta_e(const conic_image *a, const conic_image *b) {
  const float *a_pixel = a->planes[CONIC_PLANE_RGBA], *b_pixel = b->planes[CONIC_PLANE_RGBA];
  double sum = 0.0;
  for (size_t i = 0; i < conic_image_pixels(a); i++) {
    float first[3], second[3];
    if (memcmp(a_pixel + 4 * i, b_pixel + 4 * i, 3 * sizeof(float)) == 0)
      continue;
    decode_pixel(a_pixel + 4 * i, (int)a->is_display, first);
    decode_pixel(b_pixel + 4 * i, (int)b->is_display, second);
    sum += delta_e(first, second);
  }
  return sum;
}

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
  error->delta_e = sum_delta_e(a, b) / (double)n;
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
