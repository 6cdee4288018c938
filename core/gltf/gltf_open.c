#include "core/gltf/gltf.h"

#include <stdarg.h>

#include "core/base/byte_order.h"
#include "core/gltf/draco.h"

enum { GLB_HEADER = 12, CHUNK_HEADER = 8 };

static void put_message(const conic_gltf *gltf, char text[1024], const char *format, va_list arguments) {
  int n = snprintf(text, 1024, "%.512s: ", gltf->name);
  vsnprintf(text + n, 1024 - (size_t)n, format, arguments);
}

conic_status(conic_gltf_wrong)(const conic_gltf *gltf, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  put_message(gltf, text, format, arguments);
  va_end(arguments);
  int has_place = strstr(text, " (at byte ") || strstr(text, " (line ");
  return conic_fail(gltf->context, CONIC_ERROR_INPUT, "%s%s", text, has_place ? "" : " (at byte 0)");
}

void conic_gltf_warn(const conic_gltf *gltf, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  put_message(gltf, text, format, arguments);
  va_end(arguments);
  conic_log(gltf->context, CONIC_LOG_WARNING, "%s", text);
}

/* The chunk at *at, which goes on to the next one; of no bytes where there is none of that name. */
static conic_status take_chunk(const conic_gltf *gltf, const unsigned char *bytes, size_t n_bytes, const char *name,
                               size_t *at, conic_gltf_bytes *chunk) {
  *chunk = (conic_gltf_bytes){NULL, 0, 0};
  if (n_bytes - *at < CHUNK_HEADER || memcmp(bytes + *at + 4, name, 4) != 0)
    return CONIC_OK;
  const size_t n = conic_load_32(bytes + *at), from = *at + CHUNK_HEADER;
  if (n > n_bytes - from)
    return conic_gltf_wrong(gltf, "the file is cut off: a part of it should have %zu bytes, and has %zu (at byte %zu)",
                            n, n_bytes - from, *at);
  *chunk = (conic_gltf_bytes){bytes + from, n, 0};
  *at = from + (n + 3) / 4 * 4 < n_bytes ? from + (n + 3) / 4 * 4 : n_bytes;
  return CONIC_OK;
}

conic_status conic_gltf_open(conic_context *context, const char *name, const char *path, const unsigned char *bytes,
                             size_t n_bytes, conic_gltf *gltf) {
  conic_gltf_bytes json = {bytes, n_bytes, 0}, binary = {NULL, 0, 0};
  size_t at = GLB_HEADER, mark = n_bytes >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
  conic_status status = CONIC_OK;
  *gltf = (conic_gltf){.context = context, .name = name, .path = path};
  if (n_bytes >= 4 && memcmp(bytes, "glTF", 4) == 0) {
    if (n_bytes < GLB_HEADER || conic_load_32(bytes + 4) != 2)
      return conic_gltf_wrong(gltf, "this is no GLB of version 2, which alone is read (at byte 4)");
    status = take_chunk(gltf, bytes, n_bytes, "JSON", &at, &json);
    if (status == CONIC_OK && !json.bytes)
      status = conic_gltf_wrong(gltf, "the GLB does not begin with its JSON (at byte 12)");
    if (status == CONIC_OK)
      status = take_chunk(gltf, bytes, n_bytes, "BIN\0", &at, &binary);
    mark = 0;
  }
  if (status != CONIC_OK)
    return status;
  gltf->binary = binary.bytes;
  gltf->n_binary = binary.n_bytes;
  status = conic_json_take(context, name, json.bytes + mark, json.n_bytes - mark, &gltf->json);
  if (status == CONIC_OK)
    status = conic_gltf_read_json(gltf);
  if (status == CONIC_OK && !gltf->is_tileset && gltf->version[0] && strncmp(gltf->version, "2.", 2) != 0)
    return conic_gltf_wrong(gltf, "this is glTF %s: version 2 is read", gltf->version);
  if (status == CONIC_OK && gltf->least_version[0] && strcmp(gltf->least_version, "2.0") != 0)
    return conic_gltf_wrong(gltf, "a reader of glTF %s is needed, and this one is of 2.0", gltf->least_version);
  return status;
}

