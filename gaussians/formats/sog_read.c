/* .sog: meta.json, and pictures whose pixels are the Gaussians, row by row; in a folder or a ZIP archive. Codes stand
 * for values of a table, or, in version 1, for equal steps between two. */

#include "core/base/gaussian.h"
#include "core/files/json_read.h"
#include "core/files/zip.h"
#include "gaussians/formats/gaussian_formats.h"
#include "gaussians/formats/webp_plane.h"
#include "gaussians/scene/activation.h"

enum { MEANS_LOW, MEANS_HIGH, QUATS, SCALES, SH0, CENTROIDS, LABELS, N_PLANES };
enum { MEANS, SIZES, COLORS, HARMONICS, N_PARTS };
enum { CODES = 256, MOST_NAME = 64, A_ROW = 64, MOST_LABELS = 65536, MOST_FILE = 1 << 30 };

typedef struct sog_reader {
  const conic_gaussian_bytes *file;
  conic_json json;
  conic_zip zip;
  int is_zip;
  double version, count, bands, n_labels;
  double ends[N_PARTS][2][4]; /* the least and the greatest value, by channel */
  int is_antialiased, is_2d;
  double codebooks[N_PARTS][CODES];
  char names[N_PLANES][MOST_NAME];
  unsigned char *planes[N_PLANES];
  size_t sizes[N_PLANES][2];
} sog_reader;

static conic_status sog_wrong(const sog_reader *reader, const char *what) {
  return conic_gaussian_bytes_wrong(reader->file, 0, what);
}

/* --- meta.json --- */

static conic_status read_file_names(sog_reader *reader, int first, int n) {
  int i = 0;
  conic_json_begin_array(&reader->json);
  while (conic_json_next_item(&reader->json))
    if (i < n)
      conic_json_text(&reader->json, reader->names[first + i++], MOST_NAME);
    else
      conic_json_skip(&reader->json);
  return reader->json.status;
}

/* Early writers left the first value out. */
static conic_status read_codebook(sog_reader *reader, double *codebook) {
  size_t n;
  conic_status status = conic_json_numbers(&reader->json, codebook, CODES, &n);
  if (status == CONIC_OK && n == CODES && codebook[0] != codebook[0])
    codebook[0] = codebook[1] + (codebook[1] - codebook[CODES - 1]) / 255.0;
  return status;
}

/* Of version 1, the ends of every channel; one number for all harmonics. */
static conic_status read_ends(sog_reader *reader, int part, double ends[4]) {
  size_t n;
  return part == HARMONICS ? conic_json_number(&reader->json, ends) : conic_json_numbers(&reader->json, ends, 4, &n);
}

/* One of the five objects: its first picture, how many, and its values; N_PARTS: none. */
static conic_status read_sog_part(sog_reader *reader, int first, int n, int part) {
  char key[CONIC_JSON_KEY_ROOM];
  size_t n_read;
  double shape[2] = {0.0, 0.0};
  conic_json *json = &reader->json;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key))
    if (strcmp(key, "files") == 0)
      read_file_names(reader, first, n);
    else if (strcmp(key, "codebook") == 0 && part < N_PARTS)
      read_codebook(reader, reader->codebooks[part]);
    else if (strcmp(key, "mins") == 0 && part < N_PARTS)
      read_ends(reader, part, reader->ends[part][0]);
    else if (strcmp(key, "maxs") == 0 && part < N_PARTS)
      read_ends(reader, part, reader->ends[part][1]);
    else if (strcmp(key, "shape") == 0 && part == MEANS)
      conic_json_numbers(json, shape, 2, &n_read);
    else if (strcmp(key, "count") == 0 && first == CENTROIDS)
      conic_json_number(json, &reader->n_labels);
    else if (strcmp(key, "bands") == 0 && first == CENTROIDS)
      conic_json_number(json, &reader->bands);
    else
      conic_json_skip(json);
  reader->count = shape[0] > 0.0 ? shape[0] : reader->count;
  return json->status;
}

static conic_status read_model(sog_reader *reader) {
  char model[16];
  conic_status status = conic_json_text(&reader->json, model, sizeof model);
  reader->is_antialiased |= strcmp(model, "antialiased") == 0;
  reader->is_2d = strcmp(model, "2dgs") == 0;
  return status;
}

