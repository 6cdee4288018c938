/* .sog, version 2, as a ZIP archive: see sog_read.c. */

#include "conic/version.h"
#include "core/base/power.h"
#include "core/files/number.h"
#include "core/files/zip.h"
#include "gaussians/formats/codebook.h"
#include "gaussians/formats/gaussian_formats.h"
#include "gaussians/formats/webp_plane.h"

enum { A_ROW = 64, META_ROOM = 32768 };

typedef struct sog_writer {
  const conic_gaussian_writer *writer;
  const conic_gaussians *gaussians;
  conic_zip_writer zip;
  size_t size[2]; /* of the pictures */
  unsigned char *pixels;
  double low[3], high[3];
  float codebooks[3][CONIC_CODES]; /* of ln scales, colours, harmonics */
  uint32_t *labels;
  float *centroids;
  size_t n_centroids, n_numbers; /* of the harmonics above degree 0 */
} sog_writer;

static conic_status put_picture(sog_writer *self, const char *name, const size_t size[2]) {
  unsigned char *bytes;
  size_t n_bytes;
  conic_context *context = self->writer->context;
  conic_status status = conic_webp_encode(context, self->pixels, size, &bytes, &n_bytes);
  if (status == CONIC_OK && !conic_zip_add(&self->zip, name, bytes, n_bytes))
    status = conic_fail(context, CONIC_ERROR_IO, "%s: cannot write it, or not within 4 GiB", self->writer->path);
  conic_memory_release(context, bytes);
  return status == CONIC_OK ? conic_progress(context, "write", (double)self->zip.n_files / 8.0) : status;
}

static double scaled_log(double value) {
  double size = conic_logarithm(fabs(value) + 1.0);
  return value < 0.0 ? -size : size;
}

static uint32_t mean_code(const sog_writer *self, int axis, size_t i) {
  double mean = conic_gaussians_mean(self->gaussians, axis, i), width = self->high[axis] - self->low[axis];
  return conic_is_finite(mean) && width > 0.0 ? conic_code_of_share((scaled_log(mean) - self->low[axis]) / width, 65535)
                                              : 0;
}

static conic_status put_means(sog_writer *self) {
  conic_gaussians_bounds(self->gaussians, self->low, self->high);
  for (int axis = 0; axis < 3; axis++) {
    self->low[axis] = scaled_log(self->low[axis]);
    self->high[axis] = scaled_log(self->high[axis]);
  }
  conic_status status = CONIC_OK;
  for (int shift = 0; status == CONIC_OK && shift <= 8; shift += 8) {
    for (size_t i = 0; i < self->gaussians->count; i++) {
      for (int axis = 0; axis < 3; axis++)
        self->pixels[4 * i + (size_t)axis] = (unsigned char)(mean_code(self, axis, i) >> shift);
      self->pixels[4 * i + 3] = 255;
    }
    status = put_picture(self, shift ? "means_u.webp" : "means_l.webp", self->size);
  }
  return status;
}

static double rounded_sog(double value) {
  return ((double)conic_code_of_share(value * 0.70710678118654752 + 0.5, 255) / 255.0 * 2.0 - 1.0) *
         0.70710678118654752;
}

static conic_status put_rotations(sog_writer *self) {
  for (size_t i = 0; i < self->gaussians->count; i++) {
    unsigned char *pixel = self->pixels + 4 * i;
    double q[4];
    conic_gaussians_unit_rotation(self->gaussians, i, q);
    int left_out = conic_find_left_out(q, rounded_sog);
    for (int k = 0, to = 0; k < 4; k++)
      if (k != left_out)
        pixel[to++] = (unsigned char)conic_code_of_share(q[k] * 0.70710678118654752 + 0.5, 255);
    pixel[3] = (unsigned char)(252 + left_out);
  }
  return put_picture(self, "quats.webp", self->size);
}

static float log_scale_at(const void *numbers, size_t i) {
  const conic_gaussians *gaussians = numbers;
  int axis = (int)(i % 3);
  return gaussians->scale[axis] ? conic_gaussians_log_scale(gaussians, axis, i / 3) : -20.0f;
}