void conic_gltf_close(conic_gltf *gltf) {
  const conic_gltf_list *buffers = &gltf->lists[CONIC_GLTF_BUFFERS], *views = &gltf->lists[CONIC_GLTF_VIEWS];
  for (size_t i = 0; i < buffers->n; i++) {
    conic_gltf_buffer *buffer = (conic_gltf_buffer *)buffers->items + i;
    conic_memory_release(gltf->context, buffer->own);
    conic_mapping_close(gltf->context, &buffer->mapping);
  }
  for (size_t i = 0; i < views->n; i++)
    conic_memory_release(gltf->context, ((conic_gltf_view *)views->items)[i].own);
  for (int i = 0; i < CONIC_GLTF_N_LISTS; i++)
    conic_memory_release(gltf->context, gltf->lists[i].items);
  if (gltf->json.text)
    conic_json_close(&gltf->json);
}

/* --- extensions --- */

/* Those that are read, those that change nothing that is drawn, and those that are of another subject. */
static const char known[] =
    " KHR_mesh_quantization KHR_texture_transform EXT_texture_webp EXT_mesh_gpu_instancing KHR_node_visibility "
    "KHR_materials_pbrSpecularGlossiness KHR_gaussian_splatting KHR_gaussian_splatting_compression_spz "
    "KHR_gaussian_splatting_compression_spz_2 KHR_spz_gaussian_splats_compression KHR_materials_unlit "
    "KHR_materials_anisotropy KHR_materials_clearcoat KHR_materials_diffuse_transmission KHR_materials_dispersion "
    "KHR_materials_emissive_strength KHR_materials_ior KHR_materials_iridescence KHR_materials_sheen "
    "KHR_materials_specular KHR_materials_transmission KHR_materials_variants KHR_materials_volume KHR_lights_punctual "
    "KHR_animation_pointer KHR_xmp_json_ld EXT_lights_image_based EXT_mesh_features EXT_structural_metadata ";

static int is_known(const char *name) {
  char word[80];
  snprintf(word, sizeof word, " %s ", name);
  return strstr(known, word) != NULL;
}

/* Why one of those cannot be read that a library unpacks; null: it can. */
static const char *why_not(const char *name) {
  if (strcmp(name, "KHR_draco_mesh_compression") == 0)
    return conic_draco_is_there() ? NULL : "libdraco, which this build is without, would read it";
  if (strcmp(name, "EXT_meshopt_compression") == 0)
    return conic_gltf_can_unpack() ? NULL : "libmeshoptimizer, which this build is without, would read it";
  if (strcmp(name, "KHR_texture_basisu") == 0)
    return "pictures in KTX2 are not read; gltf-transform ktxdecompress makes PNG of them";
  return is_known(name) ? NULL : "it is not known";
}

conic_status conic_gltf_check_extensions(const conic_gltf *gltf) {
  const conic_gltf_list *used = &gltf->lists[CONIC_GLTF_USED], *required = &gltf->lists[CONIC_GLTF_REQUIRED];
  if (gltf->is_tileset && gltf->lists[CONIC_GLTF_MESHES].n == 0)
    return conic_gltf_wrong(gltf, "this is a tileset of 3D Tiles; give one of the .glb files that it names");
  for (size_t i = 0; i < required->n; i++) {
    const char *name = conic_gltf_at(gltf, CONIC_GLTF_REQUIRED, (double)i), *why = why_not(name);
    if (why)
      return conic_gltf_wrong(gltf, "the file needs the extension %s: %s", name, why);
  }
  for (size_t i = 0; i < used->n; i++) {
    const char *name = conic_gltf_at(gltf, CONIC_GLTF_USED, (double)i), *why = why_not(name);
    if (why)
      conic_gltf_warn(gltf, "the extension %s is left out: %s", name, why);
  }
  return CONIC_OK;
}
