#include "conic/model.h"

#include <string.h>

#include "core/input.h"
#include "core/memory.h"
#include "core/message.h"
#include "core/obj.h"
#include "core/ply_read.h"

void conic_read_options_init(conic_read_options *options) {
  memset(options, 0, sizeof *options);
  options->size = sizeof *options;
  options->cutoff = 1.5f;
}

void conic_model_release(conic_context *context, conic_model *model) {
  conic_splats_release(context, &model->points);
  conic_memory_release(context, model->triangles);
  memset(model, 0, sizeof *model);
}

typedef struct signature {
  const char *kind;
  const char *bytes;
  size_t n_bytes;
} signature;

/* Files that are easily taken for models, or given by mistake. */
static const signature other_kinds[] = {
    {"an OpenEXR image", "\x76\x2f\x31\x01", 4},
    {"a PNG image", "\x89PNG", 4},
    {"a JPEG image", "\xff\xd8\xff", 3},
    {"a LAS point cloud", "LASF", 4},
    {"a binary glTF file", "glTF", 4},
    {"a gzip archive", "\x1f\x8b", 2},
    {"a ZIP archive", "PK\x03\x04", 4},
    {"a Zstandard archive", "\x28\xb5\x2f\xfd", 4},
    {"an STL file", "solid ", 6},
};

static int has_ending(const char *path, const char *ending) {
  size_t n = strlen(path), n_ending = strlen(ending);
  if (n < n_ending)
    return 0;
  for (size_t i = 0; i < n_ending; i++)
    if ((path[n - n_ending + i] | 0x20) != (ending[i] | 0x20))
      return 0;
  return 1;
}

static int is_ply(const char *bytes, size_t n) {
  return n >= 4 && memcmp(bytes, "ply", 3) == 0 && (bytes[3] == '\n' || bytes[3] == '\r' || bytes[3] == ' ');
}

/* Whether the first line that is neither empty nor a comment begins with a word of OBJ. */
static int is_obj(const char *bytes, size_t n) {
  static const char *const keywords[] = {"v ", "v\t", "vn ", "vt ", "f ", "o ", "g ", "s ", "mtllib ", "usemtl "};
  const char *c = bytes, *end = bytes + n;
  while (c < end && (*c == '#' || *c == '\n' || *c == '\r')) {
    const char *line_end = memchr(c, '\n', (size_t)(end - c));
    c = line_end ? line_end + 1 : end;
  }
  for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++) {
    size_t length = strlen(keywords[i]);
    if ((size_t)(end - c) >= length && memcmp(c, keywords[i], length) == 0)
      return 1;
  }
  return 0;
}

/* By content; then by the ending; then by content that is less certain. */
static conic_status read_by_kind(conic_input *input, const char *path, const conic_read_options *options,
                                 conic_model *model) {
  conic_status status = conic_input_fill(input, CONIC_INPUT_LONGEST_WORD);
  const char *bytes = (const char *)conic_input_bytes(input);
  size_t n = conic_input_available(input);
  if (status != CONIC_OK)
    return status;
  if (n == 0)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: the file is empty (at byte 0)", input->name);
  if (is_ply(bytes, n))
    return conic_ply_read(input, options, model);
  for (size_t i = 0; i < sizeof other_kinds / sizeof *other_kinds; i++)
    if (n >= other_kinds[i].n_bytes && memcmp(bytes, other_kinds[i].bytes, other_kinds[i].n_bytes) == 0)
      return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: this is %s, no PLY or OBJ file (at byte 0)",
                        input->name, other_kinds[i].kind);
  if (has_ending(path, ".ply"))
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: not a PLY file: it does not begin with 'ply' (at byte 0)",
                      input->name);
  if (has_ending(path, ".obj") || is_obj(bytes, n))
    return conic_obj_read(input, model);
  return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: neither a PLY nor an OBJ file (at byte 0)", input->name);
}

conic_status conic_model_read(conic_context *context, const char *path, const conic_read_options *options,
                              conic_model *model) {
  conic_read_options settings;
  conic_input input;
  memset(model, 0, sizeof *model);
  conic_read_options_init(&settings);
  if (options) {
    if (options->size != sizeof settings || !(options->cutoff > 0.0f && options->cutoff - options->cutoff == 0.0f))
      return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the reader's options have no meaning", path);
    settings = *options;
  }
  conic_status status = conic_input_open(context, path, &input);
  if (status != CONIC_OK)
    return status;
  status = read_by_kind(&input, path, &settings, model);
  conic_input_close(&input);
  if (status != CONIC_OK)
    conic_model_release(context, model);
  return status;
}
