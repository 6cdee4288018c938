#include "lod/hybrid/model/hybrid_layout.h"

#include "core/base/color.h"
#include "core/image/texture_levels.h"

/* The records are in the file as they are in memory, but for the order of the bytes within their members. */
_Static_assert(sizeof(conic_hybrid_level) == 52, "levels of 52 bytes");
_Static_assert(sizeof(conic_hybrid_cluster) == 64, "clusters of 64 bytes");
_Static_assert(sizeof(conic_hybrid_node) == 80, "nodes of 80 bytes");
_Static_assert(sizeof(conic_chy_material) == 32, "materials of 32 bytes");
_Static_assert((int)CONIC_CHY_N_ARRAYS <= (int)CONIC_FILE_MOST_ARRAYS, "a layout holds all arrays");

conic_file_layout conic_chy_lay_out(const conic_hybrid *h) {
  conic_file_layout l = {.n_bytes = CONIC_FILE_HEADER_BYTES};
  size_t sizes[CONIC_CHY_N_ARRAYS] = {0};
  sizes[CONIC_CHY_NODES] = (size_t)h->n_nodes * sizeof(conic_hybrid_node);
  sizes[CONIC_CHY_CLUSTERS] = (size_t)h->n_clusters * sizeof(conic_hybrid_cluster);
  sizes[CONIC_CHY_LEVELS] = (size_t)h->n_levels * sizeof(conic_hybrid_level);
  sizes[CONIC_CHY_MATERIAL_LIST] = (size_t)h->n_materials * sizeof(conic_chy_material);
  sizes[CONIC_CHY_TEXELS] = (size_t)h->n_texels * 3;
  for (int i = 0; i < CONIC_CHY_N_ARRAYS; i++)
    conic_file_add_array(&l, sizes[i], i == CONIC_CHY_TEXELS ? "1" : i == CONIC_CHY_MATERIAL_LIST ? "4444448" : "4");
  return l;
}

/* Null for an array that is not there. */
static const void *array_in_layout(const conic_file_layout *l, const unsigned char *bytes, int i) {
  return l->arrays[i].n_bytes ? bytes + l->arrays[i].offset : NULL;
}

void conic_chy_attach(unsigned char *bytes, conic_hybrid *hybrid) {
  conic_file_layout l = conic_chy_lay_out(hybrid);
  hybrid->nodes = array_in_layout(&l, bytes, CONIC_CHY_NODES);
  hybrid->clusters = array_in_layout(&l, bytes, CONIC_CHY_CLUSTERS);
  hybrid->levels = array_in_layout(&l, bytes, CONIC_CHY_LEVELS);
  hybrid->material_list = array_in_layout(&l, bytes, CONIC_CHY_MATERIAL_LIST);
  hybrid->texels = array_in_layout(&l, bytes, CONIC_CHY_TEXELS);
}

static conic_status make_texture(conic_hybrid *hybrid, const conic_chy_material *from, conic_texture **texture) {
  conic_image image;
  float linear[256];
  conic_status status =
      conic_image_allocate(hybrid->context, (int)from->width, (int)from->height, 1u << CONIC_PLANE_RGBA, &image);
  if (status != CONIC_OK)
    return status;
  conic_srgb_decode_table(linear);
  float *rgba = image.planes[CONIC_PLANE_RGBA];
  const unsigned char *codes = hybrid->texels + 3 * (size_t)from->first_texel;
  for (size_t i = 0; i < (size_t)from->width * from->height; i++) {
    for (size_t channel = 0; channel < 3; channel++)
      rgba[4 * i + channel] = linear[codes[3 * i + channel]];
    rgba[4 * i + 3] = 1.0f;
  }
  return conic_texture_take(hybrid->context, &image, (conic_texture_wrap)from->wrap, texture);
}

conic_status conic_chy_make_materials(conic_hybrid *hybrid) {
  conic_status status = CONIC_OK;
  if (hybrid->n_materials == 0)
    return CONIC_OK;
  hybrid->materials = conic_memory_allocate_zeroed(hybrid->context, hybrid->n_materials, sizeof *hybrid->materials);
  if (!hybrid->materials)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < hybrid->n_materials && status == CONIC_OK; i++) {
    const conic_chy_material *from = &hybrid->material_list[i];
    memcpy(hybrid->materials[i].color, from->color, sizeof from->color);
    if (from->width)
      status = make_texture(hybrid, from, &hybrid->materials[i].texture);
  }
  return status;
}