static conic_status read_meta(sog_reader *reader) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_json *json = &reader->json;
  reader->version = 1.0; /* which does not say it */
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key))
    if (strcmp(key, "version") == 0)
      conic_json_number(json, &reader->version);
    else if (strcmp(key, "count") == 0)
      conic_json_number(json, &reader->count);
    else if (strcmp(key, "antialias") == 0)
      conic_json_truth(json, &reader->is_antialiased);
    else if (strcmp(key, "model") == 0)
      read_model(reader);
    else if (strcmp(key, "means") == 0)
      read_sog_part(reader, MEANS_LOW, 2, MEANS);
    else if (strcmp(key, "quats") == 0)
      read_sog_part(reader, QUATS, 1, N_PARTS);
    else if (strcmp(key, "scales") == 0)
      read_sog_part(reader, SCALES, 1, SIZES);
    else if (strcmp(key, "sh0") == 0)
      read_sog_part(reader, SH0, 1, COLORS);
    else if (strcmp(key, "shN") == 0)
      read_sog_part(reader, CENTROIDS, 2, HARMONICS);
    else
      conic_json_skip(json);
  if (json->status != CONIC_OK)
    return json->status;
  if (reader->version != 2.0 && reader->version != 1.0)
    return sog_wrong(reader, "a .sog of another version than 1 and 2");
  if (!(reader->count >= 1.0 && reader->count <= 268402689.0))
    return sog_wrong(reader, "meta.json tells no number of Gaussians that pictures could hold");
  if (!(reader->bands == 0.0 || reader->bands == 1.0 || reader->bands == 2.0 || reader->bands == 3.0))
    return sog_wrong(reader, "harmonics of a degree that .sog has not: 0 to 3 are");
  if (reader->version == 1.0 && reader->names[CENTROIDS][0]) {
    reader->n_labels = 1.0; /* the picture's size tells; it has a row at least */
    reader->bands = 1.0;
  }
  return reader->bands == 0.0 || (reader->n_labels >= 1.0 && reader->n_labels <= MOST_LABELS)
             ? CONIC_OK
             : sog_wrong(reader, "a number of harmonics' centroids that .sog cannot have");
}

/* --- the pictures --- */

static conic_status open_file(const sog_reader *reader, const char *name, conic_mapping *file) {
  char path[4096];
  memset(file, 0, sizeof *file);
  return reader->is_zip ? conic_zip_read(&reader->zip, name, MOST_FILE, &file->bytes, &file->n_bytes)
                        : conic_gaussian_bytes_open(reader->file, name, path, file);
}

/* No more pixels than there are Gaussians, in rows that are full but for a few. */
static conic_status read_plane(sog_reader *reader, int i_plane, double least_pixels) {
  conic_mapping file;
  size_t most = (size_t)(2.0 * least_pixels) + 4096;
  conic_status status = open_file(reader, reader->names[i_plane], &file);
  if (status == CONIC_OK && least_pixels > 1024.0 * (double)file.n_bytes)
    status = sog_wrong(reader, "more Gaussians than such a picture can hold");
  if (status == CONIC_OK)
    status = conic_webp_decode(reader->file->context, reader->file->name, file.bytes, file.n_bytes, most,
                               reader->sizes[i_plane], &reader->planes[i_plane]);
  conic_mapping_close(reader->file->context, &file);
  const size_t *size = reader->sizes[i_plane];
  if (status == CONIC_OK && (double)size[0] * (double)size[1] < least_pixels)
    status = sog_wrong(reader, "a picture has fewer pixels than there are Gaussians");
  return status;
}

/* What version 1 tells by the size of a picture alone. */
static void find_bands(sog_reader *reader) {
  const size_t *size = reader->sizes[CENTROIDS];
  reader->n_labels = (double)(A_ROW * size[1] < MOST_LABELS ? A_ROW * size[1] : MOST_LABELS);
  for (int degree = 1; degree <= 3; degree++)
    if (size[0] == (size_t)A_ROW * (size_t)(degree * (degree + 2)))
      reader->bands = degree;
}

