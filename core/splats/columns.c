#include "core/splats/columns.h"

#include "core/base/base.h"

enum { TRIANGLES_COLUMNS = 12 };

/* NOLINTNEXTLINE(readability-non-const-parameter): who has the list may set it */
static int list_components(conic_column *columns, float **components, int n, size_t *stride, size_t count,
                           unsigned field) {
  for (int i = 0; i < n; i++)
    columns[i] = (conic_column){&components[i], stride, count, field};
  return n;
}

void conic_splats_list_columns(conic_splats *s, conic_column columns[CONIC_SPLATS_COLUMNS]) {
  columns += list_components(columns, s->position, 3, &s->strides.position, s->count, 0);
  columns += list_components(columns, s->tangent_u, 3, &s->strides.tangent_u, s->count, CONIC_SPLATS_TANGENTS);
  columns += list_components(columns, s->tangent_v, 3, &s->strides.tangent_v, s->count, CONIC_SPLATS_TANGENTS);
  columns += list_components(columns, s->normal, 3, &s->strides.normal, s->count, CONIC_SPLATS_NORMALS);
  columns += list_components(columns, s->color, 3, &s->strides.color, s->count, CONIC_SPLATS_COLORS);
  columns += list_components(columns, &s->opacity, 1, &s->strides.opacity, s->count, CONIC_SPLATS_OPACITIES);
  columns += list_components(columns, &s->dot, 1, &s->strides.dot, s->count, CONIC_SPLATS_DOTS);
  columns += list_components(columns, &s->scalar, 1, &s->strides.scalar, s->count, CONIC_SPLATS_SCALARS);
  list_components(columns, s->sight, 3, &s->strides.sight, s->count, CONIC_SPLATS_SIGHTS);
}

static void list_triangles_columns(conic_triangles *t, conic_column columns[TRIANGLES_COLUMNS]) {
  size_t n_coordinates = t->texture_corners ? t->n_texture_coordinates : t->n_vertices;
  columns += list_components(columns, t->position, 3, &t->strides.position, t->n_vertices, 0);
  columns += list_components(columns, t->color, 3, &t->strides.color, t->n_vertices, 0);
  columns +=
      list_components(columns, t->normal, 3, &t->strides.normal, t->normal_corners ? t->n_normals : t->n_vertices, 0);
  columns += list_components(columns, t->texture_coordinate, 2, &t->strides.texture_coordinate, n_coordinates, 0);
  list_components(columns, &t->scalar, 1, &t->strides.scalar, t->n_vertices, 0);
}

/* Components of an array are there together, and so are both axes. */
static const char *fault_of(const conic_column *columns, int n) {
  for (int i = 0; i < n; i++) {
    if (*columns[i].stride % sizeof(float))
      return "a stride is no multiple of a float's size";
    if (i &&
        (columns[i].stride == columns[i - 1].stride ||
         (columns[i].field && columns[i].field == columns[i - 1].field)) &&
        !*columns[i].floats != !*columns[i - 1].floats)
      return "an array lacks a component, or one axis the other";
  }
  return NULL;
}

static int is_strided(const conic_column *column) {
  return *column->floats && *column->stride && *column->stride != sizeof(float);
}

static int has_strides(const conic_column *columns, int n) {
  for (int i = 0; i < n; i++)
    if (is_strided(&columns[i]))
      return 1;
  return 0;
}

static conic_status fault_status(conic_context *context, const char *who, const char *what, const char *fault) {
  return fault ? conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the %s: %s", who, what, fault) : CONIC_OK;
}

const char *conic_splats_fault(const conic_splats *given) {
  conic_column columns[CONIC_SPLATS_COLUMNS];
  if (!given)
    return "there are none";
  conic_splats splats = *given;
  conic_splats_list_columns(&splats, columns);
  if (!conic_is_zero(given->reserved, sizeof given->reserved))
    return "reserved words are not zero";
  if (given->count && !given->position[0])
    return "there are no positions";
  return given->n_clips && !given->clips ? "there are no clip lines" : fault_of(columns, CONIC_SPLATS_COLUMNS);
}

conic_status conic_splats_check(conic_context *context, const char *who, const conic_splats *splats) {
  return fault_status(context, who, "splats", conic_splats_fault(splats));
}

