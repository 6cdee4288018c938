#include "core/base/base.h"
#include "core/base/vectors.h"
#include "core/splats/columns.h"
#include "core/splats/near.h"
#include "core/splats/splats_gather.h"

static conic_status allocate_floats(conic_context *context, size_t count, float **arrays, int n) {
  for (int i = 0; i < n; i++) {
    arrays[i] = conic_memory_allocate(context, count, sizeof(float));
    if (!arrays[i])
      return CONIC_ERROR_MEMORY;
  }
  return CONIC_OK;
}

conic_status conic_triangles_allocate(conic_context *context, size_t count, size_t n_vertices, unsigned fields,
                                      conic_triangles *triangles) {
  memset(triangles, 0, sizeof *triangles);
  conic_status status = allocate_floats(context, n_vertices, triangles->position, 3);
  if (status == CONIC_OK && (fields & CONIC_TRIANGLES_COLORS))
    status = allocate_floats(context, n_vertices, triangles->color, 3);
  if (status == CONIC_OK && (fields & CONIC_TRIANGLES_NORMALS))
    status = allocate_floats(context, n_vertices, triangles->normal, 3);
  if (status == CONIC_OK && (fields & CONIC_TRIANGLES_TEXTURE_COORDINATES))
    status = allocate_floats(context, n_vertices, triangles->texture_coordinate, 2);
  if (status == CONIC_OK && (fields & CONIC_TRIANGLES_SCALARS))
    status = allocate_floats(context, n_vertices, &triangles->scalar, 1);
  if (status == CONIC_OK && (fields & CONIC_TRIANGLES_ALPHAS))
    status = allocate_floats(context, n_vertices, &triangles->alpha, 1);
  if (status == CONIC_OK) {
    triangles->corners = conic_memory_allocate(context, count, sizeof *triangles->corners);
    if (fields & CONIC_TRIANGLES_CLUSTERS)
      triangles->cluster = conic_memory_allocate(context, count, sizeof *triangles->cluster);
    if (!triangles->corners || ((fields & CONIC_TRIANGLES_CLUSTERS) && !triangles->cluster))
      status = CONIC_ERROR_MEMORY;
  }
  if (status != CONIC_OK) {
    conic_triangles_release(context, triangles);
    return status;
  }
  triangles->count = count;
  triangles->n_vertices = n_vertices;
  triangles->n_normals = triangles->normal[0] ? n_vertices : 0;
  triangles->n_texture_coordinates = triangles->texture_coordinate[0] ? n_vertices : 0;
  return CONIC_OK;
}

void conic_triangles_release(conic_context *context, conic_triangles *triangles) {
  for (int i = 0; i < 3; i++)
    conic_memory_release_these(context, triangles->position[i], triangles->color[i], triangles->normal[i]);
  conic_memory_release_these(context, triangles->texture_coordinate[0], triangles->texture_coordinate[1],
                             triangles->corners, triangles->normal_corners, triangles->texture_corners);
  for (size_t i = 0; triangles->materials && i < triangles->n_materials; i++)
    conic_texture_destroy(triangles->materials[i].texture);
  conic_memory_release_these(context, triangles->materials, triangles->material, triangles->cluster, triangles->scalar,
                             triangles->alpha);
  memset(triangles, 0, sizeof *triangles);
}

/* Whether every index is below n. */
static int are_in_range(const uint32_t (*corners)[3], size_t count, size_t n) {
  uint32_t greatest = 0;
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 3; k++)
      greatest = corners[i][k] > greatest ? corners[i][k] : greatest;
  return count == 0 || greatest < n;
}

static const char *index_fault(const conic_triangles *t) {
  if (!are_in_range((const uint32_t(*)[3])t->corners, t->count, t->n_vertices))
    return "a triangle's vertex is out of range";
  if (t->normal[0] && t->normal_corners &&
      !are_in_range((const uint32_t(*)[3])t->normal_corners, t->count, t->n_normals))
    return "a corner's normal is out of range";
  if (t->texture_coordinate[0] && t->texture_corners &&
      !are_in_range((const uint32_t(*)[3])t->texture_corners, t->count, t->n_texture_coordinates))
    return "a corner's texture coordinate is out of range";
  for (size_t i = 0; t->n_materials && t->material && i < t->count; i++)
    if (t->material[i] >= t->n_materials)
      return "a triangle's material is out of range";
  return NULL;
}

conic_status conic_triangles_check(conic_context *context, const conic_triangles *triangles, const char *name) {
  const char *wrong = conic_triangles_fault(triangles);
  if (wrong)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the triangles: %s", name, wrong);
  wrong = index_fault(triangles);
  return wrong ? conic_fail(context, CONIC_ERROR_INPUT, "%s: %s", name, wrong) : CONIC_OK;
}

