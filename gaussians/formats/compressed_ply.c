/* PlayCanvas's compressed PLY: a box of each 256 Gaussians, within which numbers of 8 to 11 bits place them. */

#include "conic/version.h"
#include "core/formats/ply_source.h"
#include "gaussians/formats/gaussian_formats.h"
#include "gaussians/scene/activation.h"

enum { CHUNK = 256, N_BOUNDS = 18, MOST_REST = 45, BLOCK = 128 };

/* Least and greatest mean, ln scale and colour, three each; files of before 2024 have no colours. */
static const char *const bound_names[N_BOUNDS] = {
    "min_x",       "min_y",       "min_z",       "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y", "min_scale_z",
    "max_scale_x", "max_scale_y", "max_scale_z", "min_r", "min_g", "min_b", "max_r",       "max_g",       "max_b"};
static const char *const packed_names[4] = {"packed_position", "packed_rotation", "packed_scale", "packed_color"};

typedef float chunk_bounds[N_BOUNDS];

/* Up to BLOCK rows of up to 45 columns. */
typedef double packed_block[MOST_REST][BLOCK];

typedef struct compressed_reader {
  conic_ply_source source;
  const conic_ply_header *header;
  conic_gaussians *gaussians;
  chunk_bounds *chunks;
  size_t n_chunks;
  packed_block block;
} compressed_reader;

int conic_ply_has_compressed_gaussians(const conic_ply_header *header) {
  const conic_ply_element *chunks = conic_ply_find_element(header, "chunk");
  const conic_ply_element *vertices = conic_ply_find_element(header, "vertex");
  for (int i = 0; chunks && i < 12; i++)
    if (conic_ply_find_property(header, chunks, bound_names[i]) < 0)
      return 0;
  for (int i = 0; vertices && i < 4; i++)
    if (conic_ply_find_property(header, vertices, packed_names[i]) < 0)
      return 0;
  return chunks && vertices;
}

/* The named properties of the element that is read; -1 where there is none. */
static void find_packed_columns(const compressed_reader *reader, const char *const *names, int n, int *columns) {
  for (int i = 0; i < n; i++)
    columns[i] = conic_ply_find_property(reader->header, reader->source.element, names[i]);
}

static conic_status read_packed_rows(compressed_reader *reader, const int *columns, int n_columns, size_t *n) {
  const conic_ply_property *properties = reader->header->properties + reader->source.element->first_property;
  return conic_ply_read_rows(&reader->source, properties, columns, n_columns, BLOCK, n, (double *)reader->block);
}

static conic_status read_boxes(compressed_reader *reader) {
  int columns[N_BOUNDS];
  conic_status status = CONIC_OK;
  find_packed_columns(reader, bound_names, N_BOUNDS, columns);
  for (size_t done = 0, n; status == CONIC_OK && done < reader->n_chunks; done += n) {
    n = reader->n_chunks - done;
    status = read_packed_rows(reader, columns, N_BOUNDS, &n);
    for (size_t i = 0; status == CONIC_OK && i < n; i++)
      for (int k = 0; k < N_BOUNDS; k++)
        reader->chunks[done + i][k] = columns[k] >= 0 ? (float)reader->block[k][i] : k < 15 ? 0.0f : 1.0f;
  }
  return status;
}

static float mix_between(float low, float high, uint32_t packed, int shift, int n_bits) {
  uint32_t most = (1u << n_bits) - 1;
  double share = (double)(packed >> shift & most) / (double)most;
  return (float)((double)low * (1.0 - share) + (double)high * share);
}

static void unpack_rotation(uint32_t packed, conic_gaussians *gaussians, size_t i) {
  uint32_t largest = packed >> 30;
  double sum = 0.0;
  for (uint32_t k = 4, shift = 0; k-- > 0;)
    if (k != largest) {
      double value = ((double)(packed >> shift & 1023) / 1023.0 - 0.5) * 1.41421356237309505;
      gaussians->rotation[k][i] = (float)value;
      sum += value * value;
      shift += 10;
    }
  gaussians->rotation[largest][i] = sum < 1.0 ? (float)sqrt(1.0 - sum) : 0.0f;
}

