/* .ksplat (GaussianSplats3D): a header, one of each section, and sections of rows. From level 1 on, numbers are halfs,
 * and places are 16 bits about the middle of a bucket; at level 2, harmonics are bytes. */

#include "gaussians/formats/gaussian_formats.h"

enum { HEADER_BYTES = 4096, SECTION_BYTES = 1024, MOST_DEGREE = 3 };

typedef struct ksplat_section {
  const unsigned char *lengths, *middles, *rows; /* of buckets that are not full; of all buckets; of Gaussians */
  uint64_t n_bytes, row_bytes;
  uint32_t count, range, bucket_size, n_full, n_partial, n_buckets, middle_bytes;
  double step; /* of places */
  int degree;
} ksplat_section;

typedef struct ksplat_reader {
  const conic_gaussian_bytes *file;
  size_t width, harmonic_width; /* bytes of numbers */
  double low, high;             /* of harmonics at level 2 */
} ksplat_reader;

/* The section whose header is at `header`, and whose contents begin at `at`. */
static conic_status find_section(const ksplat_reader *self, const unsigned char *header, uint64_t at,
                                 ksplat_section *s) {
  const conic_gaussian_bytes *file = self->file;
  const uint32_t most = conic_load_32(header + 4), degree = conic_load_16(header + 40);
  s->count = conic_load_32(header);
  s->bucket_size = conic_load_32(header + 8);
  s->n_buckets = conic_load_32(header + 12);
  s->middle_bytes = conic_load_16(header + 20);
  s->range = conic_load_32(header + 24) ? conic_load_32(header + 24) : 32767;
  s->n_full = conic_load_32(header + 32);
  s->n_partial = conic_load_32(header + 36);
  s->step = 0.5 * (double)conic_load_float(header + 16) / (double)s->range;
  s->degree = (int)degree;
  if (degree > MOST_DEGREE || s->count > most)
    return conic_gaussian_bytes_wrong(file, (size_t)(header - file->bytes), "a section that cannot be");
  s->row_bytes = 10 * self->width + 4 + (conic_harmonics_of_degree(s->degree) - 3) * self->harmonic_width;
  const uint64_t n_middles = 4ull * s->n_partial + (uint64_t)s->middle_bytes * s->n_buckets;
  s->n_bytes = n_middles + s->row_bytes * most;
  if (s->n_bytes > file->n_bytes - at)
    return conic_gaussian_bytes_wrong(file, (size_t)at, "the file ends within a section");
  if (self->width == 2 && s->count &&
      (s->middle_bytes < 12 || s->n_buckets == 0 || s->n_full > s->n_buckets ||
       s->n_partial > s->n_buckets - s->n_full))
    return conic_gaussian_bytes_wrong(file, (size_t)(header - file->bytes), "a section without its buckets");
  s->lengths = file->bytes + at;
  s->middles = s->lengths + 4ull * s->n_partial;
  s->rows = s->lengths + n_middles;
  return CONIC_OK;
}

static float number_of(size_t width, const unsigned char *at) {
  return width == 4 ? conic_load_float(at) : conic_float_of_half((uint16_t)conic_load_16(at));
}

/* Degree by degree, and in each a channel after the other. */
static void store_harmonics(const ksplat_reader *self, const ksplat_section *s, const unsigned char *from,
                            conic_gaussians *gaussians, size_t i) {
  const size_t width = self->harmonic_width, n = conic_harmonics_of_degree(gaussians->sh_degree);
  for (size_t degree = 1, first = 1; first * 3 < n; first += 2 * degree + 1, degree++)
    for (size_t channel = 0; channel < 3; channel++)
      for (size_t k = 0; k < 2 * degree + 1; k++) {
        const int is_there = degree <= (size_t)s->degree;
        float value = !is_there    ? 0.0f
                      : width == 1 ? (float)(self->low + (double)*from / 255.0 * (self->high - self->low))
                                   : number_of(width, from);
        from += is_there ? width : 0;
        conic_gaussians_put_harmonic(gaussians, i, 3 * (first + k) + channel, value);
      }
}

