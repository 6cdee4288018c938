#include "core/files/inflate.h"
#include "core/files/zstd.h"
#include "gaussians/formats/spz_layout.h"

/* zstd's level: 12, that of the format's own library, takes ten times as long for 0.4 % less. */
enum { LEVEL = 6, MOST_FRACTION_BITS = 12 };

/* As many fractional bits, up to 12 as everybody has, as let the farthest mean fit into 24; -1: none do. */
static int find_fraction_bits(const conic_gaussians *gaussians) {
  double low[3], high[3], farthest = 0.0;
  conic_gaussians_bounds(gaussians, low, high);
  for (int axis = 0; axis < 3; axis++) {
    double reach = -low[axis] > high[axis] ? -low[axis] : high[axis];
    farthest = reach > farthest ? reach : farthest;
  }
  for (int bits = MOST_FRACTION_BITS; bits >= 0; bits--)
    if (farthest * (double)(1 << bits) + 0.5 < 8388607.0)
      return bits;
  return -1;
}

static double rounded_half_away(double value) {
  return floor(fabs(value) + 0.5) * (value < 0.0 ? -1.0 : 1.0);
}

static void encode_mean(double mean, int fraction_bits, unsigned char to[3]) {
  double scaled = rounded_half_away(mean * (double)(1 << fraction_bits));
  int32_t fixed = scaled > 8388607.0 ? 8388607 : scaled >= -8388608.0 ? (int32_t)scaled : scaled < 0.0 ? -8388608 : 0;
  for (int i = 0; i < 3; i++)
    to[i] = (unsigned char)((uint32_t)fixed >> 8 * i);
}

static unsigned char byte_of(double value) {
  double code = value > 0.0 ? floor(value + 0.5) : 0.0;
  return (unsigned char)(code < 255.0 ? code : 255.0);
}

static uint32_t encode_component(double value) {
  return (uint32_t)(conic_bits_of_double(value) >> 63) << 9 |
         conic_code_of_share(fabs(value) * 1.41421356237309505, 511);
}

static double rounded_spz(double value) {
  double magnitude = 0.70710678118654752 * (double)(encode_component(value) & 511) / 511.0;
  return value < 0.0 ? -magnitude : magnitude;
}

/* In the order x, y, z, w. */
static uint32_t encode_rotation(const conic_gaussians *gaussians, size_t i) {
  double q[4];
  conic_gaussians_unit_rotation(gaussians, i, q);
  int left_out = (conic_find_left_out(q, rounded_spz) + 3) % 4;
  uint32_t packed = (uint32_t)left_out;
  for (int k = 0; k < 4; k++)
    if (k != left_out)
      packed = packed << 10 | encode_component(q[(k + 1) % 4]);
  return packed;
}

/* To `bits` bits: to the nearest code that is a multiple of their step. */
static unsigned char encode_harmonic(float value, int bits) {
  int step = 1 << (8 - bits);
  double code = rounded_half_away((double)value * 128.0) + 128.0;
  int whole = code >= 255.0 ? 255 : code >= 0.0 ? (int)code : 0;
  whole = (whole + step / 2) / step * step;
  return (unsigned char)(whole < 255 ? whole : 255);
}

static void encode_one(const conic_gaussian_writer *writer, size_t i, int fraction_bits,
                       unsigned char *const at[CONIC_SPZ_STREAMS]) {
  const conic_gaussians *gaussians = writer->gaussians;
  size_t n_harmonics = conic_harmonics_of_degree(writer->sh_degree) - 3;
  float room[CONIC_MOST_HARMONICS];
  const float *sh = conic_gaussians_harmonics(gaussians, i, room);
  for (int axis = 0; axis < 3; axis++) {
    size_t k = 3 * i + (size_t)axis;
    double log_scale = gaussians->scale[axis] ? (double)conic_gaussians_log_scale(gaussians, axis, i) : -10.0;
    encode_mean(conic_gaussians_mean(gaussians, axis, i), fraction_bits, at[0] + 3 * k);
    at[2][k] = byte_of((double)sh[axis] * (0.15 * 255.0) + 0.5 * 255.0);
    at[3][k] = byte_of((log_scale + 10.0) * 16.0);
  }
  at[1][i] = byte_of((double)gaussians->opacity[i] * 255.0);
  conic_store_32(at[4] + 4 * i, encode_rotation(gaussians, i));
  for (size_t k = 0; k < n_harmonics; k++)
    at[5][i * n_harmonics + k] = encode_harmonic(sh[3 + k], writer->options->sh_bits[k >= 9]);
}