static void unpack_gaussian(const compressed_reader *reader, size_t i, const uint32_t packed[4]) {
  static const int shifts[3] = {21, 11, 0}, bits[3] = {11, 10, 11};
  conic_gaussians *gaussians = reader->gaussians;
  const float *bounds = reader->chunks[i / CHUNK];
  for (int axis = 0; axis < 3; axis++) {
    gaussians->position[axis][i] = mix_between(bounds[axis], bounds[3 + axis], packed[0], shifts[axis], bits[axis]);
    float log_scale = mix_between(bounds[6 + axis], bounds[9 + axis], packed[2], shifts[axis], bits[axis]);
    if (gaussians->scale[axis])
      gaussians->scale[axis][i] = conic_scale_of_log(log_scale);
    if (gaussians->log_scale[axis])
      gaussians->log_scale[axis][i] = log_scale;
    double share = (double)(packed[3] >> (24 - 8 * axis) & 255) / 255.0;
    double color = (double)bounds[12 + axis] * (1.0 - share) + (double)bounds[15 + axis] * share;
    conic_gaussians_put_harmonic(gaussians, i, (size_t)axis, (float)((color - 0.5) / CONIC_SH_CONSTANT));
  }
  gaussians->opacity[i] = (float)((double)(packed[3] & 255) / 255.0);
  if (gaussians->logit_opacity)
    gaussians->logit_opacity[i] = conic_logit_of_opacity(gaussians->opacity[i]);
  unpack_rotation(packed[1], gaussians, i);
}

static conic_status read_packed(compressed_reader *reader) {
  int columns[4];
  conic_status status = CONIC_OK;
  find_packed_columns(reader, packed_names, 4, columns);
  for (size_t done = 0, n; status == CONIC_OK && done < reader->gaussians->count; done += n) {
    n = reader->gaussians->count - done;
    status = read_packed_rows(reader, columns, 4, &n);
    for (size_t i = 0; status == CONIC_OK && i < n; i++) {
      uint32_t packed[4];
      for (int k = 0; k < 4; k++)
        packed[k] = (uint32_t)reader->block[k][i];
      unpack_gaussian(reader, done + i, packed);
    }
  }
  return status;
}

/* The bytes of `element sh`, a channel after the other. A code stands for the middle of its interval, the first and the
 * last code for the interval's end. */
static conic_status read_harmonics(compressed_reader *reader, size_t n_of_file) {
  conic_gaussians *gaussians = reader->gaussians;
  size_t n_kept = conic_harmonics_of_degree(gaussians->sh_degree) / 3 - 1;
  int columns[MOST_REST];
  conic_status status = CONIC_OK;
  for (int k = 0; k < (int)n_of_file; k++) {
    char name[32];
    snprintf(name, sizeof name, "f_rest_%d", k);
    columns[k] = conic_ply_find_property(reader->header, reader->source.element, name);
  }
  for (size_t done = 0, n; status == CONIC_OK && done < gaussians->count; done += n) {
    n = gaussians->count - done;
    status = read_packed_rows(reader, columns, (int)n_of_file, &n);
    for (size_t i = 0; status == CONIC_OK && i < n; i++)
      for (size_t k = 0; k < 3 * n_kept; k++) {
        double code = reader->block[k % 3 * (n_of_file / 3) + k / 3][i];
        double share = code <= 0.0 ? 0.0 : code >= 255.0 ? 1.0 : (code + 0.5) / 256.0;
        conic_gaussians_put_harmonic(gaussians, done + i, 3 + k, (float)((share - 0.5) * 8.0));
      }
  }
  return status;
}

