#include "core/splats/face_colors.h"

#include "conic/triangles.h"
#include "core/base/color.h"
#include "core/splats/faces.h"
#include "core/splats/raw_colors.h"

/* Half of the table's places are used at most; further colours get the material of the last one. */
enum { MOST_BITS = 17, MOST_COLORS = 1 << (MOST_BITS - 1) };

conic_status conic_face_colors_take(conic_context *context, conic_face_colors *colors, const conic_model *model,
                                    size_t first, const double raw[3]) {
  conic_splats *to = &colors->raw;
  size_t room = colors->room;
  for (int channel = 0; channel < 3; channel++) {
    room = colors->room;
    if (conic_memory_reserve(context, &to->color[channel], to->count, model->n_triangles, &room, sizeof(float)) !=
        CONIC_OK)
      return CONIC_ERROR_MEMORY;
    for (size_t i = to->count; i < model->n_triangles; i++)
      to->color[channel][i] = i < first ? NAN : (float)raw[channel];
  }
  colors->room = room;
  to->count = model->n_triangles;
  return CONIC_OK;
}

static uint32_t code_of(const float linear[3]) {
  uint32_t code = 0;
  for (int channel = 0; channel < 3; channel++)
    code = code << 8 | (uint32_t)(conic_srgb_encode(fmin(1.0, fmax(0.0, (double)linear[channel]))) * 255.0 + 0.5);
  return code;
}

/* The material of a colour. A place of the table holds a code and 1, and a material; 0: nothing. */
static conic_status find_material(conic_context *context, uint32_t *table, unsigned bits, conic_faces *faces,
                                  const float linear[3], uint32_t *found) {
  const uint32_t code = code_of(linear) + 1;
  size_t place = (code * UINT32_C(2654435761)) >> (32 - bits);
  while (table[2 * place] && table[2 * place] != code)
    place = (place + 1) & ((UINT32_C(1) << bits) - 1);
  if (!table[2 * place] && faces->n_made < MOST_COLORS) {
    const conic_material material = {.color = {linear[0], linear[1], linear[2]}};
    table[2 * place] = code;
    table[2 * place + 1] = (uint32_t)faces->n_made;
    conic_status status = conic_faces_add_material(context, faces, &material);
    if (status != CONIC_OK)
      return status;
  }
  *found = table[2 * place] ? table[2 * place + 1] : MOST_COLORS - 1;
  return CONIC_OK;
}

/* The colour of triangle i. Where all numbers were 0 there is no array: that is black by any scale. */
static void color_at(const conic_face_colors *colors, size_t i, float linear[3]) {
  int is_there = i < colors->raw.count;
  for (int channel = 0; channel < 3 && is_there; channel++) {
    linear[channel] = colors->raw.color[channel] ? colors->raw.color[channel][i] : 0.0f;
    is_there = linear[channel] - linear[channel] == 0.0f;
  }
  for (int channel = 0; channel < 3 && !is_there; channel++)
    linear[channel] = 1.0f;
}

static conic_status give_to_faces(conic_context *context, const conic_face_colors *colors, const conic_model *model) {
  conic_faces *faces = model->faces;
  unsigned bits = 4;
  while (bits < MOST_BITS && (size_t)1 << bits < 2 * model->n_triangles)
    bits++;
  uint32_t *table = conic_memory_allocate_zeroed(context, (size_t)2 << bits, sizeof *table);
  conic_status status = table ? CONIC_OK : CONIC_ERROR_MEMORY;
  while (status == CONIC_OK && faces->count < model->n_triangles)
    status = conic_faces_add(context, faces, NULL, NULL);
  for (size_t i = 0; i < faces->count && status == CONIC_OK; i++) {
    float linear[3];
    color_at(colors, i, linear);
    status = find_material(context, table, bits, faces, linear, &faces->material[i]);
  }
  faces->current_material = (uint32_t)faces->n_made; /* further ones are white */
  conic_memory_release(context, table);
  return status;
}

static conic_status give_to_vertices(conic_builder *builder, const conic_face_colors *colors) {
  const conic_model *model = builder->model;
  const conic_splats *points = &model->points;
  float(*sums)[4] = conic_memory_allocate_zeroed(builder->context, points->count, sizeof *sums);
  conic_status status = sums ? conic_builder_add_field(builder, CONIC_SPLATS_COLORS) : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < 3 * model->n_triangles && sums; i++) {
    float linear[3], *sum = sums[model->triangles[i / 3][i % 3]];
    color_at(colors, i / 3, linear);
    for (int channel = 0; channel < 3; channel++)
      sum[channel] += linear[channel];
    sum[3] += 1.0f;
  }
  for (size_t i = 0; status == CONIC_OK && i < points->count; i++)
    for (int channel = 0; channel < 3; channel++)
      points->color[channel][i] = sums[i][3] > 0.0f ? sums[i][channel] / sums[i][3] : 1.0f;
  conic_memory_release(builder->context, sums);
  return status;
}

conic_status conic_face_colors_finish(conic_builder *builder, conic_face_colors *colors, unsigned kind, int keeps_faces,
                                      conic_status status) {
  conic_context *context = builder->context;
  conic_model *model = builder->model;
  if (status == CONIC_OK && colors->raw.count > 0) {
    status = conic_raw_colors_decode(context, &colors->raw, kind, &model->colors_are);
    if (status == CONIC_OK && keeps_faces && !model->faces)
      status = conic_faces_create(context, &model->faces);
    if (status == CONIC_OK)
      status = model->faces ? give_to_faces(context, colors, model) : give_to_vertices(builder, colors);
  }
  conic_memory_release_these(context, colors->raw.color[0], colors->raw.color[1], colors->raw.color[2]);
  while (status == CONIC_OK && model->faces && model->faces->n_made && model->faces->count < model->n_triangles)
    status = conic_faces_add(context, model->faces, NULL, NULL);
  *colors = (conic_face_colors){.room = 0};
  return status;
}
