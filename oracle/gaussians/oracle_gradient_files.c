/* Weights from pictures and NumPy arrays, and gradients into .ply. */

#include "conic/version.h"
#include "core/base/byte_order.h"
#include "core/files/file.h"
#include "core/files/mapping.h"
#include "core/files/numpy_array.h"
#include "oracle/gaussians/oracle_gradient_job.h"

/* --- weights --- */

void conic_gaussian_weights_release(conic_context *context, conic_gaussian_weights *weights) {
  conic_memory_release_these(context, weights->rgb, weights->alpha, weights->z);
  memset(weights, 0, sizeof *weights);
}

static conic_status allocate_weights(conic_context *context, size_t width, size_t height, int has_rgb, int has_alpha,
                                     int has_z, conic_gaussian_weights *w) {
  const size_t n = width * height;
  conic_status status = CONIC_OK;
  w->width = (int)width;
  w->height = (int)height;
  if (has_rgb)
    status = conic_memory_allocate_these(context, CONIC_ROOM(w->rgb, 3 * n));
  if (status == CONIC_OK && has_alpha)
    status = conic_memory_allocate_these(context, CONIC_ROOM(w->alpha, n));
  if (status == CONIC_OK && has_z)
    status = conic_memory_allocate_these(context, CONIC_ROOM(w->z, n));
  return status;
}

static conic_status weights_of_image(conic_context *context, const char *path, conic_gaussian_weights *w) {
  conic_image image;
  conic_status status = conic_image_read(context, path, &image);
  if (status != CONIC_OK)
    return status;
  const float *rgba = image.planes[CONIC_PLANE_RGBA], *z = image.planes[CONIC_PLANE_Z];
  if (!rgba && !z)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: it has none of the planes R, G, B, A and Z (at byte 0)", path);
  if (status == CONIC_OK)
    status = allocate_weights(context, (size_t)image.width, (size_t)image.height, rgba != NULL,
                              rgba && !image.lacks_alpha, z != NULL, w);
  for (size_t i = 0; i < (size_t)image.width * (size_t)image.height && status == CONIC_OK; i++) {
    for (size_t c = 0; c < 3 && rgba && w->rgb; c++)
      w->rgb[3 * i + c] = (double)rgba[4 * i + c];
    if (rgba && w->alpha)
      w->alpha[i] = (double)rgba[4 * i + 3];
    if (z && w->z)
      w->z[i] = (double)z[i];
  }
  conic_image_release(context, &image);
  return status;
}

static conic_status weights_of_numbers(conic_context *context, const char *path, const conic_mapping *file,
                                       conic_gaussian_weights *w) {
  conic_numpy_array a;
  conic_status status = conic_numpy_array_open(context, path, "the array", file->bytes, file->n_bytes, &a);
  if (status != CONIC_OK)
    return status;
  const size_t n_channels = a.n_axes == 3 ? a.shape[2] : 0;
  if (n_channels < 3 || n_channels > N_WEIGHTS || a.shape[0] < 1 || a.shape[1] < 1 || a.shape[0] > 65535 ||
      a.shape[1] > 65535)
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: weights are of the shape (height, width, n), n being 3 to 5: R, G, B, A and Z (at byte 0)",
                      path);
  status = allocate_weights(context, a.shape[1], a.shape[0], 1, n_channels > 3, n_channels > 4, w);
  for (size_t i = 0; i < a.shape[0] * a.shape[1] && status == CONIC_OK; i++) {
    for (size_t c = 0; c < 3; c++)
      w->rgb[3 * i + c] = conic_numpy_array_at(&a, i * n_channels + c);
    if (w->alpha)
      w->alpha[i] = conic_numpy_array_at(&a, i * n_channels + 3);
    if (w->z)
      w->z[i] = conic_numpy_array_at(&a, i * n_channels + 4);
  }
  return status;
}

