#include "bench/chart_models.h"

#include <math.h>
#include <string.h>

#include "cli/commands/hybrid_mesh.h"

const char *cli_chart_model_name(cli_chart_model representation) {
  static const char *const names[CLI_N_CHART_MODELS] = {"triangles", "surfels", "hybrid", "octree", "points"};
  return (unsigned)representation < CLI_N_CHART_MODELS ? names[representation] : NULL;
}

/* Hills of six sizes, lower on one side: something for every representation. */
static double height_at(double u, double v) {
  double height = 0.0, size = 0.12;
  for (int octave = 0; octave < 6; octave++, size *= 0.45) {
    double f = 5.0 * (double)(1 << octave);
    height += size * sin(f * u + 1.3 * octave) * sin(f * v + 0.7 * octave * octave);
  }
  return u > 0.7 ? 0.2 * height : height;
}

static void place_vertices(size_t side, conic_triangles *mesh) {
  for (size_t y = 0; y <= side; y++)
    for (size_t x = 0; x <= side; x++) {
      size_t i = y * (side + 1) + x;
      double u = (double)x / (double)side, v = (double)y / (double)side, height = height_at(u, v);
      double rise = fmin(1.0, fmax(0.0, 0.5 + 3.0 * height));
      const double at[3] = {u, height, v}, color[3] = {0.2 + 0.6 * rise, 0.5, 0.6 - 0.4 * rise};
      for (int k = 0; k < 3; k++) {
        mesh->position[k][i] = (float)at[k];
        mesh->color[k][i] = (float)color[k];
      }
    }
}

static conic_status make_terrain(conic_context *context, size_t side, conic_triangles *mesh) {
  conic_status status =
      conic_triangles_allocate(context, 2 * side * side, (side + 1) * (side + 1), CONIC_TRIANGLES_COLORS, mesh);
  if (status != CONIC_OK)
    return status;
  place_vertices(side, mesh);
  for (size_t y = 0; y < side; y++)
    for (size_t x = 0; x < side; x++) {
      uint32_t i = (uint32_t)(y * (side + 1) + x), below = i + (uint32_t)side + 1;
      const uint32_t both[2][3] = {{i, below, i + 1}, {i + 1, below, below + 1}};
      memcpy(mesh->corners + 2 * (y * side + x), both, sizeof both);
    }
  return CONIC_OK;
}

static conic_status read_mesh(cli_session *session, const char *path, size_t side, conic_triangles *mesh) {
  conic_status status = path ? cli_mesh_read(session, path, NULL, mesh) : make_terrain(session->context, side, mesh);
  if (status == CONIC_OK && !mesh->normal[0])
    status = conic_triangles_smooth(session->context, mesh);
  return status;
}

/* The vertices with axes from the faces about them; the faces are lent. */
static conic_status make_points(conic_context *context, const conic_triangles *mesh, conic_splats *points) {
  conic_estimate_options options;
  conic_model model = {.n_triangles = mesh->count, .triangles = mesh->corners, .kind = CONIC_MODEL_OBJ};
  unsigned fields = mesh->color[0] ? (unsigned)CONIC_SPLATS_COLORS : 0u;
  conic_status status = conic_splats_allocate(context, mesh->n_vertices, fields, &model.points);
  if (status != CONIC_OK)
    return status;
  memcpy(model.points.origin, mesh->origin, sizeof mesh->origin);
  for (int k = 0; k < 3; k++) {
    memcpy(model.points.position[k], mesh->position[k], mesh->n_vertices * sizeof(float));
    if (fields)
      memcpy(model.points.color[k], mesh->color[k], mesh->n_vertices * sizeof(float));
  }
  conic_estimate_options_init(&options);
  status = conic_model_to_splats(context, &options, &model, NULL);
  if (status == CONIC_OK)
    *points = model.points;
  else
    conic_splats_release(context, &model.points);
  return status;
}

static conic_status make_hybrid(cli_session *session, const char *path, size_t side,
                                const conic_hybrid_options *options, conic_hybrid **hybrid, double *splat_length) {
  conic_hybrid_info info;
  conic_triangles mesh = {0}; /* once more: it is taken over */
  conic_status status = read_mesh(session, path, side, &mesh);
  if (status == CONIC_OK)
    status = conic_hybrid_build(session->context, &mesh, options, hybrid, NULL);
  if (status == CONIC_OK)
    status = conic_hybrid_describe(*hybrid, &info);
  if (status == CONIC_OK)
    *splat_length = info.splat_length;
  conic_triangles_release(session->context, &mesh);
  return status;
}