size_t conic_triangles_bounds(const conic_triangles *triangles, double minimum[3], double maximum[3]) {
  size_t n = conic_triangles_fault(triangles) ? 0 : 3 * triangles->count;
  return conic_points_bounds(triangles->position, triangles->strides.position, triangles->origin,
                             (const uint32_t *)triangles->corners, n, minimum, maximum);
}

size_t conic_drawing_bounds_by(conic_context *context, const conic_drawing *drawing, double minimum[3],
                               double maximum[3]) {
  double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
  size_t n_splats = drawing->splats ? conic_splats_bounds_by(context, drawing->splats, minimum, maximum) : 0;
  size_t n_corners = drawing->triangles ? conic_triangles_bounds(drawing->triangles, low, high) : 0;
  for (int axis = 0; axis < 3; axis++) {
    if (n_splats == 0 || (n_corners && low[axis] < minimum[axis]))
      minimum[axis] = low[axis];
    if (n_splats == 0 || (n_corners && high[axis] > maximum[axis]))
      maximum[axis] = high[axis];
  }
  return n_splats + n_corners;
}

size_t conic_drawing_bounds(const conic_drawing *drawing, double minimum[3], double maximum[3]) {
  return conic_drawing_bounds_by(NULL, drawing, minimum, maximum);
}

double conic_drawing_near(const conic_drawing *drawing) {
  double low[3], high[3];
  conic_drawing_bounds(drawing, low, high);
  return conic_near_of_box(low, high);
}

void conic_triangles_face_normal(const conic_triangles *t, size_t i, double normal[3]) {
  double side[2][3];
  const uint32_t *corner = t->corners[i];
  for (int k = 0; k < 2; k++)
    for (int axis = 0; axis < 3; axis++)
      side[k][axis] = (double)t->position[axis][corner[k + 1]] - (double)t->position[axis][corner[0]];
  conic_cross(side[0], side[1], normal);
}

static void store_unit(const double sum[3], float *const normal[3], size_t i) {
  double length = conic_length(sum);
  for (int axis = 0; axis < 3; axis++)
    normal[axis][i] = length > 0.0 ? (float)(sum[axis] / length) : 0.0f;
}

conic_status conic_triangles_smooth(conic_context *context, conic_triangles *triangles) {
  float *normal[3] = {NULL, NULL, NULL};
  conic_status status = conic_triangles_check(context, triangles, "smooth");
  if (status == CONIC_OK)
    status = conic_triangles_check_own(context, "smooth", triangles);
  if (status != CONIC_OK)
    return status;
  double(*sums)[3] = conic_memory_allocate_zeroed(context, triangles->n_vertices, sizeof *sums);
  status = sums ? allocate_floats(context, triangles->n_vertices, normal, 3) : CONIC_ERROR_MEMORY;
  for (size_t i = 0; status == CONIC_OK && i < triangles->count; i++) {
    double face[3];
    conic_triangles_face_normal(triangles, i, face);
    if (!(face[0] * 0.0 == 0.0 && face[1] * 0.0 == 0.0 && face[2] * 0.0 == 0.0))
      continue;
    for (int k = 0; k < 3; k++)
      for (int axis = 0; axis < 3; axis++)
        sums[triangles->corners[i][k]][axis] += face[axis];
  }
  for (size_t i = 0; status == CONIC_OK && i < triangles->n_vertices; i++)
    store_unit(sums[i], normal, i);
  conic_memory_release(context, sums);
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release(context, status == CONIC_OK ? triangles->normal[axis] : normal[axis]);
  if (status != CONIC_OK)
    return status;
  conic_memory_release(context, triangles->normal_corners);
  triangles->normal_corners = NULL;
  memcpy(triangles->normal, normal, sizeof normal);
  triangles->n_normals = triangles->n_vertices;
  return CONIC_OK;
}

conic_status conic_triangles_texture(conic_context *context, conic_triangles *triangles, conic_texture *texture) {
  conic_material *one = conic_memory_allocate_zeroed(context, 1, sizeof *one);
  if (!one)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; triangles->materials && i < triangles->n_materials; i++)
    conic_texture_destroy(triangles->materials[i].texture);
  conic_memory_release_these(context, triangles->materials, triangles->material);
  one->color[0] = one->color[1] = one->color[2] = 1.0f;
  one->texture = texture;
  triangles->materials = one;
  triangles->n_materials = 1;
  triangles->material = NULL;
  return CONIC_OK;
}
