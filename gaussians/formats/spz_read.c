#include "core/files/inflate.h"
#include "core/files/zstd.h"
#include "gaussians/formats/spz_layout.h"
#include "gaussians/scene/activation.h"

typedef struct spz_header {
  uint32_t version, count;
  int sh_degree, fraction_bits, flags, n_streams;
  size_t table; /* of the streams' sizes: version 4 */
  conic_spz_layout layout;
} spz_header;

static conic_status read_header(const conic_gaussian_bytes *file, const unsigned char *bytes, size_t n_bytes,
                                spz_header *header) {
  if (n_bytes < CONIC_SPZ_GZIP_HEADER || memcmp(bytes, "NGSP", 4) != 0)
    return conic_gaussian_bytes_wrong(file, 0, "not an .spz: it does not begin with NGSP");
  *header = (spz_header){.version = conic_load_32(bytes + 4),
                         .count = conic_load_32(bytes + 8),
                         .sh_degree = bytes[12],
                         .fraction_bits = bytes[13],
                         .flags = bytes[14],
                         .n_streams = bytes[15]};
  if (header->version < 1 || header->version > 4)
    return conic_gaussian_bytes_wrong(file, 4, "a version of .spz that is not known: 1 to 4 are");
  if (header->sh_degree > CONIC_MAX_SH_DEGREE)
    return conic_gaussian_bytes_wrong(file, 12, "harmonics of a degree above 4");
  if (header->fraction_bits > 24)
    return conic_gaussian_bytes_wrong(file, 13, "means of more than 24 fractional bits");
  header->layout = conic_spz_find_layout(header->version, header->sh_degree);
  return CONIC_OK;
}

/* --- unpacking --- */

static conic_status unpack_spz_stream(const conic_gaussian_bytes *file, conic_zstd *zstd, const spz_header *header,
                                      int i_stream, size_t i_of_file, size_t *at, unsigned char *to) {
  const unsigned char *entry = file->bytes + header->table + 16 * i_of_file;
  size_t n_bytes = header->layout.bytes[i_stream] * header->count;
  uint64_t n_packed = conic_load_64(entry);
  if (n_packed > file->n_bytes - *at)
    return conic_gaussian_bytes_wrong(file, header->table + 16 * i_of_file, "a stream runs past the end of the file");
  if (!conic_zstd_unpack(zstd, file->bytes + *at, (size_t)n_packed, to, n_bytes))
    return conic_gaussian_bytes_wrong(file, *at, "a stream is spoiled");
  *at += (size_t)n_packed;
  return CONIC_OK;
}

/* Version 4: a table of the streams' sizes, and the streams that are not empty. */
static conic_status unpack_streams(const conic_gaussian_bytes *file, spz_header *header, unsigned char *to) {
  conic_zstd *zstd;
  size_t at = header->table + 16 * (size_t)header->n_streams, i_of_file = 0;
  conic_status status = conic_zstd_create(file->context, &zstd);
  for (int i = 0; status == CONIC_OK && i < CONIC_SPZ_STREAMS; i++)
    if (header->layout.bytes[i]) {
      status = unpack_spz_stream(file, zstd, header, i, i_of_file++, &at, to);
      to += header->layout.bytes[i] * header->count;
    }
  conic_zstd_destroy(file->context, zstd);
  return status;
}

static conic_status check_version_4(const conic_gaussian_bytes *file, spz_header *header) {
  int n_wanted = header->sh_degree ? CONIC_SPZ_STREAMS : CONIC_SPZ_STREAMS - 1;
  if (file->n_bytes < CONIC_SPZ_HEADER)
    return conic_gaussian_bytes_wrong(file, file->n_bytes, "the file ends within the header");
  header->table = conic_load_32(file->bytes + 16);
  if (header->n_streams != n_wanted && header->count)
    return conic_gaussian_bytes_wrong(file, 15, "not as many streams as harmonics of that degree need");
  if (header->table < CONIC_SPZ_HEADER || header->table > file->n_bytes ||
      file->n_bytes - header->table < 16 * (size_t)header->n_streams)
    return conic_gaussian_bytes_wrong(file, 16, "the table of streams is not within the file");
  for (int i = 0, i_of_file = 0; i < CONIC_SPZ_STREAMS && i_of_file < header->n_streams; i++) {
    size_t at = header->table + 16 * (size_t)i_of_file + 8;
    if (header->layout.bytes[i] == 0)
      continue;
    if (conic_load_64(file->bytes + at) != (uint64_t)header->layout.bytes[i] * header->count)
      return conic_gaussian_bytes_wrong(file, at, "a stream's length is not that of so many Gaussians");
    i_of_file++;
  }
  if ((double)header->count * 9.0 > 1024.0 * (double)file->n_bytes)
    return conic_gaussian_bytes_wrong(file, 8, "more Gaussians than such a file can hold");
  return CONIC_OK;
}