/* One that chooses, and one of surfels only. */
static conic_status make_hybrids(cli_session *session, const char *path, size_t side, cli_chart_models *models) {
  conic_hybrid_options options;
  conic_hybrid_options_init(&options);
  conic_status status =
      make_hybrid(session, path, side, &options, &models->hybrid, &models->splat_length[CLI_CHART_HYBRID]);
  options.phase2 = 1e6;
  options.most_error = 0.0;
  options.has_single_levels = 1;
  if (status == CONIC_OK)
    status = make_hybrid(session, path, side, &options, &models->surfels, &models->splat_length[CLI_CHART_SURFELS]);
  return status;
}

static conic_status make_octree(conic_context *context, cli_chart_models *models) {
  conic_octree_options options;
  conic_octree_info info;
  conic_splats splats;
  conic_octree_options_init(&options);
  conic_status status = make_points(context, &models->mesh, &splats);
  if (status == CONIC_OK)
    status = conic_octree_build(context, &splats, &options, &models->octree);
  if (status == CONIC_OK)
    status = conic_octree_describe(models->octree, &info);
  if (status == CONIC_OK)
    models->splat_length[CLI_CHART_OCTREE] = info.splat_length;
  return status;
}

conic_status cli_chart_models_build(cli_session *session, const char *path, size_t side, cli_chart_models *models) {
  conic_context *context = session->context;
  conic_status status = read_mesh(session, path, side, &models->mesh);
  const conic_drawing drawing = {NULL, &models->mesh};
  if (status == CONIC_OK) {
    models->near_z = conic_drawing_near(&drawing);
    status = make_hybrids(session, path, side, models);
  }
  if (status == CONIC_OK)
    status = make_octree(context, models);
  if (status == CONIC_OK)
    status = make_points(context, &models->mesh, &models->points);
  if (status == CONIC_OK)
    status = conic_splats_length(context, &models->points, &models->splat_length[CLI_CHART_POINTS]);
  return status;
}

void cli_chart_models_release(conic_context *context, cli_chart_models *models) {
  conic_hybrid_selection_release(context, &models->chosen_surfels);
  conic_hybrid_selection_release(context, &models->mixed);
  conic_selection_release(context, &models->leaves);
  conic_hybrid_destroy(models->hybrid);
  conic_hybrid_destroy(models->surfels);
  conic_octree_destroy(models->octree);
  conic_splats_release(context, &models->points);
  conic_triangles_release(context, &models->mesh);
  memset(models, 0, sizeof *models);
}

/* Error 0: as built. */
static conic_status choose_hybrid(const conic_hybrid *hybrid, const conic_camera *camera, double error_px,
                                  const conic_render_options *options, conic_hybrid_selection *selection,
                                  conic_drawing *drawing) {
  conic_hybrid_view view;
  conic_hybrid_view_init(&view);
  view.error_px = error_px;
  conic_status status = conic_hybrid_select(hybrid, camera, options, &view, selection);
  *drawing = (conic_drawing){&selection->splats, &selection->triangles};
  return status;
}

static conic_status choose_leaves(cli_chart_models *models, const conic_camera *camera, double error_px,
                                  const conic_render_options *options, conic_drawing *drawing) {
  conic_selection_options wanted;
  conic_selection_options_init(&wanted);
  wanted.error_px = error_px;
  conic_status status = conic_octree_select(models->octree, camera, options, &wanted, &models->leaves);
  *drawing = (conic_drawing){&models->leaves.splats, NULL};
  return status;
}

conic_status cli_chart_models_choose(cli_chart_models *models, cli_chart_model representation,
                                     const conic_camera *camera, double error_px, conic_render_options *options,
                                     conic_drawing *drawing) {
  options->method = representation == CLI_CHART_POINTS ? CONIC_METHOD_POINT : CONIC_METHOD_CONIC;
  options->near_z = models->near_z;
  options->splat_length = models->splat_length[representation];
  switch (representation) {
  case CLI_CHART_SURFELS:
    return choose_hybrid(models->surfels, camera, 0.0, options, &models->chosen_surfels, drawing);
  case CLI_CHART_HYBRID:
    return choose_hybrid(models->hybrid, camera, error_px, options, &models->mixed, drawing);
  case CLI_CHART_OCTREE:
    return choose_leaves(models, camera, error_px, options, drawing);
  case CLI_CHART_POINTS:
    *drawing = (conic_drawing){&models->points, NULL};
    return CONIC_OK;
  case CLI_CHART_TRIANGLES:
    break;
  }
  *drawing = (conic_drawing){NULL, &models->mesh};
  return CONIC_OK;
}
