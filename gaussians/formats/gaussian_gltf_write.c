/* Gaussians as glTF by KHR_gaussian_splatting (release candidate of 2026): one primitive of points, an array an
 * attribute; a .gltf carries them as base64. */
#include <stdarg.h>

#include "conic/version.h"
#include "core/files/number.h"
#include "gaussians/formats/gaussian_formats.h"

enum { BLOCK = 3072, JSON_ROOM = 16384 }; /* a multiple of 3, for base64 */

typedef struct gltf_attribute {
  char name[64];
  const char *type;
  int n_components, i_harmonic; /* -1: no harmonic */
} gltf_attribute;

/* Bytes on their way out, as they are or three to four letters. */
typedef struct gltf_sink {
  const conic_gaussian_writer *writer;
  int is_text;
  size_t n;
  unsigned char bytes[BLOCK];
  conic_status status;
} gltf_sink;

static void flush_sink(gltf_sink *sink) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char text[BLOCK / 3 * 4 + 4];
  size_t n = 0;
  for (size_t i = 0; sink->is_text && i < sink->n; i += 3) {
    size_t left = sink->n - i;
    uint32_t bits = (uint32_t)sink->bytes[i] << 16 | (left > 1 ? (uint32_t)sink->bytes[i + 1] << 8 : 0) |
                    (left > 2 ? sink->bytes[i + 2] : 0);
    for (size_t k = 0; k < 4; k++)
      text[n++] = k > left ? '=' : letters[bits >> (18 - 6 * k) & 63];
  }
  if (sink->status == CONIC_OK)
    sink->status = sink->is_text ? conic_gaussian_writer_put(sink->writer, text, n)
                                 : conic_gaussian_writer_put(sink->writer, sink->bytes, sink->n);
  sink->n = 0;
}

static void sink_float(gltf_sink *sink, float value) {
  conic_store_float(sink->bytes + sink->n, value);
  sink->n += sizeof value;
  if (sink->n == BLOCK)
    flush_sink(sink);
}

static size_t list_attributes(int sh_degree, gltf_attribute *attributes) {
  static const gltf_attribute first[] = {{"POSITION", "VEC3", 3, -1},
                                         {"KHR_gaussian_splatting:ROTATION", "VEC4", 4, -1},
                                         {"KHR_gaussian_splatting:SCALE", "VEC3", 3, -1},
                                         {"KHR_gaussian_splatting:OPACITY", "SCALAR", 1, -1}};
  size_t n = sizeof first / sizeof *first;
  memcpy(attributes, first, sizeof first);
  for (int degree = 0; degree <= sh_degree; degree++)
    for (int order = 0; order < 2 * degree + 1; order++) {
      gltf_attribute *attribute = &attributes[n++];
      *attribute = (gltf_attribute){.type = "VEC3", .n_components = 3, .i_harmonic = 3 * (degree * degree + order)};
      snprintf(attribute->name, sizeof attribute->name, "KHR_gaussian_splatting:SH_DEGREE_%d_COEF_%d", degree, order);
    }
  return n;
}

/* A quaternion that is one to a float's precision stays as it is. */
static void take_rotation(const conic_gaussians *gaussians, size_t i, float xyzw[4]) {
  double sum = 0.0, q[4];
  for (int k = 0; k < 4; k++)
    sum += (double)gaussians->rotation[k][i] * (double)gaussians->rotation[k][i];
  conic_gaussians_unit_rotation(gaussians, i, q);
  for (int k = 0; k < 4; k++)
    xyzw[(k + 3) % 4] = fabs(sum - 1.0) < 5e-7 ? gaussians->rotation[k][i] : (float)q[k];
}

static void put_attribute(gltf_sink *sink, size_t i_attribute, const gltf_attribute *attribute) {
  const conic_gaussians *gaussians = sink->writer->gaussians;
  for (size_t i = 0; sink->status == CONIC_OK && i < gaussians->count; i++) {
    float values[4] = {0.0f}, room[CONIC_MOST_HARMONICS];
    if (i_attribute == 1)
      take_rotation(gaussians, i, values);
    for (int k = 0; k < 3; k++)
      if (attribute->i_harmonic >= 0)
        values[k] = conic_gaussians_harmonics(gaussians, i, room)[attribute->i_harmonic + k];
      else if (i_attribute == 0)
        values[k] = (float)conic_gaussians_mean(gaussians, k, i);
      else if (i_attribute == 2)
        values[k] = gaussians->scale[k] ? gaussians->scale[k][i] : 0.0f;
    if (i_attribute == 3)
      values[0] = gaussians->opacity[i];
    for (int k = 0; k < attribute->n_components; k++)
      sink_float(sink, values[k]);
    if (i % 65536 == 65535)
      sink->status = conic_gaussian_writer_tell(sink->writer, i);
  }
}

/* --- the JSON --- */

typedef struct json_text {
  char text[JSON_ROOM];
  size_t n;
} json_text;

CONIC_AS_PRINTF(2, 3) static void add_json(json_text *json, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  json->n += (size_t)vsnprintf(json->text + json->n, JSON_ROOM - json->n, format, arguments);
  va_end(arguments);
}

/* The box of the means as they are written: floats. */
static void add_bounds(json_text *json, const conic_gaussians *gaussians) {
  double ends[2][3];
  char number[CONIC_NUMBER_ROOM];
  conic_gaussians_bounds(gaussians, ends[0], ends[1]);
  for (int end = 0; end < 2; end++) {
    add_json(json, ",\"%s\":[", end ? "max" : "min");
    for (int axis = 0; axis < 3; axis++) {
      conic_number_print_float(number, (float)ends[end][axis]);
      add_json(json, "%s%s", axis ? "," : "", number);
    }
    add_json(json, "]");
  }
}

