#include "source/mesh_input.h"

#include "conic/gaussians.h"
#include "core/estimate/estimate.h"
#include "core/formats/model_read.h"
#include "core/splats/repairs_log.h"
#include "core/splats/splats_gather.h"
#include "lod/mesh/mesh.h"
#include "source/reach.h"

conic_status conic_mesh_gather_loose(conic_context *context, const conic_model *model, conic_splats *loose) {
  size_t n = model->points.count, n_loose = 0;
  memset(loose, 0, sizeof *loose);
  uint32_t *list = conic_memory_allocate_zeroed(context, n, sizeof *list); /* at first, whether each vertex is in a
                                                                              triangle */
  if (!list)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < 3 * model->n_triangles; i++)
    list[model->triangles[i / 3][i % 3]] = 1;
  for (size_t i = 0; i < n; i++)
    if (!list[i])
      list[n_loose++] = (uint32_t)i;
  conic_status status = CONIC_OK;
  if (n_loose && !conic_mesh_has_leftovers(n, n_loose))
    status = conic_splats_gather(context, &model->points, list, n_loose, loose);
  conic_memory_release(context, list);
  return status;
}

conic_status conic_mesh_check(conic_context *context, const char *path, const conic_triangles *triangles) {
  if (conic_has_face(triangles->position, (const uint32_t(*)[3])triangles->corners, triangles->count))
    return CONIC_OK;
  return conic_fail(context, CONIC_ERROR_INPUT, "%s: no face has three finite corners at three places", path);
}

conic_status conic_mesh_lay_texture(conic_context *context, const char *texture_path, conic_triangles *triangles) {
  conic_texture *texture;
  if (!triangles->texture_coordinate[0])
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the mesh has no texture coordinates for it", texture_path);
  conic_status status = conic_texture_read(context, texture_path, CONIC_WRAP_REPEAT, &texture);
  if (status != CONIC_OK)
    return status;
  status = conic_triangles_texture(context, triangles, texture);
  if (status != CONIC_OK)
    conic_texture_destroy(texture);
  return status;
}

/* --- the input of hybrid models --- */

static conic_status take_hybrid_mesh(conic_context *context, const char *path, const conic_hybrid_reading *reading,
                                     conic_model *model, conic_hybrid_input *input) {
  conic_status status = conic_triangles_take(context, model, &input->mesh);
  if (status == CONIC_OK)
    status = conic_mesh_check(context, path, &input->mesh);
  if (status == CONIC_OK && reading->texture_path)
    status = conic_mesh_lay_texture(context, reading->texture_path, &input->mesh);
  return status == CONIC_OK ? conic_mesh_round(context, reading->is_smooth, reading->crease_deg, &input->mesh) : status;
}

static conic_status take_hybrid_points(conic_context *context, const char *path, const conic_hybrid_reading *reading,
                                       conic_model *model, conic_hybrid_input *input) {
  conic_estimate_options estimate;
  conic_repairs repairs;
  double low[3], high[3];
  conic_estimate_options_init(&estimate);
  estimate.cutoff = reading->cutoff;
  estimate.finds_dots = 1;
  if (reading->n_neighbours)
    estimate.n_neighbours = reading->n_neighbours;
  if (reading->texture_path)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: there are no faces for the texture to lie on", path);
  conic_status status = conic_leave_far_points(context, path, &model->points, low, high);
  if (status == CONIC_OK)
    status = conic_model_to_splats(context, &estimate, model, &repairs);
  if (status != CONIC_OK)
    return status;
  conic_repairs_log(context, path, &repairs);
  if (model->points.n_clips)
    conic_log(context, CONIC_LOG_WARNING, "%s: the clip lines of %zu splats are left out", path, model->points.n_clips);
  input->is_points = 1;
  input->splats = model->points;
  memcpy(input->up, model->up, sizeof input->up);
  memset(&model->points, 0, sizeof model->points);
  return CONIC_OK;
}

conic_status conic_hybrid_input_read(conic_context *context, const char *path, const conic_hybrid_reading *reading,
                                     conic_hybrid_input *input) {
  conic_read_options options;
  conic_model model;
  memset(input, 0, sizeof *input);
  conic_read_options_init(&options);
  options.cutoff = reading->cutoff;
  options.keeps_faces = 1;
  options.colors_are = reading->colors_are;
  conic_coloring_read(reading->coloring, &options);
  conic_status status = conic_gaussians_read_model(context, path, &options, &model);
  if (status != CONIC_OK)
    return status;
  input->has_fractions = conic_model_has_fractions(&model);
  status = model.n_triangles ? take_hybrid_mesh(context, path, reading, &model, input)
                             : take_hybrid_points(context, path, reading, &model, input);
  conic_model_release(context, &model);
  if (status != CONIC_OK)
    conic_hybrid_input_release(context, input);
  return status;
}

void conic_hybrid_input_release(conic_context *context, conic_hybrid_input *input) {
  conic_triangles_release(context, &input->mesh);
  conic_splats_release(context, &input->splats);
  memset(input, 0, sizeof *input);
}

conic_status conic_hybrid_input_build(conic_context *context, conic_hybrid_input *input,
                                      const conic_hybrid_options *options, conic_hybrid **hybrid,
                                      conic_hybrid_report *report) {
  return input->is_points ? conic_hybrid_build_points(context, &input->splats, options, hybrid, report)
                          : conic_hybrid_build(context, &input->mesh, options, hybrid, report);
}