static void store_row(const ksplat_reader *self, const ksplat_section *s, const unsigned char *row,
                      const unsigned char *middle, conic_gaussians *gaussians, size_t i) {
  const size_t width = self->width;
  const unsigned char *color = row + 10 * width;
  for (size_t k = 0; k < 3; k++) {
    double code = (double)conic_load_16(row + 2 * k) - (double)s->range;
    gaussians->position[k][i] =
        width == 4 ? conic_load_float(row + 4 * k) : (float)(code * s->step + (double)conic_load_float(middle + 4 * k));
    gaussians->scale[k][i] = number_of(width, row + (3 + k) * width);
    conic_gaussians_put_harmonic(gaussians, i, k, (float)(((double)color[k] / 255.0 - 0.5) / CONIC_SH_CONSTANT));
  }
  for (size_t k = 0; k < 4; k++)
    gaussians->rotation[k][i] = number_of(width, row + (6 + k) * width);
  gaussians->opacity[i] = (float)((double)color[3] / 255.0);
  store_harmonics(self, s, color + 4, gaussians, i);
}

/* Full buckets first, and then those with as many as `lengths` says. */
static conic_status store_section(const ksplat_reader *self, const ksplat_section *s, conic_gaussians *gaussians,
                                  size_t first) {
  uint64_t bucket = 0, left = 0;
  for (size_t i = 0; i < s->count; i++) {
    for (; self->width == 2 && left == 0 && bucket <= s->n_full + (uint64_t)s->n_partial; bucket++)
      left = bucket < s->n_full                  ? s->bucket_size
             : bucket < s->n_full + s->n_partial ? conic_load_32(s->lengths + 4 * (bucket - s->n_full))
                                                 : 0;
    if (self->width == 2 && left-- == 0)
      return conic_gaussian_bytes_wrong(self->file, (size_t)(s->rows - self->file->bytes),
                                        "more Gaussians than its buckets hold");
    const unsigned char *middle = self->width == 2 ? s->middles + (bucket - 1) * s->middle_bytes : NULL;
    store_row(self, s, s->rows + i * s->row_bytes, middle, gaussians, first + i);
  }
  return CONIC_OK;
}

/* With a set, stores them; else only counts them and finds their degree. */
static conic_status read_sections(const ksplat_reader *self, conic_gaussians *gaussians, uint64_t *count, int *degree) {
  const conic_gaussian_bytes *file = self->file;
  const uint64_t n = conic_load_32(file->bytes + 4);
  uint64_t at = HEADER_BYTES + SECTION_BYTES * n;
  conic_status status =
      at <= file->n_bytes ? CONIC_OK : conic_gaussian_bytes_wrong(file, 4, "more sections than bytes");
  *count = 0;
  for (uint64_t i = 0; status == CONIC_OK && i < n; i++) {
    ksplat_section section;
    status = find_section(self, file->bytes + HEADER_BYTES + SECTION_BYTES * i, at, &section);
    if (status == CONIC_OK && gaussians)
      status = store_section(self, &section, gaussians, (size_t)*count);
    if (status != CONIC_OK)
      continue;
    *count += section.count;
    *degree = section.count && section.degree > *degree ? section.degree : *degree;
    at += section.n_bytes;
  }
  return status;
}

conic_status conic_ksplat_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians) {
  ksplat_reader self = {.file = file};
  uint64_t count;
  int degree = 0;
  if (file->n_bytes < HEADER_BYTES || file->bytes[0] != 0 || file->bytes[1] < 1)
    return conic_gaussian_bytes_wrong(file, 0, "no .ksplat of version 0.1 or later");
  const uint32_t level = conic_load_16(file->bytes + 20);
  if (level > 2)
    return conic_gaussian_bytes_wrong(file, 20, "a level of compression other than 0 to 2");
  self.width = level ? 2 : 4;
  self.harmonic_width = 4 >> level;
  self.low = (double)conic_load_float(file->bytes + 36);
  self.high = (double)conic_load_float(file->bytes + 40);
  self.low = self.low != 0.0 ? self.low : -1.5;
  self.high = self.high != 0.0 ? self.high : 1.5;
  conic_status status = read_sections(&self, NULL, &count, &degree);
  if (status == CONIC_OK)
    status = conic_gaussians_begin(file->context, file->name, file->options, count, degree, 0, gaussians);
  return status == CONIC_OK ? read_sections(&self, gaussians, &count, &degree) : status;
}
