#include "core/assimp/assimp_part.h"

#include "conic/triangles.h"
#include "core/image/image_common.h"
#include "core/image/texture_levels.h"
#include "core/pictures/image_samples.h"
#include "core/pictures/texture_file.h"

enum { LONGEST_PATH = 2 * CONIC_INPUT_LONGEST_WORD };

static conic_status take_path(const conic_input *input, conic_assimp_process *process, uint64_t n_bytes,
                              conic_texture_wrap wrap, conic_texture **texture) {
  char name[CONIC_INPUT_LONGEST_WORD] = "", path[LONGEST_PATH];
  if (n_bytes >= sizeof name)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: a picture's name is too long", input->name);
  conic_status status = conic_assimp_process_take(process, name, (size_t)n_bytes);
  if (status != CONIC_OK)
    return status;
  if (conic_input_find(input, name, strlen(name), path, sizeof path))
    return conic_texture_file_read(input->context, input->name, path, path, wrap, texture);
  conic_log(input->context, CONIC_LOG_WARNING, "%s: the texture %s is not there, and is left out", input->name, name);
  return CONIC_OK;
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
                       : conic_texture_bytes_read(input->context, input->name, bytes, (size_t)record->n_bytes, name,
                                                  wrap, texture);
  conic_memory_release(input->context, bytes);
  return status;
}

conic_status conic_assimp_take_material(const conic_input *input, conic_assimp_process *process,
                                        const conic_assimp_record *record, conic_mesh_parts *parts) {
  conic_faces *faces = parts->faces;
  if (!faces || faces->n_made == CONIC_MAX_MATERIALS)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: there are too many materials", input->name);
  conic_material material = {.alpha_cutoff = 0.5f};
  for (int channel = 0; channel < 3; channel++) {
    float value = conic_assimp_decode(record->color[channel]);
    material.color[channel] = value >= 0.0f && value <= 1e6f ? value : 1.0f;
  }
  material.transparency = record->opacity > 0.0f && record->opacity < 1.0f ? 1.0f - record->opacity : 0.0f;
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