/* How many columns `element sh` has, where it is one that can be read. */
static size_t count_rest(const conic_ply_header *header, const conic_ply_element *vertices) {
  const conic_ply_element *sh = conic_ply_find_element(header, "sh");
  char name[32];
  size_t n = 0;
  if (!sh || sh->count != vertices->count)
    return 0;
  for (; n < MOST_REST; n++) {
    snprintf(name, sizeof name, "f_rest_%zu", n);
    if (conic_ply_find_property(header, sh, name) < 0)
      break;
  }
  return n == 9 || n == 24 || n == 45 ? n : 0;
}

static conic_status check_packed_header(const conic_input *input, const conic_ply_header *header) {
  const conic_ply_element *chunks = conic_ply_find_element(header, "chunk");
  const conic_ply_element *vertices = conic_ply_find_element(header, "vertex");
  if (chunks > vertices || chunks->count != vertices->count / CHUNK + (vertices->count % CHUNK != 0))
    return conic_fail(input->context, CONIC_ERROR_INPUT,
                      "%s: %llu chunks before %llu Gaussians are wanted, one for each 256 (line %llu)", input->name,
                      (unsigned long long)(vertices->count / CHUNK + (vertices->count % CHUNK != 0)),
                      (unsigned long long)vertices->count, (unsigned long long)chunks->line);
  for (size_t i = 0; i < header->n_elements; i++)
    if (header->elements[i].has_lists && strcmp(header->elements[i].name, "face") != 0)
      return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: packed Gaussians have no lists (line %llu)",
                        input->name, (unsigned long long)header->elements[i].line);
  for (int i = 0; i < 4; i++) {
    int k = conic_ply_find_property(header, vertices, packed_names[i]);
    if (header->properties[vertices->first_property + (size_t)k].type != CONIC_PLY_UINT32)
      return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: %s is not of type uint (line %llu)", input->name,
                        packed_names[i], (unsigned long long)vertices->line);
  }
  return CONIC_OK;
}

static conic_status read_packed_elements(compressed_reader *reader, size_t n_rest) {
  const conic_ply_header *header = reader->header;
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < header->n_elements; i++) {
    const conic_ply_element *element = &header->elements[i];
    status = conic_ply_begin_whole(&reader->source, element);
    if (status != CONIC_OK)
      break;
    if (strcmp(element->name, "chunk") == 0)
      status = read_boxes(reader);
    else if (strcmp(element->name, "vertex") == 0)
      status = read_packed(reader);
    else if (strcmp(element->name, "sh") == 0 && n_rest)
      status = read_harmonics(reader, n_rest);
    else
      status = conic_ply_skip_element(&reader->source, header);
  }
  return status;
}

static conic_status read_packed_scene(compressed_reader *reader, const conic_gaussians_read_options *options) {
  const conic_ply_header *header = reader->header;
  const conic_ply_element *vertices = conic_ply_find_element(header, "vertex");
  conic_input *input = reader->source.input;
  size_t n_rest = count_rest(header, vertices);
  unsigned fields = CONIC_GAUSSIANS_SOURCE | (header->splat_mode == CONIC_PLY_MODE_2D ? CONIC_GAUSSIANS_2D : 0);
  conic_status status = check_packed_header(input, header);
  if (status == CONIC_OK) /* before arrays are made for what a short file only says to have */
    status = conic_ply_begin_whole(&reader->source, vertices);
  if (status == CONIC_OK)
    status = conic_gaussians_begin(input->context, input->name, options, vertices->count,
                                   conic_degree_of_coefficients(1 + n_rest / 3), fields, reader->gaussians);
  if (status != CONIC_OK)
    return status;
  conic_gaussians_take_comments(header, reader->gaussians);
  reader->n_chunks = (size_t)conic_ply_find_element(header, "chunk")->count;
  reader->chunks = conic_memory_allocate(input->context, reader->n_chunks, sizeof *reader->chunks);
  return reader->chunks ? read_packed_elements(reader, n_rest) : CONIC_ERROR_MEMORY;
}