static conic_status read_planes(sog_reader *reader) {
  conic_status status = CONIC_OK;
  double n_orders = (reader->bands + 1.0) * (reader->bands + 1.0) - 1.0;
  for (int i = 0; status == CONIC_OK && i < (reader->bands > 0.0 ? N_PLANES : CENTROIDS); i++)
    status = read_plane(reader, i, i == CENTROIDS ? ceil(reader->n_labels / A_ROW) * A_ROW * n_orders : reader->count);
  if (status == CONIC_OK && reader->bands > 0.0 && reader->version == 1.0)
    find_bands(reader);
  n_orders = (reader->bands + 1.0) * (reader->bands + 1.0) - 1.0;
  if (status == CONIC_OK && reader->bands > 0.0 && (double)reader->sizes[CENTROIDS][0] != A_ROW * n_orders)
    status = sog_wrong(reader, "the picture of harmonics is not 64 centroids wide");
  return status;
}

/* --- decoding --- */

static double mean_of_code(const sog_reader *reader, int axis, int code) {
  const double low = reader->ends[MEANS][0][axis], width = reader->ends[MEANS][1][axis] - low;
  double t = low + (width == 0.0 ? 1.0 : width) * ((double)code / 65535.0);
  double size = conic_gaussian_exp(fabs(t)) - 1.0;
  return t < 0.0 ? -size : size;
}

static conic_status decode_sog_means(const sog_reader *reader, conic_gaussians *gaussians) {
  int has_table = gaussians->count > MOST_LABELS;
  float *table = conic_memory_allocate(reader->file->context, has_table ? MOST_LABELS : 1, sizeof *table);
  if (!table)
    return CONIC_ERROR_MEMORY;
  for (int axis = 0; axis < 3; axis++) {
    for (int code = 0; has_table && code < MOST_LABELS; code++)
      table[code] = (float)mean_of_code(reader, axis, code);
    for (size_t i = 0; i < gaussians->count; i++) {
      size_t at = 4 * i + (size_t)axis;
      int code = reader->planes[MEANS_LOW][at] | reader->planes[MEANS_HIGH][at] << 8;
      gaussians->position[axis][i] = has_table ? table[code] : (float)mean_of_code(reader, axis, code);
    }
  }
  conic_memory_release(reader->file->context, table);
  return CONIC_OK;
}

/* The fourth byte says which component is left out; other values, no rotation. */
static void decode_rotation(const unsigned char *pixel, conic_gaussians *gaussians, size_t i) {
  int left_out = pixel[3] - 252;
  double sum = 0.0;
  for (int k = 0, from = 0; k < 4; k++) {
    if (k == left_out || from == 3)
      continue;
    double value = ((double)pixel[from++] / 255.0 * 2.0 - 1.0) * 0.70710678118654752;
    gaussians->rotation[k][i] = (float)value;
    sum += value * value;
  }
  if (left_out >= 0)
    gaussians->rotation[left_out][i] = sum < 1.0 ? (float)sqrt(1.0 - sum) : 0.0f;
  for (int k = 0; left_out < 0 && k < 4; k++)
    gaussians->rotation[k][i] = k == 0 ? 1.0f : 0.0f;
}

static void decode_harmonics(const sog_reader *reader, const float *values, conic_gaussians *gaussians, size_t i) {
  size_t n_of_file = ((size_t)reader->bands + 1) * ((size_t)reader->bands + 1) - 1;
  size_t n = conic_harmonics_of_degree(gaussians->sh_degree) / 3 - 1;
  size_t label = conic_load_16(reader->planes[LABELS] + 4 * i);
  int is_one = (double)label < reader->n_labels;
  size_t at = is_one ? 4 * (label / A_ROW * reader->sizes[CENTROIDS][0] + label % A_ROW * n_of_file) : 0;
  for (size_t k = 0; k < 3 * n; k++)
    conic_gaussians_put_harmonic(gaussians, i, 3 + k,
                                 is_one ? values[reader->planes[CENTROIDS][at + 4 * (k / 3) + k % 3]] : 0.0f);
}

/* What codes stand for, by channel. */
typedef struct sog_tables {
  float sizes[3][CODES], log_sizes[3][CODES], colors[4][CODES], logits[CODES], harmonics[CODES];
} sog_tables;

