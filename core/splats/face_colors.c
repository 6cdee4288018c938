#include "core/splats/face_colors.h"

#include "conic/triangles.h"
#include "core/base/color.h"
#include "core/splats/faces.h"

/* Half of the table's places are used at most; further colours get the material of the last one. */
enum { TABLE_BITS = 17, TABLE_SIZE = 1 << TABLE_BITS, MOST_COLORS = TABLE_SIZE / 2 };

static uint32_t code_of(const double linear[3]) {
  uint32_t code = 0;
  for (int channel = 0; channel < 3; channel++)
    code = code << 8 | (uint32_t)(conic_srgb_encode(fmin(1.0, fmax(0.0, linear[channel]))) * 255.0 + 0.5);
  return code;
}

/* The material of a colour. A place of the table holds a code and 1, and a material; 0: nothing. */
static conic_status find_material(conic_context *context, conic_face_colors *colors, conic_faces *faces,
                                  const double linear[3]) {
  if (!colors->table)
    colors->table = conic_memory_allocate_zeroed(context, (size_t)2 * TABLE_SIZE, sizeof *colors->table);
  if (!colors->table)
    return CONIC_ERROR_MEMORY;
  const uint32_t code = code_of(linear) + 1;
  uint32_t place = (code * UINT32_C(2654435761)) >> (32 - TABLE_BITS);
  while (colors->table[2 * place] && colors->table[2 * place] != code)
    place = (place + 1) % TABLE_SIZE;
  if (!colors->table[2 * place] && faces->n_made < MOST_COLORS) {
    const conic_material material = {.color = {(float)linear[0], (float)linear[1], (float)linear[2]}};
    colors->table[2 * place] = code;
    colors->table[2 * place + 1] = (uint32_t)faces->n_made;
    conic_status status = conic_faces_add_material(context, faces, &material);
    if (status != CONIC_OK)
      return status;
  }
  faces->current_material = colors->table[2 * place] ? colors->table[2 * place + 1] : MOST_COLORS - 1;
  return CONIC_OK;
}

static conic_status add_to_vertices(conic_context *context, conic_face_colors *colors, const conic_model *model,
                                    size_t first, const double linear[3]) {
  const size_t n_before = colors->n_sums;
  if (conic_memory_reserve(context, &colors->sums, n_before, model->points.count, &colors->n_sums,
                           sizeof *colors->sums) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  if (colors->n_sums > n_before)
    memset(colors->sums + n_before, 0, (colors->n_sums - n_before) * sizeof *colors->sums);
  for (size_t i = 3 * first; i < 3 * model->n_triangles; i++) {
    float *sum = colors->sums[model->triangles[i / 3][i % 3]];
    for (int channel = 0; channel < 3; channel++)
      sum[channel] += (float)linear[channel];
    sum[3] += 1.0f;
  }
  return CONIC_OK;
}

conic_status conic_face_colors_take(conic_context *context, conic_face_colors *colors, conic_model *model, size_t first,
                                    const double linear[3]) {
  return model->faces ? find_material(context, colors, model->faces, linear)
                      : add_to_vertices(context, colors, model, first, linear);
}

conic_status conic_face_colors_finish(conic_builder *builder, conic_face_colors *colors, conic_status status) {
  conic_splats *points = &builder->model->points;
  if (status == CONIC_OK && colors->sums)
    status = conic_builder_add_field(builder, CONIC_SPLATS_COLORS);
  for (size_t i = 0; status == CONIC_OK && colors->sums && i < points->count; i++)
    for (int channel = 0; channel < 3; channel++)
      points->color[channel][i] =
          i < colors->n_sums && colors->sums[i][3] > 0.0f ? colors->sums[i][channel] / colors->sums[i][3] : 1.0f;
  conic_memory_release_these(builder->context, colors->table, colors->sums);
  *colors = (conic_face_colors){NULL, NULL, 0};
  return status;
}