conic_status conic_compressed_ply_read(conic_input *input, const conic_ply_header *header,
                                       const conic_gaussians_read_options *options, conic_gaussians *gaussians) {
  compressed_reader *reader = conic_memory_allocate_zeroed(input->context, 1, sizeof *reader);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->source = (conic_ply_source){.input = input, .format = header->format};
  reader->header = header;
  reader->gaussians = gaussians;
  conic_status status = read_packed_scene(reader, options);
  if (reader->source.is_cut)
    status = conic_ply_tell_cut(&reader->source, 0);
  conic_memory_release_these(input->context, reader->chunks, reader);
  return status;
}

/* --- writing --- */

/* What a chunk keeps of one Gaussian before it is packed: mean, ln scale, colour. */
typedef double chunk_values[9];

static void take_values(const conic_gaussians *gaussians, size_t i, chunk_values values) {
  float room[CONIC_MOST_HARMONICS];
  const float *sh = conic_gaussians_harmonics(gaussians, i, room);
  for (int axis = 0; axis < 3; axis++) {
    double log_scale = gaussians->scale[axis] ? (double)conic_gaussians_log_scale(gaussians, axis, i) : -20.0;
    values[axis] = conic_gaussians_mean(gaussians, axis, i);
    values[3 + axis] = log_scale > 20.0 ? 20.0 : log_scale < -20.0 ? -20.0 : log_scale;
    values[6 + axis] = 0.5 + CONIC_SH_CONSTANT * (double)sh[axis];
  }
}

/* The finite ones' box, as floats that hold all of them. */
static void find_bounds(const chunk_values *values, size_t n, chunk_bounds bounds) {
  for (int k = 0; k < 9; k++) {
    float low = 0.0f, high = 0.0f;
    int is_begun = 0;
    for (size_t i = 0; i < n; i++) {
      float value = (float)values[i][k];
      if (value - value != 0.0f)
        continue;
      low = !is_begun || value < low ? value : low;
      high = !is_begun || value > high ? value : high;
      is_begun = 1;
    }
    bounds[k / 3 * 6 + k % 3] = low;
    bounds[k / 3 * 6 + 3 + k % 3] = high;
  }
}

static uint32_t pack_value(const chunk_values values, const chunk_bounds bounds, int k, int n_bits) {
  double low = (double)bounds[k / 3 * 6 + k % 3], high = (double)bounds[k / 3 * 6 + 3 + k % 3];
  return conic_code_of_share(high > low ? (values[k] - low) / (high - low) : 0.0, (1u << n_bits) - 1);
}

static uint32_t pack_component(double value) {
  return conic_code_of_share(value * 0.70710678118654752 + 0.5, 1023);
}

static double rounded_packed(double value) {
  return ((double)pack_component(value) / 1023.0 - 0.5) * 1.41421356237309505;
}

static uint32_t pack_rotation(const conic_gaussians *gaussians, size_t i) {
  double q[4];
  conic_gaussians_unit_rotation(gaussians, i, q);
  int left_out = conic_find_left_out(q, rounded_packed);
  uint32_t packed = (uint32_t)left_out;
  for (int k = 0; k < 4; k++)
    if (k != left_out)
      packed = packed << 10 | pack_component(q[k]);
  return packed;
}

