#include "conic/triangles.h"
#include "core/gltf/gltf_read.h"
#include "core/pictures/texture_file.h"

enum { REPEAT = 10497, CLAMP = 33071, MIRROR = 33648 };

/* A surface that has nothing but light of its own shows that, as the picture has it without lamps. */
static int is_dark(const conic_gltf_material *material) {
  return material->color[0] == 0.0 && material->color[1] == 0.0 && material->color[2] == 0.0 &&
         material->emission[0] + material->emission[1] + material->emission[2] > 0.0;
}

static int is_glossy(const conic_gltf_material *material) {
  return material->is_glossy && material->base.texture == CONIC_GLTF_NONE;
}

static const conic_gltf_texture_use *find_use(const conic_gltf_material *material) {
  return is_dark(material) ? &material->of_emission : is_glossy(material) ? &material->of_diffuse : &material->base;
}

const conic_gltf_texture_use *conic_gltf_color_texture(const conic_gltf *gltf, const conic_gltf_material *material) {
  return material && conic_gltf_at(gltf, CONIC_GLTF_TEXTURES, find_use(material)->texture) ? find_use(material) : NULL;
}

/* Both sides of a picture wrap alike here. */
static conic_texture_wrap find_wrap(const conic_gltf *gltf, const conic_gltf_texture *texture) {
  const conic_gltf_sampler *sampler = conic_gltf_at(gltf, CONIC_GLTF_SAMPLERS, texture->sampler);
  if (!sampler)
    return CONIC_WRAP_REPEAT;
  if (sampler->wrap[0] == MIRROR || sampler->wrap[1] == MIRROR)
    conic_gltf_warn(gltf, "a texture that is mirrored beyond its borders is repeated there");
  else if (sampler->wrap[0] != sampler->wrap[1])
    conic_gltf_warn(gltf, "a texture that is clamped on one side and repeated on the other is %s on both",
                    sampler->wrap[0] == CLAMP ? "clamped" : "repeated");
  return sampler->wrap[0] == CLAMP ? CONIC_WRAP_CLAMP : CONIC_WRAP_REPEAT;
}

static int is_ktx2(const unsigned char *bytes, size_t n) {
  return n >= 12 && memcmp(bytes, "\xABKTX 20\xBB", 8) == 0;
}

static conic_status read_image_bytes(conic_gltf *gltf, const unsigned char *bytes, size_t n, const char *name,
                                     conic_texture_wrap wrap, conic_texture **made) {
  if (!is_ktx2(bytes, n))
    return conic_texture_bytes_read(gltf->context, gltf->name, bytes, n, name, wrap, made);
  conic_gltf_warn(gltf, "the texture %s is left out: KTX2 (KHR_texture_basisu) is not read", name);
  return CONIC_OK;
}

static conic_status read_image_file(conic_gltf *gltf, const conic_gltf_image *image, conic_texture_wrap wrap,
                                    conic_texture **made) {
  char path[4096];
  conic_status status = conic_gltf_find_file(gltf, image->uri, 1, path, sizeof path);
  if (status == CONIC_OK && path[0])
    return conic_texture_file_read(gltf->context, gltf->name, path, path, wrap, made);
  if (status == CONIC_OK)
    conic_gltf_warn(gltf, "the texture %.*s is not there, and is left out",
                    image->uri.length < 200 ? (int)image->uri.length : 200, image->uri.bytes);
  return status;
}

