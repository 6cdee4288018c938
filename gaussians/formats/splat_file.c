/* .splat: 32 bytes a Gaussian, after no header: three floats of mean, three of scale, four bytes of colour and opacity,
 * four of rotation. */

#include "gaussians/formats/gaussian_formats.h"

enum { ROW_BYTES = 32, BLOCK = 256 };

conic_status conic_splat_file_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians) {
  if (file->n_bytes == 0 || file->n_bytes % ROW_BYTES)
    return conic_gaussian_bytes_wrong(file, file->n_bytes, "a .splat is 32 bytes a Gaussian, and this ends within one");
  conic_status status =
      conic_gaussians_begin(file->context, file->name, file->options, file->n_bytes / ROW_BYTES, 0, 0, gaussians);
  for (size_t i = 0; status == CONIC_OK && i < gaussians->count; i++) {
    const unsigned char *row = file->bytes + i * ROW_BYTES;
    for (size_t k = 0; k < 3; k++) {
      gaussians->position[k][i] = conic_load_float(row + 4 * k);
      gaussians->scale[k][i] = conic_load_float(row + 12 + 4 * k);
      conic_gaussians_put_harmonic(gaussians, i, k, (float)(((double)row[24 + k] / 255.0 - 0.5) / CONIC_SH_CONSTANT));
    }
    gaussians->opacity[i] = (float)((double)row[27] / 255.0);
    for (int k = 0; k < 4; k++)
      gaussians->rotation[k][i] = (float)(row[28 + k] - 128) * 0x1p-7f;
  }
  return status;
}

/* Whether such a file can hold the rotation as it is. */
static int is_coded(const conic_gaussians *gaussians, size_t i) {
  for (int k = 0; k < 4; k++) {
    float code = gaussians->rotation[k][i] * 128.0f;
    if (!(code >= -128.0f && code <= 127.0f) || code != floorf(code))
      return 0;
  }
  return 1;
}

/* Both signs of a quaternion stand for the same; 1 has no code, so that of -1 is taken. */
static void put_rotation(const conic_gaussians *gaussians, size_t i, unsigned char *to) {
  double q[4], sign = 1.0;
  conic_gaussians_unit_rotation(gaussians, i, q);
  for (int k = 0; k < 4; k++)
    sign = q[k] > 127.5 / 128.0 ? -1.0 : sign;
  for (int k = 0; k < 4; k++) {
    double value = is_coded(gaussians, i) ? (double)gaussians->rotation[k][i] : sign * q[k];
    double code = floor(value * 128.0 + 128.5);
    to[k] = (unsigned char)(code < 255.0 ? code : 255.0);
  }
}

conic_status conic_splat_file_write(const conic_gaussian_writer *writer) {
  const conic_gaussians *gaussians = writer->gaussians;
  unsigned char rows[BLOCK * ROW_BYTES];
  float room[CONIC_MOST_HARMONICS];
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < gaussians->count; i++) {
    unsigned char *row = rows + i % BLOCK * ROW_BYTES;
    const float *sh = conic_gaussians_harmonics(gaussians, i, room);
    for (int k = 0; k < 3; k++) {
      conic_store_float(row + (size_t)k * 4, (float)conic_gaussians_mean(gaussians, k, i));
      conic_store_float(row + 12 + (size_t)k * 4, gaussians->scale[k] ? gaussians->scale[k][i] : 0.0f);
      row[24 + k] = (unsigned char)conic_code_of_share(0.5 + CONIC_SH_CONSTANT * (double)sh[k], 255);
    }
    row[27] = (unsigned char)conic_code_of_share((double)gaussians->opacity[i], 255);
    put_rotation(gaussians, i, row + 28);
    if (i % BLOCK != BLOCK - 1 && i + 1 < gaussians->count)
      continue;
    status = conic_gaussian_writer_put(writer, rows, (i % BLOCK + 1) * ROW_BYTES);
    if (status == CONIC_OK)
      status = conic_gaussian_writer_tell(writer, i);
  }
  return status;
}
