#include "core/assimp/assimp_part.h"

#include "conic/triangles.h"
#include "core/base/context_struct.h"
#include "core/files/file.h"
#include "core/files/scratch.h"
#include "core/image/image_common.h"
#include "core/image/texture_levels.h"
#include "core/pictures/image_samples.h"

enum { LONGEST_PATH = 2 * CONIC_INPUT_LONGEST_WORD };

/* Messages while a picture is read become warnings of the model, which can be drawn without it. */
typedef struct picture_log {
  conic_context *context;
  const char *model, *path; /* the picture's path, which messages begin with, is replaced by: */
  const char *name;
} picture_log;

static void warn_of_picture(void *cookie, conic_log_level level, const char *message) {
  const picture_log *log = cookie;
  size_t n = strlen(log->path);
  (void)level;
  if (strncmp(message, log->path, n) == 0 && strncmp(message + n, ": ", 2) == 0)
    message += n + 2;
  conic_log(log->context, CONIC_LOG_WARNING, "%s: the texture %s is left out: %s", log->model, log->name, message);
}

/* The picture in a file; null where it cannot be read. Errors: MEMORY, CANCELLED. */
static conic_status read_texture_file(const conic_input *input, const char *path, const char *name,
                                      conic_texture_wrap wrap, conic_texture **texture) {
  conic_context *context = input->context, told = *context;
  picture_log log = {context, input->name, path, name};
  conic_image image;
  told.options.log = warn_of_picture;
  told.options.log_cookie = &log;
  conic_status status = conic_texture_read_image(&told, path, &image);
  if (status == CONIC_ERROR_MEMORY || status == CONIC_ERROR_CANCELLED)
    return status;
  if (status != CONIC_OK)
    return CONIC_OK;
  return conic_texture_take(context, &image, wrap, texture);
}

static conic_status take_path(const conic_input *input, conic_assimp_process *process, uint64_t n_bytes,
                              conic_texture_wrap wrap, conic_texture **texture) {
  char name[CONIC_INPUT_LONGEST_WORD] = "", path[LONGEST_PATH];
  if (n_bytes >= sizeof name)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: a picture's name is too long", input->name);
  conic_status status = conic_assimp_process_take(process, name, (size_t)n_bytes);
  if (status != CONIC_OK)
    return status;
  if (conic_input_find(input, name, strlen(name), path, sizeof path))
    return read_texture_file(input, path, path, wrap, texture);
  conic_log(input->context, CONIC_LOG_WARNING, "%s: the texture %s is not there, and is left out", input->name, name);
  return CONIC_OK;
}

/* Pictures are read from files, but this one lies within another file. */
static conic_status read_embedded(const conic_input *input, const void *bytes, size_t n_bytes, const char *name,
                                  conic_texture_wrap wrap, conic_texture **texture) {
  const char *folder = getenv("TMPDIR");
  char beside[LONGEST_PATH], path[64];
  conic_scratch scratch;
  snprintf(beside, sizeof beside, "%s/texture", folder && *folder ? folder : "/tmp");
  conic_status status = conic_scratch_open(input->context, beside, &scratch);
  if (status != CONIC_OK)
    return status;
  snprintf(path, sizeof path, "/proc/self/fd/%d", scratch.descriptor);
  status = conic_scratch_write(&scratch, 0, bytes, n_bytes);
  if (status == CONIC_OK)
    status = read_texture_file(input, path, name, wrap, texture);
  conic_scratch_close(&scratch);
  return status;
}

static conic_status make_from_texels(conic_context *context, const conic_assimp_record *record, const void *texels,
                                     conic_texture_wrap wrap, conic_texture **texture) {
  const conic_samples_layout layout = {.n_channels = 4, .sample_bytes = 1, .is_straight = 1};
  conic_image image;
  conic_status status =
      conic_image_allocate(context, (int)record->width, (int)record->height, 1u << CONIC_PLANE_RGBA, &image);
  if (status != CONIC_OK)
    return status;
  conic_samples_to_rgba(context, texels, image.width, image.height, layout, image.planes[CONIC_PLANE_RGBA]);
  return conic_texture_take(context, &image, wrap, texture);
}

static conic_status take_embedded(const conic_input *input, conic_assimp_process *process,
                                  const conic_assimp_record *record, size_t i_material, conic_texture **texture) {
  conic_texture_wrap wrap = record->is_clamped ? CONIC_WRAP_CLAMP : CONIC_WRAP_REPEAT;
  int is_texels = record->picture == CONIC_ASSIMP_TEXELS;
  char name[64];
  if (is_texels &&
      (record->width < 1 || record->height < 1 || record->width > CONIC_IMAGE_MAX_SIZE ||
       record->height > CONIC_IMAGE_MAX_SIZE || record->n_bytes != UINT64_C(4) * record->width * record->height))
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: a texture of %u × %u texels cannot be used", input->name,
                      record->width, record->height);
  if (record->n_bytes > SIZE_MAX / 2)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: a texture is too large", input->name);
  if (is_texels && conic_texture_check_room(input->context, input->name, (int)record->width, (int)record->height))
    return CONIC_ERROR_INPUT;
  void *bytes = conic_memory_allocate(input->context, (size_t)record->n_bytes, 1);
  if (!bytes)
    return CONIC_ERROR_MEMORY;
  snprintf(name, sizeof name, "of material %zu, in the file itself,", i_material);
  conic_status status = conic_assimp_process_take(process, bytes, (size_t)record->n_bytes);
  if (status == CONIC_OK)
    status = is_texels ? make_from_texels(input->context, record, bytes, wrap, texture)
                       : read_embedded(input, bytes, (size_t)record->n_bytes, name, wrap, texture);
  conic_memory_release(input->context, bytes);
  return status;
}

conic_status conic_assimp_take_material(const conic_input *input, conic_assimp_process *process,
                                        const conic_assimp_record *record, conic_assimp_part_builder *parts) {
  conic_faces *faces = parts->faces;
  if (!faces || faces->n_made == CONIC_MAX_MATERIALS)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: there are too many materials", input->name);
  conic_material material = {.texture = NULL};
  for (int channel = 0; channel < 3; channel++) {
    float value = conic_assimp_decode(parts, record->color[channel]);
    material.color[channel] = value >= 0.0f && value <= 1e6f ? value : 1.0f;
  }
  float opacity = record->opacity, cutoff = record->alpha_cutoff;
  material.transparency = opacity > 0.0f && opacity < 1.0f ? 1.0f - opacity : 0.0f;
  material.alpha_cutoff = cutoff >= 0.0f && cutoff <= 1.0f ? cutoff : 0.5f;
  material.alpha_mode = record->alpha_mode <= CONIC_ALPHA_OPAQUE ? record->alpha_mode : CONIC_ALPHA_BLEND;
  conic_status status = CONIC_OK;
  if (record->picture == CONIC_ASSIMP_PATH)
    status = take_path(input, process, record->n_bytes, record->is_clamped ? CONIC_WRAP_CLAMP : CONIC_WRAP_REPEAT,
                       &material.texture);
  else if (record->picture != CONIC_ASSIMP_NO_PICTURE)
    status = take_embedded(input, process, record, faces->n_made, &material.texture);
  if (status == CONIC_OK)
    status = conic_faces_add_material(input->context, faces, &material);
  if (status != CONIC_OK)
    conic_texture_destroy(material.texture);
  return status;
}
