/* LAS files made by hand, byte by byte. */
#pragma once

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct las_file {
  unsigned char *bytes;
  size_t n_bytes, point_bytes, points_offset;
  int format;
} las_file;

static inline void las_put(las_file *file, size_t at, uint64_t value, int n_bytes) {
  for (int i = 0; i < n_bytes; i++)
    file->bytes[at + (size_t)i] = (unsigned char)(value >> 8 * i);
}

static inline void las_put_double(las_file *file, size_t at, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  las_put(file, at, bits, 8);
}

/* A file of version 1.`minor` with `n` points that are all 0, after one variable-length record; each point has
 * `extra_bytes` more than its format. */
static inline las_file las_begin(int minor, int format, size_t n, size_t extra_bytes) {
  static const size_t format_bytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  size_t header_bytes = minor == 4 ? 375 : minor == 3 ? 235 : 227;
  las_file file = {.format = format};
  file.point_bytes = format_bytes[format] + extra_bytes;
  file.points_offset = header_bytes + 54 + 10;
  file.n_bytes = file.points_offset + n * file.point_bytes;
  file.bytes = calloc(file.n_bytes, 1);
  if (!file.bytes)
    exit(1);
  memcpy(file.bytes, "LASF", 4);
  las_put(&file, 24, 1, 1);
  las_put(&file, 25, (uint64_t)minor, 1);
  las_put(&file, 94, header_bytes, 2);
  las_put(&file, 96, file.points_offset, 4);
  las_put(&file, 100, 1, 4);
  las_put(&file, 104, (uint64_t)format, 1);
  las_put(&file, 105, file.point_bytes, 2);
  if (format < 6)
    las_put(&file, 107, n, 4);
  if (minor == 4)
    las_put(&file, 247, n, 8);
  las_put(&file, header_bytes + 20, 10, 2); /* the record's length */
  for (size_t axis = 0; axis < 3; axis++)
    las_put_double(&file, 131 + 8 * axis, 1.0);
  return file;
}

static inline void las_set_scale(las_file *file, double scale, double x, double y, double z) {
  const double offsets[3] = {x, y, z};
  for (size_t axis = 0; axis < 3; axis++) {
    las_put_double(file, 131 + 8 * axis, scale);
    las_put_double(file, 155 + 8 * axis, offsets[axis]);
  }
}

static inline void las_set_point(las_file *file, size_t i, int32_t x, int32_t y, int32_t z) {
  size_t at = file->points_offset + i * file->point_bytes;
  las_put(file, at, (uint32_t)x, 4);
  las_put(file, at + 4, (uint32_t)y, 4);
  las_put(file, at + 8, (uint32_t)z, 4);
}

static inline void las_set_color(las_file *file, size_t i, unsigned red, unsigned green, unsigned blue) {
  static const size_t color_at[] = {0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
  size_t at = file->points_offset + i * file->point_bytes + color_at[file->format];
  las_put(file, at, red, 2);
  las_put(file, at + 2, green, 2);
  las_put(file, at + 4, blue, 2);
}

/* In place of the file's record one that describes two values behind those of the format: "height\nabove", an int16
 * times 0.5 less 1, and "speed", a float. The points, each with 6 bytes more, are all 0 again. Returns where the
 * descriptions begin. */
static inline size_t las_describe_extra(las_file *file, size_t n) {
  size_t header_bytes = file->points_offset - 64, at = header_bytes + 54;
  size_t points_offset = at + 2 * 192, n_bytes = points_offset + n * file->point_bytes;
  unsigned char *bytes = calloc(n_bytes, 1);
  if (!bytes)
    exit(1);
  memcpy(bytes, file->bytes, header_bytes);
  free(file->bytes);
  file->bytes = bytes;
  file->n_bytes = n_bytes;
  file->points_offset = points_offset;
  las_put(file, 96, points_offset, 4);
  memcpy(bytes + header_bytes + 2, "LASF_Spec", 9);
  las_put(file, header_bytes + 18, 4, 2);
  las_put(file, header_bytes + 20, 2 * 192, 2);
  bytes[at + 2] = 4;
  bytes[at + 3] = 8 | 16;
  memcpy(bytes + at + 4, "height\nabove", 12);
  las_put_double(file, at + 112, 0.5);
  las_put_double(file, at + 136, -1.0);
  bytes[at + 192 + 2] = 9;
  memcpy(bytes + at + 192 + 4, "speed", 5);
  return at;
}
