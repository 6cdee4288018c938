#include "core/formats/model_read.h"

#include "core/assimp/assimp_kinds.h"
#include "core/assimp/assimp_read.h"
#include "core/files/file.h"
#include "core/formats/file_kinds.h"
#include "core/formats/readers.h"
#include "core/gltf/gltf_read.h"
#include "core/splats/point_fields.h"

CONIC_DEFINE_OPTIONS(conic_read_options, .cutoff = 1.5f)

const char *conic_model_kind_name(conic_model_kind kind) {
  static const char *const names[] = {
      [CONIC_MODEL_PLY] = "ply", [CONIC_MODEL_OBJ] = "obj",   [CONIC_MODEL_XYZ] = "xyz", [CONIC_MODEL_LAS] = "las",
      [CONIC_MODEL_PCD] = "pcd", [CONIC_MODEL_E57] = "e57",   [CONIC_MODEL_PTX] = "ptx", [CONIC_MODEL_STL] = "stl",
      [CONIC_MODEL_OFF] = "off", [CONIC_MODEL_GLTF] = "gltf", [CONIC_MODEL_GLB] = "glb", [CONIC_MODEL_3MF] = "3mf",
      [CONIC_MODEL_DAE] = "dae", [CONIC_MODEL_FBX] = "fbx",   [CONIC_MODEL_3DS] = "3ds", [CONIC_MODEL_X3D] = "x3d",
      [CONIC_MODEL_DXF] = "dxf", [CONIC_MODEL_AMF] = "amf"};
  return (int)kind >= 0 && (size_t)kind < sizeof names / sizeof *names ? names[kind] : NULL;
}

void conic_model_release(conic_context *context, conic_model *model) {
  conic_splats_release(context, &model->points);
  conic_memory_release(context, model->triangles);
  conic_faces_destroy(context, model->faces);
  conic_memory_release(context, model->fields);
  memset(model, 0, sizeof *model);
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

static conic_status refuse(const conic_input *input, const conic_foreign_kind *kind) {
  return kind ? conic_fail(input->context, CONIC_ERROR_INPUT, "%s: this is %s: %s; %s (at byte 0)", input->name,
                           kind->name, kind->remedy, conic_readable_kinds)
              : conic_fail(input->context, CONIC_ERROR_INPUT, "%s: no model that is known; %s (at byte 0)", input->name,
                           conic_readable_kinds);
}

static int is_text_name(const char *path) {
  static const char *const endings[] = {"xyz", "pts", "csv", "txt", "asc", "xyzrgb", "neu"};
  size_t i = 0;
  while (i < sizeof endings / sizeof *endings && !conic_file_has_ending(path, endings[i]))
    i++;
  return i < sizeof endings / sizeof *endings;
}

/* By content; then by the ending; then by content that is less certain. */
static conic_status find_kind(const conic_input *input, const char *path, conic_model_kind *kind) {
  const char *bytes = (const char *)conic_input_bytes(input);
  size_t n = conic_input_available(input);
  int is_xyz_name = conic_file_has_ending(path, "xyz") || conic_file_has_ending(path, "pts");
  const conic_foreign_kind *foreign = conic_foreign_kind_find(path, bytes, n, 1);
  if (conic_assimp_find_content(path, bytes, n, conic_input_remaining_bytes(input), kind))
    return CONIC_OK;
  if (n == 0)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: the file is empty (at byte 0)", input->name);
  if (foreign)
    return refuse(input, foreign);
  if (is_ply(bytes, n))
    *kind = CONIC_MODEL_PLY;
  else if (n >= 4 && memcmp(bytes, "LASF", 4) == 0)
    *kind = CONIC_MODEL_LAS;
  else if (conic_e57_is(bytes, n))
    *kind = CONIC_MODEL_E57;
  else if (conic_ptx_is_likely(bytes, n))
    *kind = CONIC_MODEL_PTX;
  else if (conic_pcd_is_likely(bytes, n) || conic_file_has_ending(path, "pcd"))
    *kind = CONIC_MODEL_PCD;
  else if (conic_file_has_ending(path, "ply"))
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: not a PLY file: it does not begin with 'ply' (at byte 0)",
                      input->name);
  else if (conic_file_has_ending(path, "las") || conic_file_has_ending(path, "laz"))
    return conic_fail(input->context, CONIC_ERROR_INPUT,
                      "%s: not a LAS file: it does not begin with 'LASF' (at byte 0)", input->name);
  else if (conic_assimp_find_ending(path, kind))
    return CONIC_OK;
  else if (conic_file_has_ending(path, "obj") || (!is_xyz_name && is_obj(bytes, n)))
    *kind = CONIC_MODEL_OBJ;
  else if ((foreign = conic_foreign_kind_find(path, bytes, n, 0)))
    return refuse(input, foreign);
  else if (!memchr(bytes, 0, n) && (is_text_name(path) || conic_xyz_is_likely(bytes, n)))
    *kind = CONIC_MODEL_XYZ;
  else
    return refuse(input, NULL);
  return CONIC_OK;
}

