#include "core/estimate/incidence.h"

#include "core/base/base.h"

static conic_status check_triangles(conic_context *context, const conic_model *model, size_t most) {
  if (model->n_triangles > most)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%zu triangles are too many", model->n_triangles);
  for (size_t i = 0; i < model->n_triangles; i++)
    for (int j = 0; j < 3; j++)
      if (model->triangles[i][j] >= model->points.count)
        return conic_fail(context, CONIC_ERROR_ARGUMENT, "triangle %zu has the vertex %zu, but there are only %zu", i,
                          (size_t)model->triangles[i][j], model->points.count);
  return CONIC_OK;
}

/* A counting sort of the triangles' corners by vertex. While it runs, starts[i + 1] is where the next corner of vertex
 * i goes. */
static void sort_corners(const conic_model *model, conic_incidence *incidence) {
  size_t *starts = incidence->starts;
  for (size_t i = 0; i < model->n_triangles; i++)
    for (int j = 0; j < 3; j++)
      starts[model->triangles[i][j] + 2]++;
  for (size_t vertex = 0; vertex < model->points.count; vertex++)
    starts[vertex + 2] += starts[vertex + 1];
  for (size_t i = 0; i < model->n_triangles; i++)
    for (int j = 0; j < 3; j++)
      incidence->triangles[starts[model->triangles[i][j] + 1]++] = (uint32_t)i;
}

conic_status conic_incidence_create(conic_context *context, const conic_model *model, size_t most,
                                    conic_incidence *incidence) {
  memset(incidence, 0, sizeof *incidence);
  conic_status status = check_triangles(context, model, most);
  if (status != CONIC_OK)
    return status;
  if (conic_memory_allocate_these(context, CONIC_ZEROED(incidence->starts, model->points.count + 2),
                                  CONIC_ROOM(incidence->triangles, 3 * model->n_triangles)) != CONIC_OK) {
    conic_incidence_release(context, incidence);
    return CONIC_ERROR_MEMORY;
  }
  sort_corners(model, incidence);
  return CONIC_OK;
}

void conic_incidence_release(conic_context *context, conic_incidence *incidence) {
  conic_memory_release_these(context, incidence->starts, incidence->triangles);
  memset(incidence, 0, sizeof *incidence);
}