static void print_packed_header(const conic_gaussian_writer *writer, size_t n_rest) {
  const conic_gaussians *gaussians = writer->gaussians;
  size_t n = gaussians->count;
  fprintf(writer->to, "ply\nformat binary_little_endian 1.0\ncomment conic %s\n", conic_version());
  conic_gaussian_writer_put_comments(writer, !gaussians->scale[2]);
  fprintf(writer->to, "element chunk %zu\n", n / CHUNK + (n % CHUNK != 0));
  for (int i = 0; i < N_BOUNDS; i++)
    fprintf(writer->to, "property float %s\n", bound_names[i]);
  fprintf(writer->to, "element vertex %zu\n", n);
  for (int i = 0; i < 4; i++)
    fprintf(writer->to, "property uint %s\n", packed_names[i]);
  if (n_rest)
    fprintf(writer->to, "element sh %zu\n", n);
  for (size_t i = 0; i < n_rest; i++)
    fprintf(writer->to, "property uchar f_rest_%zu\n", i);
  fprintf(writer->to, "end_header\n");
}

/* Of chunk `i_chunk`, the box or the packed Gaussians. */
static conic_status put_chunk(const conic_gaussian_writer *writer, size_t i_chunk, int is_box) {
  const conic_gaussians *gaussians = writer->gaussians;
  size_t first = i_chunk * CHUNK, left = gaussians->count - first, n = left < CHUNK ? left : CHUNK;
  chunk_values values[CHUNK];
  chunk_bounds bounds;
  unsigned char bytes[CHUNK * 16];
  for (size_t i = 0; i < n; i++)
    take_values(gaussians, first + i, values[i]);
  find_bounds((const chunk_values *)values, n, bounds);
  for (int k = 0; is_box && k < N_BOUNDS; k++)
    conic_store_float(bytes + (size_t)k * 4, bounds[k]);
  if (is_box)
    return conic_gaussian_writer_put(writer, bytes, N_BOUNDS * sizeof(float));
  for (size_t i = 0; i < n; i++) {
    uint32_t codes[9];
    for (int k = 0; k < 9; k++)
      codes[k] = pack_value(values[i], bounds, k, k >= 6 ? 8 : k % 3 == 1 ? 10 : 11);
    conic_store_32(bytes + 16 * i, codes[0] << 21 | codes[1] << 11 | codes[2]);
    conic_store_32(bytes + 16 * i + 4, pack_rotation(gaussians, first + i));
    conic_store_32(bytes + 16 * i + 8, codes[3] << 21 | codes[4] << 11 | codes[5]);
    conic_store_32(bytes + 16 * i + 12, codes[6] << 24 | codes[7] << 16 | codes[8] << 8 |
                                            conic_code_of_share((double)gaussians->opacity[first + i], 255));
  }
  return conic_gaussian_writer_put(writer, bytes, 16 * n);
}

static conic_status put_packed_harmonics(const conic_gaussian_writer *writer, size_t i, size_t n_rest) {
  unsigned char codes[MOST_REST];
  float room[CONIC_MOST_HARMONICS];
  const float *sh = conic_gaussians_harmonics(writer->gaussians, i, room);
  for (size_t channel = 0; channel < 3; channel++)
    for (size_t k = 0; k < n_rest / 3; k++) {
      double code = floor(((double)sh[3 * (k + 1) + channel] / 8.0 + 0.5) * 256.0);
      codes[channel * (n_rest / 3) + k] = (unsigned char)(code >= 255.0 ? 255.0 : code >= 0.0 ? code : 0.0);
    }
  return conic_gaussian_writer_put(writer, codes, n_rest);
}

conic_status conic_compressed_ply_write(const conic_gaussian_writer *writer) {
  size_t n = writer->gaussians->count, n_chunks = n / CHUNK + (n % CHUNK != 0);
  size_t n_rest = conic_harmonics_of_degree(writer->sh_degree) - 3;
  conic_status status = CONIC_OK;
  print_packed_header(writer, n_rest);
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; status == CONIC_OK && i < n_chunks; i++)
      status = put_chunk(writer, i, pass == 0);
  for (size_t i = 0; status == CONIC_OK && n_rest && i < n; i++) {
    status = put_packed_harmonics(writer, i, n_rest);
    if (status == CONIC_OK)
      status = conic_gaussian_writer_tell(writer, i);
  }
  return status;
}