/* Versions 1 to 3: header and streams, one after the other, as gzip or (nobody's habit) bare. */
static conic_status unpack_whole(const conic_gaussian_bytes *file, const spz_header *header, int is_gzip,
                                 unsigned char **block) {
  size_t n = header->layout.all_bytes * header->count + CONIC_SPZ_GZIP_HEADER;
  double most = is_gzip ? conic_inflate_most_bytes(file->n_bytes) : (double)file->n_bytes;
  if ((double)n > most)
    return conic_gaussian_bytes_wrong(file, 8, "more Gaussians than such a file can hold");
  *block = conic_memory_allocate(file->context, n, 1);
  if (!*block)
    return CONIC_ERROR_MEMORY;
  int is_whole = 1;
  if (!is_gzip)
    memcpy(*block, file->bytes, n);
  else if (conic_inflate(CONIC_DEFLATE_GZIP, file->bytes, file->n_bytes, *block, n, &is_whole) != n || !is_whole)
    return conic_gaussian_bytes_wrong(file, 0, "what is packed is spoiled, or less than so many Gaussians need");
  return CONIC_OK;
}

/* Header and all streams' bytes, side by side from *streams on, in a block that the caller releases, on failure too. */
static conic_status unpack_spz(const conic_gaussian_bytes *file, spz_header *header, unsigned char **block,
                               const unsigned char **streams) {
  int is_gzip = file->n_bytes >= 2 && memcmp(file->bytes, "\x1f\x8b", 2) == 0;
  unsigned char head[CONIC_SPZ_GZIP_HEADER];
  if (is_gzip && !conic_inflate_is_there())
    return conic_fail(file->context, CONIC_ERROR_UNSUPPORTED, "%s: it is packed by gzip: this build lacks zlib",
                      file->name);
  size_t n_head = is_gzip ? conic_inflate(CONIC_DEFLATE_GZIP, file->bytes, file->n_bytes, head, sizeof head, NULL) : 0;
  conic_status status = read_header(file, is_gzip ? head : file->bytes, is_gzip ? n_head : file->n_bytes, header);
  if (status != CONIC_OK)
    return status;
  if (header->version == 4 && is_gzip)
    return conic_gaussian_bytes_wrong(file, 0, "version 4 is not packed by gzip");
  if (header->version < 4) {
    status = unpack_whole(file, header, is_gzip, block);
    *streams = status == CONIC_OK ? *block + CONIC_SPZ_GZIP_HEADER : NULL;
    return status;
  }
  status = check_version_4(file, header);
  if (status != CONIC_OK)
    return status;
  *block = conic_memory_allocate(file->context, header->layout.all_bytes * header->count, 1);
  *streams = *block;
  return *block ? unpack_streams(file, header, *block) : CONIC_ERROR_MEMORY;
}

/* --- decoding --- */

static void decode_spz_means(const spz_header *header, const unsigned char *from, conic_gaussians *gaussians) {
  float unit = 1.0f / (float)(1 << header->fraction_bits);
  for (size_t i = 0; i < gaussians->count; i++)
    for (int axis = 0; axis < 3; axis++)
      if (header->version == 1) {
        gaussians->position[axis][i] = conic_float_of_half(conic_load_16(from));
        from += 2;
      } else {
        int32_t fixed = (int32_t)conic_load_bits(from, 3);
        gaussians->position[axis][i] = (float)(fixed - ((fixed & 0x800000) << 1)) * unit;
        from += 3;
      }
}

/* x, y, z in bytes, w from their length. */
static void decode_first_three(const unsigned char *from, conic_gaussians *gaussians, size_t i) {
  double sum = 0.0;
  for (int k = 0; k < 3; k++) {
    double value = (double)from[k] / 127.5 - 1.0;
    gaussians->rotation[1 + k][i] = (float)value;
    sum += value * value;
  }
  gaussians->rotation[0][i] = sum < 1.0 ? (float)sqrt(1.0 - sum) : 0.0f;
}

/* Of x, y, z, w all but the largest: a sign and nine bits each, from the last on. */
static void decode_smallest_three(uint32_t packed, conic_gaussians *gaussians, size_t i) {
  int largest = (int)(packed >> 30);
  double sum = 0.0;
  for (int k = 3; k >= 0; k--)
    if (k != largest) {
      double value = 0.70710678118654752 * (double)(packed & 511) / 511.0;
      gaussians->rotation[(k + 1) % 4][i] = (float)(packed & 512 ? -value : value);
      sum += value * value;
      packed >>= 10;
    }
  gaussians->rotation[(largest + 1) % 4][i] = sum < 1.0 ? (float)sqrt(1.0 - sum) : 0.0f;
}