conic_status conic_model_open(conic_context *context, const char *path, conic_input *input, conic_model_kind *kind) {
  conic_status status = conic_input_open(context, path, input);
  if (status != CONIC_OK)
    return status;
  status = conic_input_skip_mark(input);
  if (status == CONIC_OK)
    status = conic_input_fill(input, CONIC_INPUT_LONGEST_LINE);
  if (status == CONIC_OK)
    status = find_kind(input, path, kind);
  if (status != CONIC_OK)
    conic_input_close(input);
  return status;
}

/* Of all kinds but Assimp's. */
static conic_status (*const readers[])(conic_input *, const conic_read_options *, const conic_delivery *,
                                       conic_model *) = {
    [CONIC_MODEL_PLY] = conic_ply_read,   [CONIC_MODEL_OBJ] = conic_obj_read, [CONIC_MODEL_XYZ] = conic_xyz_read,
    [CONIC_MODEL_LAS] = conic_las_read,   [CONIC_MODEL_PCD] = conic_pcd_read, [CONIC_MODEL_E57] = conic_e57_read,
    [CONIC_MODEL_PTX] = conic_ptx_read,   [CONIC_MODEL_STL] = conic_stl_read, [CONIC_MODEL_OFF] = conic_off_read,
    [CONIC_MODEL_GLTF] = conic_gltf_read, [CONIC_MODEL_GLB] = conic_gltf_read};

conic_status conic_model_read_kind(conic_input *input, conic_model_kind kind, const conic_read_options *options,
                                   const conic_delivery *delivery, conic_model *model) {
  conic_status status = conic_assimp_reads(kind) ? conic_assimp_read(input, kind, options, model)
                                                 : readers[kind](input, options, delivery, model);
  if (kind == CONIC_MODEL_STL || (model->points.color[0] && !model->colors_are))
    model->colors_are = kind == CONIC_MODEL_GLTF || kind == CONIC_MODEL_GLB ? CONIC_COLORS_LINEAR
                        : model->points.color[0] || model->faces            ? CONIC_COLORS_CODES
                                                                            : CONIC_COLORS_NONE;
  int is_pts = kind == CONIC_MODEL_XYZ && conic_file_has_ending(input->name, "pts");
  if (kind == CONIC_MODEL_LAS || kind == CONIC_MODEL_E57 || kind == CONIC_MODEL_PTX || is_pts)
    model->up[2] = 1.0;
  model->kind = kind;
  return status == CONIC_OK ? conic_fields_check(input->context, input->name, options, model) : status;
}

conic_status conic_read_options_check(conic_context *context, const char *path, const conic_read_options *options,
                                      conic_read_options *settings) {
  conic_read_options_init(settings);
  if (!options)
    return CONIC_OK;
  if (!conic_options_take(settings, options) ||
      !(settings->cutoff > 0.0f && settings->cutoff - settings->cutoff == 0.0f))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the reader's options have no meaning", path);
  return CONIC_OK;
}

conic_status conic_model_read(conic_context *context, const char *path, const conic_read_options *options,
                              conic_model *model) {
  conic_read_options settings;
  conic_model_kind kind = CONIC_MODEL_PLY;
  conic_input input;
  memset(model, 0, sizeof *model);
  conic_status status = conic_read_options_check(context, path, options, &settings);
  if (status == CONIC_OK && conic_model_is_lent(context, path)) {
    status = conic_model_copy_lent(context, path, &settings, model);
    if (status != CONIC_OK)
      conic_model_release(context, model);
    return status;
  }
  if (status == CONIC_OK)
    status = conic_model_open(context, path, &input, &kind);
  if (status != CONIC_OK)
    return status;
  status = conic_model_read_kind(&input, kind, &settings, NULL, model);
  conic_input_close(&input);
  if (status != CONIC_OK)
    conic_model_release(context, model);
  return status;
}