static float color_at(const void *numbers, size_t i) {
  float room[CONIC_MOST_HARMONICS];
  return conic_gaussians_harmonics(numbers, i / 3, room)[i % 3];
}

static float float_at(const void *numbers, size_t i) {
  return ((const float *)numbers)[i];
}

/* Scales and no alpha, or colours and opacity. */
static conic_status put_codes(sog_writer *self, const char *name, conic_number_at *number_at, float *codebook,
                              const float *alpha) {
  const conic_gaussians *gaussians = self->gaussians;
  conic_status status =
      conic_codebook_make(self->writer->context, gaussians, number_at, 3 * gaussians->count, codebook);
  for (size_t i = 0; status == CONIC_OK && i < gaussians->count; i++) {
    for (size_t k = 0; k < 3; k++)
      self->pixels[4 * i + k] = conic_codebook_find(codebook, number_at(gaussians, 3 * i + k));
    self->pixels[4 * i + 3] = alpha ? (unsigned char)conic_code_of_share((double)alpha[i], 255) : 255;
  }
  return status == CONIC_OK ? put_picture(self, name, self->size) : status;
}

static conic_status put_harmonics(sog_writer *self) {
  conic_context *context = self->writer->context;
  size_t n = self->gaussians->count, n_orders = self->n_numbers / 3;
  self->labels = conic_memory_allocate(context, n, sizeof *self->labels);
  conic_status status = self->labels ? conic_palette_make(context, self->gaussians, self->n_numbers, self->labels,
                                                          &self->centroids, &self->n_centroids)
                                     : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_codebook_make(context, self->centroids, float_at, self->n_centroids * self->n_numbers,
                                 self->codebooks[2]);
  const size_t size[2] = {A_ROW * n_orders, (self->n_centroids + A_ROW - 1) / A_ROW};
  for (size_t i = 0; status == CONIC_OK && i < n; i++) {
    unsigned char *pixel = self->pixels + 4 * i;
    pixel[0] = (unsigned char)self->labels[i];
    pixel[1] = (unsigned char)(self->labels[i] >> 8);
    pixel[2] = 0;
    pixel[3] = 255;
  }
  if (status == CONIC_OK)
    status = put_picture(self, "shN_labels.webp", self->size);
  if (status == CONIC_OK) {
    conic_memory_release(context, self->pixels);
    self->pixels = conic_memory_allocate_zeroed(context, size[0] * size[1], 4);
    status = self->pixels ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  for (size_t i = 0; status == CONIC_OK && i < self->n_centroids * n_orders; i++) {
    unsigned char *pixel =
        self->pixels + 4 * (i / n_orders / A_ROW * size[0] + i / n_orders % A_ROW * n_orders + i % n_orders);
    for (size_t k = 0; k < 3; k++)
      pixel[k] = conic_codebook_find(self->codebooks[2], self->centroids[3 * i + k]);
    pixel[3] = 255;
  }
  return status == CONIC_OK ? put_picture(self, "shN_centroids.webp", size) : status;
}

/* --- meta.json --- */

static size_t add_numbers(char *to, const char *key, const float *values, int n) {
  char number[CONIC_NUMBER_ROOM];
  size_t length = (size_t)sprintf(to, "\"%s\":[", key);
  for (int i = 0; i < n; i++) {
    conic_number_print_float(number, values[i]);
    length += (size_t)sprintf(to + length, "%s%s", i ? "," : "", number);
  }
  return length + (size_t)sprintf(to + length, "]");
}

static size_t add_sog_bounds(char *to, const sog_writer *self) {
  char number[CONIC_NUMBER_ROOM];
  size_t length = 0;
  for (int end = 0; end < 2; end++)
    for (int axis = 0; axis < 3; axis++) {
      conic_number_print(number, end ? self->high[axis] : self->low[axis]);
      length += (size_t)sprintf(to + length, "%s%s%s",
                                axis  ? ","
                                : end ? "\"maxs\":["
                                      : "\"mins\":[",
                                number, axis == 2 ? "]," : "");
    }
  return length;
}

static conic_status put_meta(sog_writer *self) {
  const conic_gaussians *gaussians = self->gaussians;
  char *text = conic_memory_allocate(self->writer->context, META_ROOM, 1); /* four lists of up to 256 short numbers */
  if (!text)
    return CONIC_ERROR_MEMORY;
  size_t n = (size_t)sprintf(text, "{\"version\":2,\"asset\":{\"generator\":\"conic %s\"},\"count\":%zu,%s\"means\":{",
                             conic_version(), gaussians->count,
                             !gaussians->scale[2]        ? "\"model\":\"2dgs\","
                             : gaussians->is_antialiased ? "\"model\":\"antialiased\","
                                                         : "");
  n += add_sog_bounds(text + n, self);
  n += (size_t)sprintf(text + n, "\"files\":[\"means_l.webp\",\"means_u.webp\"]},\"scales\":{");
  n += add_numbers(text + n, "codebook", self->codebooks[0], CONIC_CODES);
  n += (size_t)sprintf(text + n, ",\"files\":[\"scales.webp\"]},\"quats\":{\"files\":[\"quats.webp\"]},\"sh0\":{");
  n += add_numbers(text + n, "codebook", self->codebooks[1], CONIC_CODES);
  n += (size_t)sprintf(text + n, ",\"files\":[\"sh0.webp\"]}");
  if (self->n_numbers) {
    n += (size_t)sprintf(text + n, ",\"shN\":{\"count\":%zu,\"bands\":%d,", self->n_centroids, self->writer->sh_degree);
    n += add_numbers(text + n, "codebook", self->codebooks[2], CONIC_CODES);
    n += (size_t)sprintf(text + n, ",\"files\":[\"shN_centroids.webp\",\"shN_labels.webp\"]}");
  }
  n += (size_t)sprintf(text + n, "}\n");
  int is_done = conic_zip_add(&self->zip, "meta.json", (const unsigned char *)text, n) && conic_zip_end(&self->zip);
  conic_memory_release(self->writer->context, text);
  return is_done ? CONIC_OK
                 : conic_fail(self->writer->context, CONIC_ERROR_IO, "%s: cannot write it, or not within 4 GiB",
                              self->writer->path);
}

static conic_status write_sog(sog_writer *self) {
  conic_status status = put_means(self);
  if (status == CONIC_OK)
    status = put_rotations(self);
  if (status == CONIC_OK)
    status = put_codes(self, "scales.webp", log_scale_at, self->codebooks[0], NULL);
  if (status == CONIC_OK)
    status = put_codes(self, "sh0.webp", color_at, self->codebooks[1], self->gaussians->opacity);
  if (status == CONIC_OK && self->n_numbers)
    status = put_harmonics(self);
  return status == CONIC_OK ? put_meta(self) : status;
}

conic_status conic_sog_write(const conic_gaussian_writer *writer) {
  size_t n = writer->gaussians->count, width = 4;
  while (width * width < n)
    width += 4;
  size_t height = (n + width - 1) / width;
  if (n == 0 || width > CONIC_WEBP_MOST_PIXELS_A_SIDE)
    return conic_fail(writer->context, CONIC_ERROR_ARGUMENT, "%s: a .sog holds 1 to 268 million Gaussians, not %zu",
                      writer->path, n);
  sog_writer *self = conic_memory_allocate_zeroed(writer->context, 1, sizeof *self);
  if (!self)
    return CONIC_ERROR_MEMORY;
  self->writer = writer;
  self->gaussians = writer->gaussians;
  self->zip.to = writer->to;
  self->size[0] = width;
  self->size[1] = (height + 3) / 4 * 4;
  self->n_numbers = conic_harmonics_of_degree(writer->sh_degree) - 3;
  self->pixels = conic_memory_allocate_zeroed(writer->context, self->size[0] * self->size[1], 4);
  conic_status status = self->pixels ? write_sog(self) : CONIC_ERROR_MEMORY;
  conic_memory_release_these(writer->context, self->pixels, self->labels, self->centroids, self);
  return status;
}