static conic_status put_gzip(const conic_gaussian_writer *writer, const unsigned char *block, size_t n_block) {
  unsigned char *packed;
  size_t n_packed;
  conic_status status = conic_gzip(writer->context, block, n_block, &packed, &n_packed);
  if (status == CONIC_OK)
    status = conic_gaussian_writer_put(writer, packed, n_packed);
  conic_memory_release(writer->context, packed);
  return status;
}

/* Packs every stream, and writes header, table and streams. */
static conic_status put_streams(const conic_gaussian_writer *writer, const unsigned char *head,
                                const conic_spz_layout *layout, const unsigned char *streams) {
  size_t n = writer->gaussians->count, room = 0, n_packed = 0;
  unsigned char table[16 * CONIC_SPZ_STREAMS] = {0}, header[CONIC_SPZ_HEADER] = {0}, *packed = NULL;
  int n_streams = 0;
  conic_zstd *zstd;
  conic_status status = conic_zstd_create(writer->context, &zstd);
  for (int i = 0; i < CONIC_SPZ_STREAMS; i++)
    room += conic_zstd_bound(layout->bytes[i] * n);
  if (status == CONIC_OK && !(packed = conic_memory_allocate(writer->context, room, 1)))
    status = CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    conic_zstd_set_level(zstd, LEVEL);
  for (int i = 0; status == CONIC_OK && i < CONIC_SPZ_STREAMS; i++) {
    size_t n_stream = layout->bytes[i] * n;
    if (n_stream == 0)
      continue;
    size_t n_this = conic_zstd_pack_whole(zstd, streams, n_stream, packed + n_packed);
    if (n_this == 0)
      status = CONIC_ERROR_MEMORY;
    conic_store_64(table + (size_t)n_streams * 16, n_this);
    conic_store_64(table + (size_t)n_streams * 16 + 8, n_stream);
    n_streams++;
    streams += n_stream;
    n_packed += n_this;
  }
  memcpy(header, head, CONIC_SPZ_GZIP_HEADER);
  header[15] = (unsigned char)n_streams;
  header[16] = CONIC_SPZ_HEADER;
  if (status == CONIC_OK)
    status = conic_gaussian_writer_put(writer, header, sizeof header);
  if (status == CONIC_OK)
    status = conic_gaussian_writer_put(writer, table, 16 * (size_t)n_streams);
  if (status == CONIC_OK)
    status = conic_gaussian_writer_put(writer, packed, n_packed);
  conic_memory_release(writer->context, packed);
  conic_zstd_destroy(writer->context, zstd);
  return status;
}

conic_status conic_spz_make_block(const conic_gaussian_writer *writer, unsigned char **block, size_t *n_block) {
  const conic_gaussians *gaussians = writer->gaussians;
  uint32_t version = (uint32_t)writer->options->spz_version;
  conic_spz_layout layout = conic_spz_find_layout(version, writer->sh_degree);
  int fraction_bits = find_fraction_bits(gaussians);
  *n_block = CONIC_SPZ_GZIP_HEADER + layout.all_bytes * gaussians->count;
  *block = NULL;
  if (fraction_bits < 0)
    return conic_fail(writer->context, CONIC_ERROR_INPUT, "%s: an .spz holds coordinates up to 8388607, and not these",
                      writer->path);
  unsigned char *made = *block = conic_memory_allocate(writer->context, *n_block, 1), *at[CONIC_SPZ_STREAMS];
  if (!made)
    return CONIC_ERROR_MEMORY;
  memcpy(made, "NGSP", 4);
  conic_store_32(made + 4, version);
  conic_store_32(made + 8, (uint32_t)gaussians->count);
  conic_store_32(made + 12, (uint32_t)writer->sh_degree | (uint32_t)fraction_bits << 8 |
                                (gaussians->is_antialiased ? CONIC_SPZ_ANTIALIASED << 16 : 0));
  at[0] = made + CONIC_SPZ_GZIP_HEADER;
  for (int i = 1; i < CONIC_SPZ_STREAMS; i++)
    at[i] = at[i - 1] + layout.bytes[i - 1] * gaussians->count;
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < gaussians->count; i++) {
    encode_one(writer, i, fraction_bits, at);
    status = conic_gaussian_writer_tell(writer, i);
  }
  return status;
}

conic_status conic_spz_write(const conic_gaussian_writer *writer) {
  unsigned char *block;
  size_t n_block;
  int version = writer->options->spz_version;
  conic_spz_layout layout = conic_spz_find_layout((uint32_t)version, writer->sh_degree);
  conic_status status = conic_spz_make_block(writer, &block, &n_block);
  if (status == CONIC_OK)
    status = version == 4 ? put_streams(writer, block, &layout, block + CONIC_SPZ_GZIP_HEADER)
                          : put_gzip(writer, block, n_block);
  conic_memory_release(writer->context, block);
  return status;
}
