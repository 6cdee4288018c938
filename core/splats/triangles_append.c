/* Two sets of triangles made one. */

#include "core/base/base.h"
#include "core/splats/columns.h"

/* An attribute of the corners: so many arrays of n values, and which of them each corner has. */
typedef struct attribute {
  size_t n;
  float **values;
  int n_components;
  uint32_t (*corners)[3]; /* null: the vertices' */
} attribute;

/* The attribute that is joined from two. A set without it gives one value that means none. */
typedef struct attribute_joining {
  conic_context *context;
  const conic_triangles *first, *next;
  attribute of_first, of_next;
} attribute_joining;

static size_t values_of(const attribute *a) {
  return a->values[0] ? a->n : 1;
}

static conic_status join_values(const attribute_joining *j, float **to) {
  size_t n_first = values_of(&j->of_first), n_next = values_of(&j->of_next);
  for (int c = 0; c < j->of_first.n_components; c++) {
    to[c] = conic_memory_allocate(j->context, n_first + n_next, sizeof(float));
    if (!to[c])
      return CONIC_ERROR_MEMORY;
    to[c][0] = to[c][n_first] = 0.0f;
    if (j->of_first.values[0])
      memcpy(to[c], j->of_first.values[c], n_first * sizeof(float));
    if (j->of_next.values[0])
      memcpy(to[c] + n_first, j->of_next.values[c], n_next * sizeof(float));
  }
  return CONIC_OK;
}

static void join_corners(const conic_triangles *set, const attribute *a, size_t shift, uint32_t (*to)[3]) {
  const uint32_t(*from)[3] = (const uint32_t(*)[3])(a->corners ? a->corners : set->corners);
  for (size_t i = 0; i < set->count; i++)
    for (int k = 0; k < 3; k++)
      to[i][k] = (uint32_t)(shift + (a->values[0] ? from[i][k] : 0));
}