const char *conic_triangles_fault(const conic_triangles *given) {
  conic_column columns[TRIANGLES_COLUMNS];
  if (!given)
    return "there are none";
  conic_triangles triangles = *given;
  list_triangles_columns(&triangles, columns);
  if (!conic_is_zero(given->reserved, sizeof given->reserved))
    return "reserved words are not zero";
  if (given->count && (!given->corners || !given->position[0]))
    return "there are no corners or positions";
  for (size_t i = 0; given->materials && i < given->n_materials; i++) {
    const conic_material *material = &given->materials[i];
    if (material->reserved_word || !conic_is_zero(material->reserved, sizeof material->reserved))
      return "a material's reserved words are not zero";
    if (material->alpha_mode > CONIC_ALPHA_OPAQUE ||
        !(material->transparency >= 0.0f && material->transparency <= 1.0f))
      return "a material's alpha mode is unknown, or its transparency is not within 0 and 1";
  }
  return given->n_materials && !given->materials ? "there are no materials" : fault_of(columns, TRIANGLES_COLUMNS);
}

static const char strides_fault[] = "sets that are changed or taken over have no strides";

conic_status conic_splats_check_own(conic_context *context, const char *who, const conic_splats *splats) {
  conic_column columns[CONIC_SPLATS_COLUMNS];
  conic_status status = conic_splats_check(context, who, splats);
  if (status != CONIC_OK)
    return status;
  conic_splats copy = *splats;
  conic_splats_list_columns(&copy, columns);
  return fault_status(context, who, "splats", has_strides(columns, CONIC_SPLATS_COLUMNS) ? strides_fault : NULL);
}

conic_status conic_triangles_check_own(conic_context *context, const char *who, const conic_triangles *triangles) {
  conic_column columns[TRIANGLES_COLUMNS];
  conic_status status = fault_status(context, who, "triangles", conic_triangles_fault(triangles));
  if (status != CONIC_OK)
    return status;
  conic_triangles copy = *triangles;
  list_triangles_columns(&copy, columns);
  return fault_status(context, who, "triangles", has_strides(columns, TRIANGLES_COLUMNS) ? strides_fault : NULL);
}

/* Replaces strided columns by copies, all in one block. */
static conic_status gather_columns(conic_context *context, const conic_column *columns, int n, float **block) {
  size_t n_floats = 0;
  for (int i = 0; i < n; i++)
    n_floats += is_strided(&columns[i]) ? columns[i].count : 0;
  if (n_floats == 0)
    return CONIC_OK;
  float *to = *block = conic_memory_allocate(context, n_floats, sizeof **block);
  if (!to)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < n; i++) {
    if (!is_strided(&columns[i]))
      continue;
    for (size_t k = 0; k < columns[i].count; k++)
      to[k] = conic_column_at(*columns[i].floats, *columns[i].stride, k);
    *columns[i].floats = to;
    to += columns[i].count;
  }
  return CONIC_OK;
}

conic_status conic_splats_enter(conic_context *context, const char *who, const conic_splats *given, conic_splats *close,
                                float **block) {
  conic_column columns[CONIC_SPLATS_COLUMNS];
  *block = NULL;
  conic_status status = conic_splats_check(context, who, given);
  if (status != CONIC_OK)
    return status;
  *close = *given;
  conic_splats_list_columns(close, columns);
  status = gather_columns(context, columns, CONIC_SPLATS_COLUMNS, block);
  memset(&close->strides, 0, sizeof close->strides);
  return status;
}

static conic_status triangles_enter(conic_context *context, const char *who, const conic_triangles *given,
                                    conic_triangles *close, float **block) {
  conic_column columns[TRIANGLES_COLUMNS];
  *block = NULL;
  conic_status status = conic_triangles_check(context, given, who);
  if (status != CONIC_OK)
    return status;
  *close = *given;
  list_triangles_columns(close, columns);
  status = gather_columns(context, columns, TRIANGLES_COLUMNS, block);
  memset(&close->strides, 0, sizeof close->strides);
  return status;
}

conic_status conic_drawing_enter(conic_context *context, const char *who, const conic_drawing *given,
                                 conic_entered_drawing *entered) {
  conic_status status = CONIC_OK;
  memset(entered, 0, sizeof *entered);
  if (!given || !conic_is_zero(given->reserved, sizeof given->reserved))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the drawing is null, or its reserved words are not zero",
                      who);
  if (given->splats)
    status = conic_splats_enter(context, who, given->splats, &entered->splats, &entered->blocks[0]);
  if (status == CONIC_OK && given->triangles)
    status = triangles_enter(context, who, given->triangles, &entered->triangles, &entered->blocks[1]);
  return status;
}

void conic_drawing_leave(conic_context *context, conic_entered_drawing *entered) {
  conic_memory_release_these(context, entered->blocks[0], entered->blocks[1]);
}