static conic_status check_finite(conic_context *context, const char *path, const conic_gaussian_weights *w) {
  const size_t n = (size_t)w->width * (size_t)w->height;
  for (size_t i = 0; i < n; i++) {
    double sum = 0.0;
    for (size_t c = 0; c < 3 && w->rgb; c++)
      sum += 0.0 * w->rgb[3 * i + c];
    sum += 0.0 * ((w->alpha ? w->alpha[i] : 0.0) + (w->z ? w->z[i] : 0.0));
    if (sum != 0.0)
      return conic_fail(context, CONIC_ERROR_INPUT, "%s: a weight of the pixel %zu,%zu is not finite (at byte 0)", path,
                        i % (size_t)w->width, i / (size_t)w->width);
  }
  return CONIC_OK;
}

conic_status conic_gaussian_weights_read(conic_context *context, const char *path, conic_gaussian_weights *weights) {
  conic_mapping file;
  memset(weights, 0, sizeof *weights);
  conic_status status;
  if (conic_file_begins_with(path, "\x93NUMPY", 6)) {
    status = conic_mapping_open(context, path, &file);
    if (status != CONIC_OK)
      return status;
    status = weights_of_numbers(context, path, &file, weights);
    conic_mapping_close(context, &file);
  } else
    status = weights_of_image(context, path, weights);
  if (status == CONIC_OK)
    status = check_finite(context, path, weights);
  if (status != CONIC_OK)
    conic_gaussian_weights_release(context, weights);
  return status;
}

/* --- gradients --- */

enum { MOST_ROW = 3 + 3 * (CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1) + 1 + 3 + 4 + 2 };

static void print_gradient_header(FILE *to, const conic_gaussian_gradient *g) {
  const int n_rest = 3 * ((g->sh_degree + 1) * (g->sh_degree + 1) - 1);
  fprintf(to,
          "ply\nformat binary_little_endian 1.0\ncomment conic %s\n"
          "comment gradient by %s\nelement vertex %zu\n"
          "property double x\nproperty double y\nproperty double z\n",
          conic_version(), g->is_raw ? "ln s and logit o" : "s and o", g->count);
  for (int k = 0; k < 3; k++)
    fprintf(to, "property double f_dc_%d\n", k);
  for (int k = 0; k < n_rest; k++)
    fprintf(to, "property double f_rest_%d\n", k);
  fprintf(to, "property double opacity\n");
  for (int k = 0; k < (g->scale[2] ? 3 : 2); k++)
    fprintf(to, "property double scale_%d\n", k);
  for (int k = 0; k < 4; k++)
    fprintf(to, "property double rot_%d\n", k);
  fprintf(to, "property double place_x\nproperty double place_y\nproperty uint doubt\nend_header\n");
}

/* A row's numbers, as its header names them. */
static size_t list_row(const conic_gaussian_gradient *g, size_t i, double row[MOST_ROW]) {
  const size_t n_sh = (size_t)(g->sh_degree + 1) * (size_t)(g->sh_degree + 1);
  const double *sh = g->sh + 3 * n_sh * i;
  size_t n = 0;
  for (int k = 0; k < 3; k++)
    row[n++] = g->mean[k][i];
  for (size_t c = 0; c < 3; c++)
    row[n++] = sh[c];
  for (size_t c = 0; c < 3; c++)
    for (size_t k = 1; k < n_sh; k++)
      row[n++] = sh[3 * k + c];
  row[n++] = g->opacity[i];
  for (int k = 0; k < 3; k++)
    if (g->scale[k])
      row[n++] = g->scale[k][i];
  for (int k = 0; k < 4; k++)
    row[n++] = g->rotation[k][i];
  for (int k = 0; k < 2; k++)
    row[n++] = g->place[k][i];
  return n;
}

conic_status conic_gaussian_gradient_write(conic_context *context, const char *path,
                                           const conic_gaussian_gradient *gradient) {
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *to = conic_output_stream(output);
  print_gradient_header(to, gradient);
  for (size_t i = 0; i < gradient->count && status == CONIC_OK; i++) {
    double row[MOST_ROW];
    unsigned char bytes[8 * MOST_ROW + 4];
    const size_t n = list_row(gradient, i, row);
    for (size_t k = 0; k < n; k++)
      conic_store_double(bytes + 8 * k, row[k]);
    conic_store_32(bytes + 8 * n, gradient->doubt[i]);
    fwrite(bytes, 8 * n + 4, 1, to);
    if (i % 65536 == 0)
      status = conic_progress(context, "write", (double)i / (double)gradient->count);
  }
  return conic_output_end(output, status);
}