static conic_status join_attribute(const attribute_joining *j, size_t *n, float **values, uint32_t (**corners)[3]) {
  if (!j->of_first.values[0] && !j->of_next.values[0])
    return CONIC_OK;
  *corners = conic_memory_allocate(j->context, j->first->count + j->next->count, sizeof **corners);
  if (!*corners || join_values(j, values) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  *n = values_of(&j->of_first) + values_of(&j->of_next);
  join_corners(j->first, &j->of_first, 0, *corners);
  join_corners(j->next, &j->of_next, values_of(&j->of_first), *corners + j->first->count);
  return CONIC_OK;
}

static conic_status join_normals(attribute_joining *j, conic_triangles *a, conic_triangles *b,
                                 conic_triangles *joined) {
  j->of_first = (attribute){a->normal_corners ? a->n_normals : a->n_vertices, a->normal, 3, a->normal_corners};
  j->of_next = (attribute){b->normal_corners ? b->n_normals : b->n_vertices, b->normal, 3, b->normal_corners};
  return join_attribute(j, &joined->n_normals, joined->normal, &joined->normal_corners);
}

static conic_status join_coordinates(attribute_joining *j, conic_triangles *a, conic_triangles *b,
                                     conic_triangles *joined) {
  j->of_first = (attribute){a->texture_corners ? a->n_texture_coordinates : a->n_vertices, a->texture_coordinate, 2,
                            a->texture_corners};
  j->of_next = (attribute){b->texture_corners ? b->n_texture_coordinates : b->n_vertices, b->texture_coordinate, 2,
                           b->texture_corners};
  return join_attribute(j, &joined->n_texture_coordinates, joined->texture_coordinate, &joined->texture_corners);
}

/* How many materials a set has; one that is white where it names none. */
static size_t materials_of(const conic_triangles *set) {
  return set->n_materials ? set->n_materials : 1;
}

static conic_status join_materials(conic_context *context, const conic_triangles *a, const conic_triangles *b,
                                   conic_triangles *joined) {
  static const conic_material white = {.color = {1.0f, 1.0f, 1.0f}};
  if (!a->n_materials && !b->n_materials)
    return CONIC_OK;
  size_t n_first = materials_of(a), n = n_first + materials_of(b);
  if (conic_memory_allocate_these(context, CONIC_ROOM(joined->materials, n),
                                  CONIC_ROOM(joined->material, joined->count)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++) {
    const conic_triangles *set = i < n_first ? a : b;
    joined->materials[i] = set->n_materials ? set->materials[i < n_first ? i : i - n_first] : white;
  }
  joined->n_materials = n;
  for (size_t i = 0; i < joined->count; i++) {
    const conic_triangles *set = i < a->count ? a : b;
    size_t shift = i < a->count ? 0 : n_first, at = i < a->count ? i : i - a->count;
    joined->material[i] = (uint32_t)(shift + (set->n_materials && set->material ? set->material[at] : 0));
  }
  return CONIC_OK;
}

static void join_vertices(const conic_triangles *a, const conic_triangles *b, conic_triangles *joined) {
  for (int axis = 0; axis < 3; axis++) {
    double shift = b->origin[axis] - a->origin[axis];
    joined->origin[axis] = a->origin[axis];
    memcpy(joined->position[axis], a->position[axis], a->n_vertices * sizeof(float));
    for (size_t i = 0; i < b->n_vertices; i++) {
      float at = b->position[axis][i];
      joined->position[axis][a->n_vertices + i] = shift != 0.0 ? (float)((double)at + shift) : at;
    }
    for (size_t i = 0; joined->color[0] && i < joined->n_vertices; i++) {
      const conic_triangles *set = i < a->n_vertices ? a : b;
      joined->color[axis][i] = set->color[0] ? set->color[axis][i < a->n_vertices ? i : i - a->n_vertices] : 1.0f;
    }
  }
  joined->scalar_origin = a->scalar ? a->scalar_origin : b->scalar_origin;
  for (size_t i = 0; joined->scalar && i < joined->n_vertices; i++) {
    const conic_triangles *set = i < a->n_vertices ? a : b;
    float value = set->scalar ? set->scalar[i < a->n_vertices ? i : i - a->n_vertices] : NAN;
    double shift = set->scalar_origin - joined->scalar_origin;
    joined->scalar[i] = shift != 0.0 ? (float)((double)value + shift) : value;
  }
  for (size_t i = 0; joined->alpha && i < joined->n_vertices; i++) {
    const conic_triangles *set = i < a->n_vertices ? a : b;
    joined->alpha[i] = set->alpha ? set->alpha[i < a->n_vertices ? i : i - a->n_vertices] : 1.0f;
  }
  for (size_t i = 0; i < joined->count; i++) {
    const conic_triangles *set = i < a->count ? a : b;
    size_t shift = i < a->count ? 0 : a->n_vertices, at = i < a->count ? i : i - a->count;
    for (int k = 0; k < 3; k++)
      joined->corners[i][k] = (uint32_t)(shift + set->corners[at][k]);
    if (joined->cluster)
      joined->cluster[i] = set->cluster ? set->cluster[at] : 0;
  }
}

conic_status conic_triangles_append(conic_context *context, conic_triangles *triangles, conic_triangles *more) {
  conic_triangles joined;
  attribute_joining j = {.context = context, .first = triangles, .next = more};
  unsigned fields = (triangles->color[0] || more->color[0] ? (unsigned)CONIC_TRIANGLES_COLORS : 0u) |
                    (triangles->cluster || more->cluster ? (unsigned)CONIC_TRIANGLES_CLUSTERS : 0u) |
                    (triangles->scalar || more->scalar ? (unsigned)CONIC_TRIANGLES_SCALARS : 0u) |
                    (triangles->alpha || more->alpha ? (unsigned)CONIC_TRIANGLES_ALPHAS : 0u);
  conic_status status = conic_triangles_check_own(context, "append", triangles);
  if (status == CONIC_OK)
    status = conic_triangles_check_own(context, "append", more);
  if (status != CONIC_OK)
    return status;
  if (triangles->count == 0) {
    conic_triangles_release(context, triangles);
    *triangles = *more;
    memset(more, 0, sizeof *more);
    return CONIC_OK;
  }
  status = conic_triangles_allocate(context, triangles->count + more->count, triangles->n_vertices + more->n_vertices,
                                    fields, &joined);
  if (status != CONIC_OK)
    return status;
  join_vertices(triangles, more, &joined);
  status = join_normals(&j, triangles, more, &joined);
  if (status == CONIC_OK)
    status = join_coordinates(&j, triangles, more, &joined);
  if (status == CONIC_OK)
    status = join_materials(context, triangles, more, &joined);
  if (status != CONIC_OK) {
    joined.n_materials = 0; /* the textures are the two sets' still */
    conic_triangles_release(context, &joined);
    return status;
  }
  for (size_t i = 0; i < triangles->n_materials; i++)
    triangles->materials[i].texture = NULL;
  for (size_t i = 0; i < more->n_materials; i++)
    more->materials[i].texture = NULL;
  conic_triangles_release(context, triangles);
  *triangles = joined;
  return CONIC_OK;
}