static void decode_scales(const unsigned char *from, conic_gaussians *gaussians) {
  float logs[256], scales[256];
  for (int code = 0; code < 256; code++) {
    logs[code] = (float)code / 16.0f - 10.0f;
    scales[code] = conic_scale_of_log(logs[code]);
  }
  for (size_t i = 0; i < gaussians->count; i++)
    for (int axis = 0; axis < 3; axis++) {
      gaussians->scale[axis][i] = scales[from[3 * i + (size_t)axis]];
      if (gaussians->log_scale[axis])
        gaussians->log_scale[axis][i] = logs[from[3 * i + (size_t)axis]];
    }
}

static void decode_spz_colors(const spz_header *header, const unsigned char *colors, const unsigned char *harmonics,
                              conic_gaussians *gaussians) {
  size_t n_of_file = header->layout.bytes[5], n = conic_harmonics_of_degree(gaussians->sh_degree) - 3;
  float table[256];
  for (int code = 0; code < 256; code++)
    table[code] = (float)(((double)code / 255.0 - 0.5) / 0.15);
  for (size_t i = 0; i < gaussians->count; i++) {
    for (size_t k = 0; k < 3; k++)
      conic_gaussians_put_harmonic(gaussians, i, k, table[colors[3 * i + k]]);
    for (size_t k = 0; k < n; k++)
      conic_gaussians_put_harmonic(gaussians, i, 3 + k, (float)(harmonics[i * n_of_file + k] - 128) * 0x1p-7f);
  }
}

static void decode_spz(const spz_header *header, const unsigned char *streams, conic_gaussians *gaussians) {
  const unsigned char *at[CONIC_SPZ_STREAMS];
  for (int i = 0; i < CONIC_SPZ_STREAMS; i++) {
    at[i] = streams;
    streams += header->layout.bytes[i] * header->count;
  }
  decode_spz_means(header, at[0], gaussians);
  for (size_t i = 0; i < gaussians->count; i++) {
    gaussians->opacity[i] = (float)((double)at[1][i] / 255.0);
    if (gaussians->logit_opacity)
      gaussians->logit_opacity[i] = conic_logit_of_opacity(gaussians->opacity[i]);
    if (header->version < 3)
      decode_first_three(at[4] + 3 * i, gaussians, i);
    else
      decode_smallest_three(conic_load_32(at[4] + 4 * i), gaussians, i);
  }
  decode_scales(at[3], gaussians);
  decode_spz_colors(header, at[2], at[5], gaussians);
}

/* The extension that names the frame: a number whose bits are left or right, down or up, back or front, and whether y
 * and z are exchanged. Others are passed over. */
static void find_frame(const conic_gaussian_bytes *file, const spz_header *header, conic_gaussians *gaussians) {
  size_t end = header->table;
  memcpy(gaussians->frame, "rub", sizeof gaussians->frame);
  if (header->version < 4 || !(header->flags & CONIC_SPZ_HAS_EXTENSIONS))
    return;
  for (size_t at = CONIC_SPZ_HEADER; end - at >= 8;) {
    uint32_t type = conic_load_32(file->bytes + at), n = conic_load_32(file->bytes + at + 4);
    at += 8;
    if (n > end - at)
      return;
    uint32_t code = n == 4 && type == 0xadbe0003 ? conic_load_32(file->bytes + at) - 1 : 16;
    if (code < 16) {
      const char letters[3] = {code & 1 ? 'r' : 'l', code & 2 ? 'u' : 'd', code & 4 ? 'f' : 'b'};
      const char exchanged[3] = {letters[0], code & 4 ? 'b' : 'f', letters[1]};
      memcpy(gaussians->frame, code & 8 ? exchanged : letters, 3);
    } else
      gaussians->n_left_out++;
    at += n;
  }
}

conic_status conic_spz_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians) {
  spz_header header = {0};
  unsigned char *block = NULL;
  const unsigned char *streams = NULL;
  conic_status status = unpack_spz(file, &header, &block, &streams);
  if (status == CONIC_OK)
    status = conic_gaussians_begin(file->context, file->name, file->options, header.count, header.sh_degree,
                                   CONIC_GAUSSIANS_SOURCE, gaussians);
  if (status == CONIC_OK) {
    decode_spz(&header, streams, gaussians);
    gaussians->is_antialiased = (header.flags & CONIC_SPZ_ANTIALIASED) != 0;
    find_frame(file, &header, gaussians);
  }
  conic_memory_release(file->context, block);
  return status;
}