/* Everything but the buffer's data, which come last. */
static void make_json(const conic_gaussian_writer *writer, const gltf_attribute *attributes, size_t n_attributes,
                      json_text *json) {
  const conic_gaussians *gaussians = writer->gaussians;
  uint64_t offset = 0;
  add_json(
      json,
      "{\"asset\":{\"version\":\"2.0\",\"generator\":\"conic %s\"},\"extensionsUsed\":[\"KHR_gaussian_splatting\"],"
      "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
      "\"meshes\":[{\"primitives\":[{\"mode\":0,\"extensions\":{\"KHR_gaussian_splatting\":{\"kernel\":\"ellipse\","
      "\"colorSpace\":\"%s_rec709_display\",\"sortingMethod\":\"cameraDistance\",\"projection\":\"perspective\"}},"
      "\"attributes\":{",
      conic_version(), gaussians->is_linear ? "lin" : "srgb");
  for (size_t i = 0; i < n_attributes; i++)
    add_json(json, "%s\"%s\":%zu", i ? "," : "", attributes[i].name, i);
  add_json(json, "}}]}],\"accessors\":[");
  for (size_t i = 0; i < n_attributes; i++) {
    add_json(json, "%s{\"bufferView\":%zu,\"componentType\":5126,\"count\":%zu,\"type\":\"%s\"", i ? "," : "", i,
             gaussians->count, attributes[i].type);
    if (i == 0)
      add_bounds(json, gaussians);
    add_json(json, "}");
  }
  add_json(json, "],\"bufferViews\":[");
  for (size_t i = 0; i < n_attributes; i++) {
    uint64_t n_bytes = (uint64_t)gaussians->count * 4 * (uint64_t)attributes[i].n_components;
    add_json(json, "%s{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu}", i ? "," : "", (unsigned long long)offset,
             (unsigned long long)n_bytes);
    offset += n_bytes;
  }
  add_json(json, "],\"buffers\":[{\"byteLength\":%llu", (unsigned long long)offset);
}

static conic_status put_text(const conic_gaussian_writer *writer, const char *text) {
  return conic_gaussian_writer_put(writer, text, strlen(text));
}

/* Header, JSON, padded by blanks, and the header of the binary part. */
static conic_status put_glb_start(const conic_gaussian_writer *writer, json_text *json, uint64_t n_binary) {
  unsigned char words[5][4];
  add_json(json, "}]}");
  while (json->n % 4)
    add_json(json, " ");
  uint64_t n_all = 28 + json->n + n_binary;
  if (n_all > UINT32_MAX)
    return conic_fail(writer->context, CONIC_ERROR_ARGUMENT, "%s: a .glb ends before 4 GiB; write a .gltf",
                      writer->path);
  const uint32_t values[5] = {0x46546c67, 2, (uint32_t)n_all, (uint32_t)json->n, 0x4e4f534a};
  for (int i = 0; i < 5; i++)
    conic_store_32(words[i], values[i]);
  conic_status status = conic_gaussian_writer_put(writer, words, sizeof words);
  if (status == CONIC_OK)
    status = conic_gaussian_writer_put(writer, json->text, json->n);
  conic_store_32(words[0], (uint32_t)n_binary);
  conic_store_32(words[1], 0x004e4942);
  return status == CONIC_OK ? conic_gaussian_writer_put(writer, words, 8) : status;
}

static conic_status put_all(const conic_gaussian_writer *writer, json_text *json, gltf_sink *sink) {
  gltf_attribute attributes[4 + CONIC_MOST_HARMONICS / 3];
  size_t n_attributes = list_attributes(writer->sh_degree, attributes);
  uint64_t n_numbers = 0;
  int is_glb = writer->options->kind == CONIC_GAUSSIANS_GLB;
  const conic_gaussians *set = writer->gaussians;
  for (size_t i = 0; i < set->count; i++) /* as the text has it, and the reader */
    if (set->scale[0][i] < 0.0f || set->scale[1][i] < 0.0f || (set->scale[2] && set->scale[2][i] < 0.0f) ||
        set->opacity[i] < 0.0f || set->opacity[i] > 1.0f)
      return conic_fail(writer->context, CONIC_ERROR_INPUT,
                        "%s: glTF has no Gaussians of negative scales, or opacities outside 0 and 1, as number %zu has",
                        writer->path, i);
  for (size_t i = 0; i < n_attributes; i++)
    n_numbers += (uint64_t)attributes[i].n_components * writer->gaussians->count;
  make_json(writer, attributes, n_attributes, json);
  if (is_glb)
    sink->status = put_glb_start(writer, json, 4 * n_numbers);
  else {
    add_json(json, ",\"uri\":\"data:application/octet-stream;base64,");
    sink->status = conic_gaussian_writer_put(writer, json->text, json->n);
  }
  for (size_t i = 0; i < n_attributes; i++)
    put_attribute(sink, i, &attributes[i]);
  flush_sink(sink);
  return sink->status == CONIC_OK && !is_glb ? put_text(writer, "\"}]}") : sink->status;
}

conic_status conic_gaussian_gltf_write(const conic_gaussian_writer *writer) {
  struct {
    json_text json;
    gltf_sink sink;
  } *state = conic_memory_allocate_zeroed(writer->context, 1, sizeof *state);
  if (!state)
    return CONIC_ERROR_MEMORY;
  state->sink.writer = writer;
  state->sink.is_text = writer->options->kind == CONIC_GAUSSIANS_GLTF;
  conic_status status = put_all(writer, &state->json, &state->sink);
  conic_memory_release(writer->context, state);
  return status;
}