static double value_of_code(const sog_reader *reader, int part, int channel, int code) {
  const double low = reader->ends[part][0][channel];
  return reader->version == 2.0 ? reader->codebooks[part][code]
                                : low + (reader->ends[part][1][channel] - low) * ((double)code / 255.0);
}

static void fill_tables(const sog_reader *reader, sog_tables *tables) {
  for (int code = 0; code < CODES; code++) {
    for (int k = 0; k < 3; k++) {
      tables->log_sizes[k][code] = (float)value_of_code(reader, SIZES, k, code);
      tables->sizes[k][code] = conic_scale_of_log(tables->log_sizes[k][code]);
      tables->colors[k][code] = (float)value_of_code(reader, COLORS, k, code);
    }
    const float logit = (float)value_of_code(reader, COLORS, 3, code), share = (float)((double)code / 255.0);
    tables->logits[code] = reader->version == 2.0 ? conic_logit_of_opacity(share) : logit;
    tables->colors[3][code] = reader->version == 2.0 ? share : conic_opacity_of_logit(logit);
    tables->harmonics[code] = (float)value_of_code(reader, HARMONICS, 0, code);
  }
}

static conic_status decode_sog(const sog_reader *reader, conic_gaussians *gaussians) {
  sog_tables tables;
  fill_tables(reader, &tables);
  for (size_t i = 0; i < gaussians->count; i++) {
    const unsigned char *size = reader->planes[SCALES] + 4 * i, *color = reader->planes[SH0] + 4 * i;
    decode_rotation(reader->planes[QUATS] + 4 * i, gaussians, i);
    for (int k = 0; k < 3; k++) {
      if (gaussians->scale[k])
        gaussians->scale[k][i] = tables.sizes[k][size[k]];
      if (gaussians->log_scale[k])
        gaussians->log_scale[k][i] = tables.log_sizes[k][size[k]];
      conic_gaussians_put_harmonic(gaussians, i, (size_t)k, tables.colors[k][color[k]]);
    }
    gaussians->opacity[i] = tables.colors[3][color[3]];
    if (gaussians->logit_opacity)
      gaussians->logit_opacity[i] = tables.logits[color[3]];
    if (gaussians->sh_degree > 0)
      decode_harmonics(reader, tables.harmonics, gaussians, i);
  }
  return decode_sog_means(reader, gaussians);
}

/* --- the file --- */

static conic_status open_meta(sog_reader *reader) {
  const conic_gaussian_bytes *file = reader->file;
  unsigned char *meta;
  size_t n_meta;
  reader->is_zip = memcmp(file->bytes, "PK", 2) == 0;
  if (!reader->is_zip)
    return conic_json_take(file->context, file->name, file->bytes, file->n_bytes, &reader->json);
  conic_status status = conic_zip_open(file->context, file->name, file->bytes, file->n_bytes, &reader->zip);
  if (status == CONIC_OK)
    status = conic_zip_read(&reader->zip, "meta.json", 1 << 24, &meta, &n_meta);
  if (status != CONIC_OK)
    return status;
  status = conic_json_take(file->context, file->name, meta, n_meta, &reader->json);
  conic_memory_release(file->context, meta);
  return status;
}

static conic_status read_sog(sog_reader *reader, conic_gaussians *gaussians) {
  conic_status status = open_meta(reader);
  if (status == CONIC_OK)
    status = read_meta(reader);
  if (status == CONIC_OK)
    status = read_planes(reader);
  if (status == CONIC_OK)
    status = conic_gaussians_begin(reader->file->context, reader->file->name, reader->file->options,
                                   (uint64_t)reader->count, (int)reader->bands,
                                   CONIC_GAUSSIANS_SOURCE | (reader->is_2d ? CONIC_GAUSSIANS_2D : 0), gaussians);
  if (status != CONIC_OK)
    return status;
  gaussians->is_antialiased = reader->is_antialiased;
  return decode_sog(reader, gaussians);
}

conic_status conic_sog_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians) {
  sog_reader *reader = conic_memory_allocate_zeroed(file->context, 1, sizeof *reader);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->file = file;
  conic_status status = read_sog(reader, gaussians);
  for (int i = 0; i < N_PLANES; i++)
    conic_memory_release(file->context, reader->planes[i]);
  if (reader->json.context)
    conic_json_close(&reader->json);
  conic_memory_release(file->context, reader);
  return status;
}