static conic_status read_texture(conic_gltf *gltf, const conic_gltf_texture *texture, conic_texture **made) {
  const double number = texture->webp != CONIC_GLTF_NONE ? texture->webp : texture->image;
  const conic_gltf_image *image = conic_gltf_at(gltf, CONIC_GLTF_IMAGES, number);
  conic_gltf_bytes view = {NULL, 0, 0};
  unsigned char *own = NULL;
  char name[64];
  if (!image || (image->view == CONIC_GLTF_NONE && !image->uri.bytes)) {
    conic_gltf_warn(gltf, texture->basisu != CONIC_GLTF_NONE
                              ? "a texture is left out: KTX2 (KHR_texture_basisu) is not read"
                              : "a texture is left out: it has no picture");
    return CONIC_OK;
  }
  conic_texture_wrap wrap = find_wrap(gltf, texture);
  snprintf(name, sizeof name, "%g, in the file itself,", number);
  if (image->view != CONIC_GLTF_NONE) {
    conic_status status = conic_gltf_open_view(gltf, image->view, &view);
    return status == CONIC_OK ? read_image_bytes(gltf, view.bytes, view.n_bytes, name, wrap, made) : status;
  }
  conic_status status = conic_gltf_decode_uri(gltf, image->uri, &own, &view.n_bytes);
  if (status == CONIC_OK)
    status =
        own ? read_image_bytes(gltf, own, view.n_bytes, name, wrap, made) : read_image_file(gltf, image, wrap, made);
  conic_memory_release(gltf->context, own);
  return status;
}

static void find_alpha(const conic_gltf_material *from, double opacity, conic_material *material) {
  material->alpha_mode = strcmp(from->alpha_mode, "BLEND") == 0  ? CONIC_ALPHA_BLEND
                         : strcmp(from->alpha_mode, "MASK") == 0 ? CONIC_ALPHA_MASK
                                                                 : CONIC_ALPHA_OPAQUE;
  material->transparency = opacity >= 0.0 && opacity < 1.0 ? 1.0f - (float)opacity : 0.0f;
  material->alpha_cutoff = from->cutoff >= 0.0 ? (float)from->cutoff : 0.5f;
}

static conic_status make_material(conic_gltf_reader *reader, const conic_gltf_material *from) {
  conic_gltf *gltf = &reader->gltf;
  const conic_gltf_texture_use *use = conic_gltf_color_texture(gltf, from);
  const double *color = is_dark(from) ? from->emission : is_glossy(from) ? from->diffuse : from->color;
  conic_material material = {.texture = NULL};
  for (int channel = 0; channel < 3; channel++)
    material.color[channel] = color[channel] >= 0.0 && color[channel] <= 1e6 ? (float)color[channel] : 1.0f;
  find_alpha(from, is_glossy(from) ? from->diffuse[3] : from->color[3], &material);
  if (!is_dark(from) && (from->emission[0] > 0.0 || from->emission[1] > 0.0 || from->emission[2] > 0.0))
    conic_gltf_warn(gltf, "the light that a material emits beside its colour is not drawn");
  conic_status status = CONIC_OK;
  if (use)
    status = read_texture(gltf, conic_gltf_at(gltf, CONIC_GLTF_TEXTURES, use->texture), &material.texture);
  if (status == CONIC_OK)
    status = conic_faces_add_material(gltf->context, reader->parts.faces, &material);
  if (status != CONIC_OK)
    conic_texture_destroy(material.texture);
  return status;
}

conic_status conic_gltf_use_material(conic_gltf_reader *reader, double number) {
  conic_gltf *gltf = &reader->gltf;
  conic_faces *faces = reader->parts.faces;
  const conic_gltf_material *material = conic_gltf_at(gltf, CONIC_GLTF_MATERIALS, number);
  if (!material && number != CONIC_GLTF_NONE)
    return conic_gltf_wrong(gltf, "a primitive's material is not there");
  uint32_t *made = &reader->made[material ? (size_t)number : gltf->lists[CONIC_GLTF_MATERIALS].n];
  conic_status status = CONIC_OK;
  if (*made == UINT32_MAX) {
    if (faces->n_made == CONIC_MAX_MATERIALS)
      return conic_gltf_wrong(gltf, "there are too many materials");
    *made = (uint32_t)faces->n_made;
    status = make_material(reader, material ? material : &conic_gltf_no_material);
  }
  faces->current_material = *made;
  return status;
}
